// The end of a lesson: how many were right before it and after it, and the answers to the question of the end.
import { html } from "../../../../js/components/elements.js";
import { CHOICE } from "./choice.js";
import { gainInWords, points } from "./gain-words.js";
import { NUMBER } from "./number.js";

/** @import { Gain } from "../../../../js/types.js" */
/** @import { Act, Facts } from "./index.js" */

/** @param {Facts} facts */
function Reveal(facts) {
  const { classroom: { shown }, gain } = facts;
  const Answers = (shown.ask?.kind === "choice" ? CHOICE : NUMBER).Show;
  return html`
    ${gain && html`<${GainBars} gain=${gain} />`}
    <${Answers} ...${facts} />
  `;
}

/** @param {{ gain: Gain }} props */
const GainBars = ({ gain }) => html`
  <div class="gain">
    <p class="gain-figure"><b class="num">${points(gain.gain)}</b> points</p>
    <div class="gain-bars" role="img" aria-label=${gainInWords(gain)}>
      ${[["before", gain.right_before], ["after", gain.right_after]].map(([word, right]) => html`
        <p class="vote-bar ${word}" style=${{ "--share": `${(100 * Number(right)) / gain.pairs}%` }}>
          ${word}: <b class="num">${right}</b> of ${gain.pairs} right
        </p>
      `)}
      ${gain.low !== null && gain.high !== null && html`
        <p class="gain-range">95\u00a0% interval of the gain: ${points(gain.low)} to ${points(gain.high)} points</p>
      `}
    </div>
  </div>
`;

/** @type {Act} */
export const GAIN = {
  name: "gain", isOn: ({ classroom, isRevealed }) => isRevealed && classroom.knowledge === "after", Show: Reveal,
};
