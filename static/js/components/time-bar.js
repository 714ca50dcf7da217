// The time bar below the stage: play, the moment in the picture, how far the run is computed, what happened, and how it
// is shown. It is shared by every page, unless this one plays a replay of its own.
import { skipToEnd } from "../actions.js";
import { Loaded } from "../features.js";
import { count, decimal, fixed, t, whole } from "../format.js";
import { narrative } from "../headline.js";
import { canPlay, clock, isStale, shownRun } from "../on-stage.js";
import { isPhone, isProjected } from "../page.js";
import { closeReplay, isOwn, openReplay, playback, position, replayProblem, stepReplay } from "../player.js";
import { fittingLabels, percent, shareOf, ticks } from "../scale.js";
import { scene } from "../store.js";
import {
  laneRows, markInWords, marks, positionInWords, pressSlider, scale, seekTo, toggleTime,
} from "../time.js";
import { isAtLeast } from "../workspace.js";
import { html, Icon, useWidth } from "./elements.js";
import { Problem } from "./foot.js";
import { widthOf } from "./line-labels.js";

/** @import { Mark, Scale } from "../time.js" */
/** @import { Scene } from "../types.js" */

export function TimeBar() {
  const shownScale = scale.value;
  return html`
    <div class=${`time-bar ${isOwn.value ? "own" : ""}`} role="group" aria-label="Time">
      ${shownScale && html`<${PlayButton} />`}
      ${isOwn.value && shownScale && html`<${StepButtons} />`}
      ${shownScale ? html`<${Track} known=${shownScale} />` : html`<p class="dim no-time">${narrative.value.bar}</p>`}
      ${isOneLaneLeft(scene.value) && canPlay.value && !isStale.value && html`
        <button class="quiet square" onClick=${skipToEnd} aria-label="Skip to the end" title="Skip to the end">
          <${Icon} name="skip" />
        </button>
      `}
      ${shownScale && isAtLeast("try") && !isPhone.value && canPlay.value && html`
        <${Loaded} name="speeds" load=${loadChoices} isQuiet />
      `}
      ${isOwn.value ? html`<${BackToStage} />` : shownScale && html`<${ReplayButton} />`}
      <${Problem} at="stage" />
    </div>
  `;
}

function PlayButton() {
  const { isPlaying, label } = narrative.value.play;
  return html`
    <button class="play" disabled=${!playback.value?.run_id} aria-disabled=${isStale.value ? "true" : undefined}
      onClick=${toggleTime} aria-label=${label} title=${label}>
      <${Icon} name=${isPlaying ? "pause" : "play"} />
    </button>
  `;
}

// ---- a replay of this page's own

/** Operators have the stage's own bar; who has none replays as soon as the bar is touched. */
function ReplayButton() {
  const run = shownRun.value;
  if (!run?.progress?.done || !(isAtLeast("try") || isPhone.value)) return null;
  const open = () => openReplay(run.id, { time_s: position.peek(), clock: clock.value });
  return html`
    <button class="quiet square" aria-label="Replay" disabled=${isStale.value} onClick=${open}
      title="Replay: play and seek for yourself; the stage goes on for everyone">
      <${Icon} name="replay" />
    </button>
  `;
}

