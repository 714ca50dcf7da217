// How the time passes, for those who try: whether a race ends with its photo finish, and the speed. Loaded for them.
import { endAtTimeOut, setStage } from "../actions.js";
import { isStale } from "../on-stage.js";
import { page } from "../page-state.js";
import { isOwn, playback } from "../player.js";
import { isOperator } from "../selectors.js";
import { isAway, scene } from "../store.js";
import { html } from "./elements.js";

/** @import { Changed } from "../types.js" */

const SPEEDS = [0.25, 0.5, 1, 2, 4, 8, 16, 64];

export const TimeChoices = () => html`<${EndAtTimeOut} /><${Speed} />`;

/** Whether the show of a race ends with its photo finish: its last robots may walk on for a minute. */
function EndAtTimeOut() {
  if (scene.value?.kind !== "race" || scene.value.lanes.length < 2) return null;
  const isOn = playback.value?.end_at_time_out ?? true;
  const toggle = () => (isOwn.value ? (page.end.value = isOn ? "all" : "time-out") : endAtTimeOut(!isOn));
  return html`
    <label class="switch" title="End with the photo finish, which settles the ranking">
      <input type="checkbox" role="switch" name="end_at_time_out" checked=${isOn}
        disabled=${isStale.value} onChange=${toggle} />
      End at time-out
    </label>
  `;
}

function Speed() {
  const speed = playback.value?.speed ?? 1;
  const isOther = typeof speed === "number" && !SPEEDS.includes(speed);
  const numbers = isOther ? [...SPEEDS, speed].sort((a, b) => a - b) : SPEEDS;
  const choices = [...(isOwn.value ? [] : [["time-lapse", "Auto"]]), ...numbers.map((n) => [n, `×${n}`])];
  /** @param {Changed} event */
  const onChange = ({ target: { value } }) => setStage({ speed: value === "time-lapse" ? value : Number(value) });
  return html`
    <select name="speed" aria-label="Speed" title=${isOwn.value ? "Speed of your replay" : "Speed of the stage"}
      disabled=${!isOwn.value && (!isOperator.value || isAway.value)} onChange=${onChange}>
      ${choices.map(([choice, words]) => html`
        <option value=${String(choice)} selected=${String(choice) === String(speed)}>${words}</option>
      `)}
    </select>
  `;
}
