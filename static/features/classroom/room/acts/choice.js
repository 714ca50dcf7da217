// The reveal of a choice: the votes as bars, with the right answer, or how many races each one won.
import { html } from "../../../../js/components/elements.js";
import { agentOf } from "../../../../js/settings.js";
import { KINDS } from "../questions.js";
import { BySetting } from "./by-setting.js";
import { Distances } from "./distances.js";
import { isRevealOf, predictionsOf, winsOf } from "./predictions.js";

/** @import { Ask } from "../../../../js/types.js" */
/** @import { Act, Facts } from "./index.js" */

/** @param {number} number @param {number} all */
const shareIn = (number, all) => ({ "--share": `${(100 * number) / Math.max(1, all)}%` });

/** @param {Facts} facts */
function Reveal(facts) {
  const { classroom, results } = facts;
  const { ask } = /** @type {{ ask: Ask }} */ (classroom.shown);
  const votes = predictionsOf(results);
  const { by, races } = winsOf(results);
  const isRaced = (ask.choices ?? []).some((choice) => by.has(choice));
  const most = Math.max(...[...by.values()], 0);
  const right = results?.answer ?? null;
  const isRight = (/** @type {string} */ choice) =>
    (right === null ? isRaced && by.get(choice) === most : right === choice);
  return html`
    <ul class="votes" style=${{ "--rows": (ask.choices ?? []).length }}>
      ${KINDS.choice.tally?.(ask, votes).map(([choice, number]) => html`
        <li key=${choice} class=${isRight(choice) ? "right" : ""}>
          <p class="vote-name">${isRight(choice) && html`<span aria-label=${isRaced ? "won most" : "right"}>✓ </span>`}
            ${agentOf(choice).title}</p>
          <p class="vote-bar voted" style=${shareIn(number, votes.length)}><b class="num">${number}</b>
            ${" "}${number === 1 ? "vote" : "votes"}</p>
          ${isRaced && html`
            <p class="vote-bar won" style=${shareIn(by.get(choice) ?? 0, races)}>won
              ${" "}<b class="num">${by.get(choice) ?? 0}</b> of ${races}</p>
          `}
        </li>
      `)}
    </ul>
    ${!isRaced && html`<${Distances} ...${facts} /><${BySetting} ...${facts} />`}
  `;
}

/** @type {Act} */
export const CHOICE = { name: "choice", isOn: isRevealOf("choice"), Show: Reveal };
