// The transport below the stage: play, seek, speed, clock, camera. The camera is this page's own; all else is shared by
// every page, unless this one plays a replay of its own.
import { endAtTimeOut, setStage, skipToEnd, togglePlaying } from "../actions.js";
import { conditionsAt, conditionsInWords, disturbancesOf } from "../disturbances.js";
import { clockTime, count, metres, sentence } from "../format.js";
import { page } from "../page-state.js";
import { isNarrow, camera } from "../page.js";
import { closeReplay, endTime, openReplay, plan, replayTime, seekReplay, stepReplay } from "../replay.js";
import { canPlay, clock, isPlaying, playbackName, shownRun } from "../on-stage.js";
import { isActive, isOperator } from "../selectors.js";
import { agentOf } from "../settings.js";
import { options, scene, stage } from "../store.js";
import { choicesOf, clockTitle } from "../titles.js";
import { html, Icon, Problem } from "./elements.js";

/** @import { Changed, Clock, ReplayMark, Scene } from "../types.js" */

const SPEEDS = [0.25, 0.5, 1, 2, 4, 8, 16, 64];

export function Transport() {
  const now = scene.value;
  const isOwn = page.run.value !== null;
  return html`
    <div class=${`transport ${isOwn ? "own" : ""}`}>
      ${canPlay.value && html`<${PlayButton} />`}
      ${isOwn && html`<${StepButtons} />`}
      <${Seek} now=${now} />
      ${isOneLaneLeft(now) && canPlay.value && html`
        <button class="quiet square" onClick=${skipToEnd} aria-label="Skip to the end" title="Skip to the end">
          <${Icon} name="skip" />
        </button>
      `}
      ${isOwn ? html`<${BackToStage} /><${Marks} />` : html`<${ReplayButton} />`}
      <${Follow} />
      ${!isNarrow.value && html`<${SharedChoices} />`}
      <${Problem} at="stage" />
    </div>
  `;
}

function PlayButton() {
  const verb = isPlaying.value ? "Pause" : "Play";
  const whose = page.run.value === null ? " for everyone" : "";
  const label = stage.value?.ended ? `Play again${whose}` : `${verb} ${playbackName.value}${whose}`;
  return html`
    <button class="quiet square" disabled=${!stage.value?.run_id} onClick=${togglePlaying}
      aria-label=${label} title=${label}>
      <${Icon} name=${isPlaying.value ? "pause" : "play"} />
    </button>
  `;
}

// ---- a replay of this page's own

function ReplayButton() {
  const run = shownRun.value;
  if (!run?.progress?.done) return null;
  const open = () => openReplay(run.id, { time_s: scene.value?.time_s ?? 0, clock: clock.value });
  return html`
    <button class="secondary compact" onClick=${open}
      title="Play and seek on this page only; the stage goes on for all">
      <${Icon} name="replay" />Replay
    </button>
  `;
}

const BackToStage = () => html`
  <button class="secondary compact to-stage" onClick=${closeReplay} title="Watch the stage with everybody">
    <span class="dot" aria-hidden="true"></span>Live
  </button>
`;

/** @param {{ direction: 1 | -1, label: string, icon: string }} props */
const StepButton = ({ direction, label, icon }) => html`
  <button class="quiet square" onClick=${() => stepReplay(direction)} aria-label=${label} title=${label}>
    <${Icon} name=${icon} />
  </button>
`;

const StepButtons = () => html`
  <${StepButton} direction=${-1} label="One robot step back" icon="stepBack" />
  <${StepButton} direction=${1} label="One robot step on" icon="stepOn" />
`;

const MARKS = {
  "time-out": "Time-out", "crossing": "crosses the line", "fall": "falls", "disturbance": "Something changes",
  "evaluation": "Evaluation",
};

