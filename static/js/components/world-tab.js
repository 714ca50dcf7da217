// The tab of the world, in two parts that are always there: what happens in the run that is shown, and the world of the
// next one.
import { liveTraining, raceInView, shownRun, stepShown, work } from "../on-stage.js";
import { isMoving, openRace } from "../raced-on.js";
import { whole } from "../format.js";
import { isActive, isOperator } from "../selectors.js";
import { isClosed } from "../settings.js";
import { isAway } from "../store.js";
import { markInWords, marks, positionInWords, scale, seekTo } from "../time.js";
import { html } from "./elements.js";
import { Restricted } from "./fields.js";
import { WorldSettings } from "./settings.js";
import { Branch, LiveWorld } from "./world-controls.js";

export function WorldTab() {
  const isPractice = liveTraining.value !== null || shownRun.value?.kind === "training";
  return html`
    <div class="world-tab">
      <${Restricted} />
      <section class="world-part" aria-labelledby="world-of-this">
        <h2 id="world-of-this">In this ${isPractice ? "practice" : "race"}</h2>
        <${InThis} />
        <${Happened} />
      </section>
      <section class="world-part" aria-labelledby="world-of-next">
        <h2 id="world-of-next">In the next one</h2>
        <p class="sentence acts">Acts from the start of the next practice and race.</p>
        <${WorldSettings} />
      </section>
    </div>
  `;
}

/** The controls of what is shown, or why it has none. */
function InThis() {
  const reason = reasonWithout();
  if (reason) return html`<p class="dim fine">${reason}</p>`;
  return html`
    <p class="sentence acts">${whereItActs()}</p>
    <fieldset class="closed" disabled=${isAway.value || isClosed("disturb")}>
      ${liveTraining.value ? html`<${LiveWorld} />` : html`<${Branch} />`}
    </fieldset>
  `;
}

/** Why nothing can be made to happen in what is shown; empty where it can. */
function reasonWithout() {
  const race = raceInView.value;
  if (!isOperator.value) return "Only operators disturb what is on the stage.";
  if (liveTraining.value || openRace.value) return "";
  if (!shownRun.value) return "Nothing is shown yet. Then its robots are disturbed here, or by a click on a leg.";
  if (race && (work.value || isActive(race))) return "It is being computed. Then it can be raced on from each step.";
  return race ? "It ended early: it cannot be raced on." : "It has ended: nothing can happen in it any more.";
}

/** From which step the controls of what is shown act. */
function whereItActs() {
  if (liveTraining.value) return `Acts at once, from step ${whole(liveTraining.value.progress.done + 1)}.`;
  if (isMoving.value) return "Acts from the step that is shown, as a new race. The first change holds this one there.";
  const isAtEnd = stepShown.value === null;
  return `Acts from ${isAtEnd ? "the middle" : "the step that is shown"}, as a new race. This one stays as it is.`;
}

/** What happened in the run that is shown so far, each with a way to its moment. */
function Happened() {
  const all = marks.value.filter(({ kind }) => ["disturbance", "fall", "change"].includes(kind));
  const scaleNow = scale.value;
  if (!scaleNow || !all.length) return null;
  return html`
    <details class="more happened-list" open>
      <summary>What happened<span class="dim"> · ${all.length}</span></summary>
      <ul>
        ${all.map((world) => html`
          <li>
            <b class="num">${positionInWords(scaleNow, world.at)}</b> <span>${markInWords(world)}</span>
            <button class="link" onClick=${() => seekTo(world.at, { isHeld: true })}>Go there</button>
          </li>
        `)}
      </ul>
    </details>
  `;
}
