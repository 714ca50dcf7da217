// In place of the actions in a presenter's window: by what a race is ranked and timed, and how long it still takes.
import { html } from "../../js/components/elements.js";
import { fixed, sentence } from "../../js/format.js";
import { narrative } from "../../js/headline.js";
import { clock, isStale } from "../../js/on-stage.js";
import { isTimedOut } from "../../js/race.js";
import { scene } from "../../js/store.js";
import { clockTitle } from "../../js/titles.js";

export function Facts() {
  const { rule } = narrative.value;
  if (rule === null) return null;
  const { time_s = 0, time_out_s = null } = scene.value ?? {};
  const left = time_out_s === null || isStale.value ? null : Math.max(0, time_out_s - time_s);
  return html`
    <dl class="facts-of-race">
      <div><dt>Rule</dt><dd>${rule}</dd></div>
      <div>
        <dt>Clock</dt>
        <dd>${sentence(clockTitle(clock.value))}. Bar: distance. Thin: time, hatched while thinking.</dd>
      </div>
      ${left !== null && html`
        <div><dt>Time-out</dt><dd class="num">${isTimedOut.value ? "reached" : `in ${fixed(left, 1)} s`}</dd></div>
      `}
    </dl>
  `;
}