/** Text of a mark, such as "Greedy crosses the line". @param {ReplayMark} one */
function markTitle({ kind, lane, step, distance_m }) {
  const names = (shownRun.value?.config?.lanes ?? []).map((one) => agentOf(one.agent).title);
  if (kind === "evaluation") return `Evaluation after ${count(step ?? 0, "step")}: ${metres(distance_m ?? NaN)}`;
  if (kind === "disturbance") {
    const run = shownRun.value;
    const at = step ?? 0;
    const words = run ? conditionsInWords(conditionsAt(disturbancesOf(run), at, run.config.robot)) : [];
    const what = sentence(words.join(", ")) || "As built again";
    return names.length > 1 ? `${what}: ${names[lane ?? -1]}, step ${at + 1}` : `${what}, step ${at + 1}`;
  }
  if (lane === null) return MARKS[kind];
  return `${names[lane] ?? "The robot"} ${MARKS[kind]}`;
}

/** Jump to something that happened. */
function Marks() {
  const marks = plan.value?.marks ?? [];
  if (!marks.length) return null;
  /** @param {{ target: HTMLSelectElement }} event */
  const jump = ({ target }) => {
    if (target.value !== "") setStage({ time_s: marks[Number(target.value)].time_s, playing: false });
    target.value = "";
  };
  return html`
    <label class="choice" title="Something that happened in this run">
      <span class="sr-only">Jump to something that happened</span>
      <select name="mark" onChange=${jump}>
        <option value="">Jump to…</option>
        ${marks.map((mark, n) => html`
          <option value=${n}>${clockTime(mark.time_s)} ${markTitle(mark)}</option>
        `)}
      </select>
    </label>
  `;
}

/** The slider with marks: seeks while it is dragged. */
function OwnSeek() {
  const known = plan.value;
  const end = endTime.value;
  const time = replayTime.value;
  /** @param {number} time_s */
  const placeOf = (time_s) => `${(100 * time_s) / end}%`;
  if (!known) return html`<span class="seek"><span class="num">${clockTime(time)}</span></span>`;
  return html`
    <span class="seek">
      <span class="num">${clockTime(time)}</span>
      <span class="slider">
        <input type="range" min="0" max=${end} step="0.01" value=${time} style=${{ "--share": placeOf(time) }}
          aria-label="Moment of your replay" aria-valuetext=${`${clockTime(time)} of ${clockTime(end)}`}
          onInput=${(/** @type {Changed} */ { target }) => seekReplay(Number(target.value))} />
        <span class="marks" aria-hidden="true">
          ${known.marks.map(({ kind, time_s }) => html`<i class=${kind} style=${{ left: placeOf(time_s) }}></i>`)}
        </span>
      </span>
      <span class="num dim">${clockTime(end)}</span>
    </span>
  `;
}

/** Speed and clock; on a phone in a row of their own, which may scroll away. */
export const SharedChoices = () => canPlay.value && html`<${EndAtTimeOut} /><${Speed} /><${ClockChoice} />`;

/** Whether the show of a race ends with its photo finish: its last robots may walk on for a minute. */
function EndAtTimeOut() {
  if (page.run.value !== null || scene.value?.kind !== "race" || scene.value.lanes.length < 2) return null;
  return html`
    <label class="check end-at-time-out" title="For every page: end with the photo finish, which settles the ranking">
      <input type="checkbox" name="end_at_time_out" checked=${stage.value?.end_at_time_out ?? true}
        onChange=${(/** @type {Changed} */ { target }) => endAtTimeOut(target.checked)} />
      End at time-out
    </label>
  `;
}

/** @param {Scene | null} now */
const isOneLaneLeft = (now) =>
  now?.kind === "race" && now.phase !== "finished" && now.lanes?.length > 1 && now.duration_s &&
  now.lanes.filter(({ done, halted }) => !done && !halted).length === 1;

