// Playback of the stage. The camera is this page's own; all else is shared by every page.
import { setStage, skipToEnd, togglePlaying } from "../actions.js";
import { agentOf } from "../agents.js";
import { clockTime, sentence } from "../format.js";
import { html } from "../html.js";
import { isNarrow, view } from "../page.js";
import { clock, isActive, isOperator, shownRun } from "../selectors.js";
import { options, scene, stage } from "../store.js";
import { choicesOf, clockTitle } from "../titles.js";
import { Icon } from "./icon.js";
import { Problem } from "./problem.js";

const SPEEDS = [0.25, 0.5, 1, 2, 4, 8, 16, 64];

export function Transport() {
  const now = scene.value;
  return html`
    <div class="transport">
      ${isOperator.value && html`<${PlayButton} />`}
      <${Seek} now=${now} />
      ${isOneLaneLeft(now) && isOperator.value && html`
        <button class="secondary compact" onClick=${skipToEnd}><${Icon} name="skip" />Skip</button>
      `}
      <${Follow} />
      ${!isNarrow.value && html`<${SharedChoices} />`}
      <${Problem} at="stage" />
    </div>
  `;
}

function PlayButton() {
  const isPlaying = stage.value?.playing;
  return html`
    <button class="quiet square" disabled=${!stage.value?.run_id} onClick=${togglePlaying}
      aria-label=${isPlaying ? "Pause the playback" : "Play"} title="Pause or play, on every page">
      <${Icon} name=${isPlaying ? "pause" : "play"} />
    </button>
  `;
}

/** Speed and clock; on a phone in a row of their own, which may scroll away. */
export const SharedChoices = () => isOperator.value && html`<${Speed} /><${ClockChoice} />`;

const isOneLaneLeft = (now) =>
  now?.kind === "race" && now.phase !== "finished" && now.lanes?.length > 1 && now.duration_s &&
  now.lanes.filter(({ done }) => !done).length === 1;

function Seek({ now }) {
  if (!now || now.kind === "idle") return html`<span class="seek"></span>`;
  const { time_s, duration_s } = now;
  if (!duration_s) {
    return html`
      <span class="seek">
        <span class="num">${clockTime(time_s)}</span>
        <span class="dim">${isActive(shownRun.value) ? "still being simulated" : ""}</span>
      </span>
    `;
  }
  const words = `${clockTime(time_s)} of ${clockTime(duration_s)}`;
  const seek = ({ target }) => setStage({ time_s: Number(target.value) });
  return html`
    <span class="seek">
      <span class="num">${clockTime(time_s)}</span>
      <input type="range" min="0" max=${duration_s} step="0.1" value=${time_s} disabled=${!isOperator.value}
        style=${{ "--share": `${(100 * time_s) / duration_s}%` }}
        aria-label="Moment that is shown" aria-valuetext=${words} onChange=${seek} />
      <span class="num dim">${clockTime(duration_s)}</span>
    </span>
  `;
}

const Choice = ({ label, name, value, choices, onValue, title }) => html`
  <label class="choice" title=${title}>
    <span>${label}</span>
    <select name=${name} onChange=${({ target }) => onValue(target.value)}>
      ${choices.map(([one, words]) => html`
        <option value=${String(one)} selected=${String(one) === String(value)}>${words}</option>
      `)}
    </select>
  </label>
`;

function Follow() {
  const lanes = scene.value?.lanes ?? shownRun.value?.config?.lanes ?? [];
  const robots = lanes.map((lane, n) => [String(n + 1), lane.name ?? agentOf(lane.agent).title]);
  const choices = [["leader", "leader"], ...robots, ["free", "free camera"]];
  if (!choices.some(([one]) => one === view.value)) choices.push([view.value, `lane ${view.value}`]);
  return html`
    <${Choice} label="Follow" name="follow" value=${view.value} choices=${choices}
      title="The robot that your camera follows; keys 1 to 8, 0 for a free camera"
      onValue=${(value) => (view.value = value)} />
  `;
}

function Speed() {
  const speed = stage.value?.speed ?? 1;
  const isOther = typeof speed === "number" && !SPEEDS.includes(speed);
  const numbers = isOther ? [...SPEEDS, speed].sort((a, b) => a - b) : SPEEDS;
  const choices = [["time-lapse", "auto"], ...numbers.map((n) => [n, `×${n}`])];
  return html`
    <${Choice} label="Speed" name="speed" value=${speed} choices=${choices} title="For every page"
      onValue=${(value) => setStage({ speed: value === "time-lapse" ? value : Number(value) })} />
  `;
}

function ClockChoice() {
  const about = options.value?.clocks.find(({ name }) => name === clock.value)?.description ?? "";
  return html`
    <${Choice} label="Clock" name="clock" value=${clock.value} title=${`${sentence(clockTitle(clock.value))}. ${about}`}
      choices=${choicesOf(options.value?.clocks, clockTitle)} onValue=${(value) => setStage({ clock: value })} />
  `;
}
