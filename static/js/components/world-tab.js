// The tab of the world: what can be disturbed now, what has happened, and the world of the next run.
import { heldRace, liveTraining, stepShown } from "../on-stage.js";
import { isOperator } from "../selectors.js";
import { isClosed } from "../settings.js";
import { isAway } from "../store.js";
import { markInWords, marks, positionInWords, scale, seekTo } from "../time.js";
import { html } from "./elements.js";
import { Restricted } from "./fields.js";
import { WorldSettings } from "./settings.js";
import { Branch, LiveWorld } from "./world-controls.js";

/** What can be disturbed now comes before the world of the next run. */
export function WorldTab() {
  const canDisturb = isOperator.value && (liveTraining.value !== null || heldRace.value !== null);
  return html`
    <div class="world-tab">
      <${Restricted} />
      ${canDisturb && html`<${FromNow} />`}
      <${Happened} />
      <${WorldSettings} />
      ${isOperator.value && !canDisturb && !isClosed("disturb") && html`
        <p class="dim fine">
          Hold a race that has been computed, or start a training: then its robots can be disturbed here, or by a click
          on a leg.
        </p>
      `}
    </div>
  `;
}

function FromNow() {
  // At the end of a race nothing is left to walk from there.
  const isFromPicture = liveTraining.value !== null || stepShown.value !== null;
  const title = isFromPicture ? "From the moment shown" : "From the middle of the race";
  return html`
    <section aria-label=${title}>
      <h3>${title}${isFromPicture && shownMoment()}</h3>
      <fieldset class="closed" disabled=${isAway.value || isClosed("disturb")}>
        ${liveTraining.value ? html`<${LiveWorld} />` : html`<${Branch} />`}
      </fieldset>
    </section>
  `;
}

const shownMoment = () => (scale.value ? `, ${positionInWords(scale.value, scale.value.picture)}` : "");

/** What happened in the run on stage so far, each with a way to its moment. */
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