/** @param {{ now: Scene }} props */
function Seek({ now }) {
  if (page.run.value !== null) return html`<${OwnSeek} />`;
  if (!now || now.kind === "idle") return html`<span class="seek"></span>`;
  const { time_s, computed_s } = now;
  const isComputing = isActive(shownRun.value);
  const end = now.duration_s ?? computed_s;
  if (!end) {
    const words = isComputing ? "its first steps are being computed" : "";
    return html`
      <span class="seek"><span class="num">${clockTime(time_s)}</span><span class="dim">${words}</span></span>
    `;
  }
  const computed = isComputing ? `, computed up to ${clockTime(computed_s)}` : "";
  const words = `${clockTime(time_s)}${now.duration_s ? ` of ${clockTime(end)}` : ""}${computed}`;
  /** @param {{ target: HTMLInputElement }} event */
  const seek = ({ target }) => setStage({ time_s: Math.min(Number(target.value), computed_s) });
  const places = { "--share": `${(100 * time_s) / end}%`, "--computed": `${(100 * computed_s) / end}%` };
  return html`
    <span class="seek">
      <span class="num">${clockTime(time_s)}</span>
      <span class="slider">
        <input type="range" min="0" max=${end} step="0.1" value=${time_s} disabled=${!isOperator.value} style=${places}
          aria-label="Moment that is shown" aria-valuetext=${words} onChange=${seek} />
        ${now.time_out_s && html`
          <span class="marks" aria-hidden="true">
            <i class="time-out" style=${{ left: `${(100 * now.time_out_s) / end}%` }} title="Time-out"></i>
          </span>
        `}
      </span>
      ${isComputing && html`<span class="num dim" title="Computed up to">▸ ${clockTime(computed_s)}</span>`}
      ${now.duration_s && html`<span class="num dim">${clockTime(now.duration_s)}</span>`}
    </span>
  `;
}

/**
 * `isSelfEvident`: the values say what they are, so the label is only for screen readers.
 * @param {object} props
 * @param {string} props.label
 * @param {boolean} [props.isSelfEvident]
 * @param {string} props.name
 * @param {() => string} props.getValue
 * @param {[string, string][]} props.choices
 * @param {(value: string) => unknown} props.onValue
 * @param {string} props.title
 */
function Choice({ label, isSelfEvident = false, name, getValue, choices, onValue, title }) {
  /** @param {{ target: HTMLSelectElement }} event */
  const change = async ({ target }) => {
    await onValue(target.value);
    // A choice that was refused is undone.
    target.value = String(getValue());
  };
  return html`
    <label class="choice" title=${title}>
      <span class=${isSelfEvident ? "sr-only" : ""}>${label}</span>
      <select name=${name} onChange=${change}>
        ${choices.map(([one, words]) => html`
          <option value=${String(one)} selected=${String(one) === String(getValue())}>${words}</option>
        `)}
      </select>
    </label>
  `;
}

function Follow() {
  const lanes = scene.value?.lanes ?? shownRun.value?.config?.lanes ?? [];
  const robots = lanes.map((lane, n) =>
    [String(n + 1), `Follow ${"name" in lane ? lane.name : agentOf(lane.agent).title}`]);
  const choices = [["leader", "Follow leader"], ...robots, ["free", "Free camera"]];
  if (!choices.some(([one]) => one === camera.value)) choices.push([camera.value, `lane ${camera.value}`]);
  return html`
    <${Choice} label="Follow" isSelfEvident name="follow" getValue=${() => camera.value} choices=${choices}
      title="The robot that your camera follows; keys 1 to 8, 0 for a free camera"
      onValue=${(/** @type {string} */ value) => (camera.value = value)} />
  `;
}

function Speed() {
  const getSpeed = () => stage.value?.speed ?? 1;
  const speed = getSpeed();
  const isOther = typeof speed === "number" && !SPEEDS.includes(speed);
  const numbers = isOther ? [...SPEEDS, speed].sort((a, b) => a - b) : SPEEDS;
  const isOwn = page.run.value !== null;
  const automatic = isOwn ? [] : [["time-lapse", "Auto speed"]];
  const choices = [...automatic, ...numbers.map((n) => [n, `×${n}`])];
  return html`
    <${Choice} label="Speed" isSelfEvident name="speed" getValue=${getSpeed} choices=${choices}
      title=${isOwn ? "On this page" : "For every page"}
      onValue=${(/** @type {string} */ value) => setStage({ speed: value === "time-lapse" ? value : Number(value) })} />
  `;
}

function ClockChoice() {
  const about = options.value?.clocks.find(({ name }) => name === clock.value)?.description ?? "";
  return html`
    <${Choice} label="Clock" isSelfEvident name="clock" getValue=${() => clock.value}
      title=${`${sentence(clockTitle(clock.value))}. ${about}`}
      choices=${choicesOf(options.value?.clocks, clockTitle)}
      onValue=${(/** @type {Clock} */ value) => setStage({ clock: value })} />
  `;
}
