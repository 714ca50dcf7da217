// How the stage is shown: whom the camera follows is one's own, the rest is everyone's.
import { setStage, skipToEnd, togglePlaying } from "../actions.js";
import { clockTime } from "../format.js";
import { html } from "../html.js";
import { isNarrow, view } from "../page.js";
import { agentOf, clock, isActive, isOperator, shownRun } from "../selectors.js";
import { options, scene, stage } from "../store.js";
import { Icon } from "./icon.js";
import { Problem } from "./problem.js";

const SPEEDS = [0.25, 0.5, 1, 2, 4, 8, 16, 64];
const CLOCKS = { paper: "paper", wall: "measured", free: "free" };

export function Transport() {
  const now = scene.value;
  const isEmpty = !stage.value?.run_id;
  return html`
    <div class="transport">
      ${isOperator.value && html`
        <button class="quiet square" disabled=${isEmpty} onClick=${togglePlaying}
          aria-label=${stage.value?.playing ? "Pause the picture" : "Play"} title="Pause or play the picture, for everyone">
          <${Icon} name=${stage.value?.playing ? "pause" : "play"} />
        </button>
      `}
      <${Seek} now=${now} />
      ${oneIsLeft(now) && isOperator.value && html`
        <button class="secondary compact" onClick=${skipToEnd}><${Icon} name="skip" />Skip</button>
      `}
      <${Follow} />
      ${!isNarrow.value && html`<${SharedChoices} />`}
      <${Problem} at="stage" />
    </div>
  `;
}

/** What everyone's picture goes by; on a phone it has a row of its own, which may scroll away. */
export const SharedChoices = () => isOperator.value && html`<${Speed} /><${ClockChoice} />`;

const oneIsLeft = (now) =>
  now?.kind === "race" && now.phase !== "finished" && now.lanes?.length > 1 && now.duration_s &&
  now.lanes.filter(({ done }) => !done).length === 1;

function Seek({ now }) {
  if (!now || now.kind === "idle") return html`<span class="seek"></span>`;
  if (!now.duration_s) {
    return html`<span class="seek"><span class="num">${clockTime(now.time_s)}</span><span class="dim">${isActive(shownRun.value) ? "still being simulated" : ""}</span></span>`;
  }
  const { time_s, duration_s } = now;
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
      ${choices.map(([one, words]) => html`<option value=${String(one)} selected=${String(one) === String(value)}>${words}</option>`)}
    </select>
  </label>
`;

function Follow() {
  const lanes = scene.value?.lanes ?? shownRun.value?.config?.lanes ?? [];
  const robots = lanes.map((lane, n) => [String(n + 1), lane.name ?? agentOf(lane.agent).title]);
  const choices = [["leader", "leader"], ...robots, ["free", "nobody"]];
  if (!choices.some(([one]) => one === view.value)) choices.push([view.value, `lane ${view.value}`]);
  return html`
    <${Choice} label="Follow" name="follow" value=${view.value} choices=${choices}
      title="Whom your camera follows; keys 1 to 8, 0 frees it" onValue=${(value) => (view.value = value)} />
  `;
}

function Speed() {
  const speed = stage.value?.speed ?? 1;
  const numbers = SPEEDS.includes(speed) || typeof speed !== "number" ? SPEEDS : [...SPEEDS, speed].sort((a, b) => a - b);
  const choices = [["time-lapse", "auto"], ...numbers.map((n) => [n, `×${n}`])];
  return html`
    <${Choice} label="Speed" name="speed" value=${speed} choices=${choices} title="For everyone"
      onValue=${(value) => setStage({ speed: value === "time-lapse" ? value : Number(value) })} />
  `;
}

function ClockChoice() {
  const known = options.value?.clocks ?? [{ name: "paper" }, { name: "wall" }, { name: "free" }];
  const about = known.find(({ name }) => name === clock.value)?.description ?? "";
  return html`
    <${Choice} label="Clock" name="clock" value=${clock.value} title=${`What thinking costs. ${about}`}
      choices=${known.map(({ name }) => [name, CLOCKS[name] ?? name])} onValue=${(value) => setStage({ clock: value })} />
  `;
}