/** Where there is no replay, the note that says why has it. */
const BackToStage = () => !replayProblem.value && html`
  <button class="secondary compact to-stage" onClick=${closeReplay} title="Watch what everyone sees">
    <span class="dot" aria-hidden="true"></span>Back to the stage
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

// ---- the track: both times, and what happened

const SMALL_PX = 12;
const LABEL_GAP_PX = 6;
const TICK_GAP_PX = 20;
/** As workspace.css has it on both sides of the moment in the picture. */
const BUBBLE_PADDING_PX = 8;

/** The width of a text of the bar, whose type is larger where the page is projected. @param {string} text */
const textWidth = (text, weight = 600) =>
  widthOf(text, weight) * (isProjected.value ? rootFontSize() / SMALL_PX : 1);
const rootFontSize = () => parseFloat(getComputedStyle(document.documentElement).fontSize);

/** @param {{ known: Scale }} props */
function Track({ known }) {
  const [host, width] = useWidth();
  const { unit, end, picture, computed, isComputing } = known;
  const place = (/** @type {number} */ at) => percent(shareOf(at, 0, end));
  const inWords = (/** @type {number} */ moment) => positionInWords(known, moment);
  const values = { at: inWords(picture), last: inWords(end), computed: inWords(computed) };
  /** @param {{ target: HTMLInputElement }} event */
  const seek = ({ target }) => {
    // Not `disabled`, by which it would lose the keyboard's focus whenever the connection breaks.
    if (isStale.peek()) target.value = String(picture);
    else seekTo(Number(target.value));
  };
  // The replay of this page's own follows the thumb; a stage that many watch is asked once.
  const handlers = isOwn.value ? { onInput: seek } : { onChange: seek };
  /** @param {KeyboardEvent} event */
  const press = (event) => {
    const isPlain = !event.ctrlKey && !event.altKey && !event.metaKey;
    if (isPlain && pressSlider(event.key)) event.preventDefault();
  };
  return html`
    <div class="track" ref=${host} style=${{ "--picture": place(picture), "--computed": place(computed) }}>
      <div class="above" aria-hidden="true">
        ${labelsAbove(known, width).map(({ kind, at, text, left }) => html`
          <span key=${`${kind} ${at}`} class=${kind} style=${{ left: `${left}px` }}>${text}</span>
        `)}
      </div>
      <div class="rail">
        <input type="range" min="0" max=${end} step=${unit === "s" ? 0.01 : 1} value=${picture} onKeyDown=${press}
          ...${handlers}
          aria-disabled=${isStale.value ? "true" : undefined}
          aria-label=${isOwn.value ? t("Moment of your replay") : t("Moment that is shown")}
          aria-valuetext=${isComputing
            ? t("{at} of {last}, computed up to {computed}", values) : t("{at} of {last}", values)} />
        ${isComputing && html`<i class="computed-end" style=${{ left: place(computed) }} aria-hidden="true"></i>`}
        <${Marks} place=${place} />
      </div>
      ${isAtLeast("study") && laneRows.value.map((row) => html`<${LaneRow} key=${row.name} row=${row} end=${end} />`)}
      <${Below} known=${known} width=${width} />
    </div>
  `;
}

/**
 * The labels above the rail that fit beside each other: how far it is computed, and what happened.
 * @param {Scale} known
 * @param {number} width [px]
 */
function labelsAbove(known, width) {
  const { computed, isComputing, end } = known;
  const first = isComputing && computed < end
    ? [{ kind: "computed", at: computed, text: t("computed {at}", { at: positionInWords(known, computed) }) }] : [];
  const named = marks.value.filter(({ isMinor }) => !isMinor).toSorted((a, b) => weightOf(a) - weightOf(b));
  const labels = [...first, ...named].map((mark) => ({ ...mark, size: textWidth(mark.text) }));
  return fittingLabels(labels, end, width, LABEL_GAP_PX);
}

/** @param {Mark} mark */
const weightOf = ({ kind }) => ["time-out", "fall", "disturbance", "change", "crossing"].indexOf(kind);

/**
 * Each mark: a line, and for those who try a button that goes there; not under a thumb, which meets several at once.
 * @param {{ place: (at: number) => string }} props
 */
const Marks = ({ place }) => html`
  <span class="marks">
    ${marks.value.map((mark) => (mark.isMinor || !isAtLeast("try") || isPhone.value
      ? html`<i class=${mark.kind} style=${{ left: place(mark.at) }} aria-hidden="true"></i>`
      : html`
        <button class=${mark.kind} style=${{ left: place(mark.at) }} title=${markInWords(mark)}
          aria-label=${t("Go to: {mark}", { mark: mark.text })}
          onClick=${() => seekTo(mark.at, { isHeld: true })}></button>
      `))}
  </span>
`;

/** How a lane spent its time. @param {{ row: typeof laneRows.value[number], end: number }} props */
const LaneRow = ({ row: { name, color, thinking, until }, end }) => html`
  <div class="lane-row" role="img" style=${{ "--agent": color }}
    aria-label=${t("{name}: walking solid, thinking hatched", { name })}>
    <i class="walked" style=${{ width: percent(shareOf(Math.min(until, end), 0, end)) }}></i>
    ${thinking.filter(([from]) => from < end).map(([from, to]) => html`
      <i class="thought" style=${{
        left: percent(shareOf(from, 0, end)), width: percent(shareOf(Math.min(to, end) - from, 0, end)),
      }}></i>
    `)}
  </div>
`;

const MIN_TICK_GAP_PX = 90;

/**
 * The scale, and on it the moment in the picture.
 * @param {{ known: Scale, width: number }} props
 */
function Below({ known: { unit, end, picture }, width }) {
  const wanted = Math.max(2, Math.min(6, Math.floor(width / MIN_TICK_GAP_PX)));
  const shown = unit === "s" ? `${fixed(picture, 1)}\u00a0s` : t("step {step}", { step: picture });
  const last = unit === "s" ? `${decimal(Number(end.toFixed(1)))}\u00a0s` : count(end, "step");
  const scaleLabels = [
    { kind: "last", at: end, text: last },
    ...ticks(end, wanted).map((tick) => ({ kind: "tick", at: tick, text: unit === "s" ? decimal(tick) : whole(tick) })),
  ].map((label) => ({ ...label, size: textWidth(label.text, 400) }));
  const moment = { kind: "bubble", at: picture, text: shown, size: textWidth(shown) + 2 * BUBBLE_PADDING_PX };
  return html`
    <div class="below-rail" aria-hidden="true">
      ${fittingLabels([moment, ...scaleLabels], end, width, TICK_GAP_PX).map(({ kind, at, text, left }) => html`
        <span key=${kind === "bubble" ? kind : at} class=${kind} style=${{ left: `${left}px` }}>${text}</span>
      `)}
    </div>
  `;
}

// ---- how it is shown

/** @param {Scene | null} now */
const isOneLaneLeft = (now) =>
  now?.kind === "race" && now.phase !== "finished" && now.lanes?.length > 1 && now.duration_s &&
  now.lanes.filter(({ done, halted }) => !done && !halted).length === 1;

const loadChoices = () => import("./time-choices.js").then(({ TimeChoices }) => TimeChoices);
