// The moment that is shown on one scale: seconds of a race under its clock, steps of a practice. What happened on it.
import { computed } from "@preact/signals";
import { setStage, togglePlaying } from "./actions.js";
import { curve, rateChanges, rateInWords } from "./training.js";
import { disturbancesOf, inWords } from "./disturbances.js";
import { fixed, metres, sentence, t } from "./format.js";
import { canPlay, clock, isStale, raceScene, shownRun } from "./on-stage.js";
import { timeline } from "./race.js";
import { isCutAtTimeOut, isOwn, openReplay, playReplay, position } from "./player.js";
import { SAME_MOMENT_S } from "./replay-frames.js";
import { stepEnds } from "./narrative/moment.js";
import { isActive } from "./selectors.js";
import { agentOf, laneTitle } from "./settings.js";
import { scene } from "./store.js";

/** @import { ReadonlySignal } from "@preact/signals" */
/** @import { Run, TimelineLane } from "./types.js" */

/**
 * `unit_s`: how long a unit of the scale is in the run's own time [s]. `end`: of the bar. `picture`: the moment that is
 * drawn. `computed`: up to which there is something to draw.
 * @typedef {{
 *   unit: "s" | "step", unit_s: number, end: number, picture: number, computed: number, isComputing: boolean,
 * }} Scale
 */

/** The shortest bar of a race that has just begun [s]. */
const FIRST_VIEW_S = 10;
/** A race that is computed is expected to take longer by this share. */
const AHEAD = 1.1;

/** The scale of the run on stage; null while nothing of it can be shown. @type {ReadonlySignal<Scale | null>} */
export const scale = computed(() => {
  const now = scene.value;
  const run = shownRun.value;
  if (!now || now.kind === "idle" || !run || run.id !== now.run_id) return null;
  const isComputing = isActive(run);
  return run.kind === "training" ? ofPractice(run, isComputing) : ofRace(isComputing);
});

/** @param {Run} run @param {boolean} isComputing @returns {Scale | null} */
function ofPractice(run, isComputing) {
  const { duration_s = null, computed_s = 0 } = scene.value ?? {};
  if (!duration_s) return null;
  const { steps } = run.config;
  const unit_s = duration_s / steps;
  // Of one that has ended there is what is recorded: a crash loses the last of the steps that were done.
  const stepsMade = isComputing ? run.progress.done : Math.round(computed_s / unit_s);
  const end = isComputing ? steps : Math.max(stepsMade, 1);
  const picture = Math.min(position.value / unit_s, stepsMade);
  return { unit: "step", unit_s, end, picture, computed: stepsMade, isComputing };
}

/** @param {boolean} isComputing @returns {Scale | null} */
function ofRace(isComputing) {
  const { duration_s = null, computed_s = 0, time_out_s = null } = scene.value ?? {};
  const whole_s = duration_s ?? Math.max(AHEAD * computed_s, FIRST_VIEW_S);
  const picture = position.value;
  const isAtTimeOut = isCutAtTimeOut.value && time_out_s !== null && picture <= time_out_s + SAME_MOMENT_S;
  const end = isAtTimeOut ? time_out_s : whole_s;
  return { unit: "s", unit_s: 1, end, picture, computed: Math.min(computed_s, end), isComputing };
}

/** @param {Pick<Scale, "unit">} scale @param {number} at */
export const positionInWords = ({ unit }, at) =>
  (unit === "s" ? `${fixed(at, 1)}\u00a0s` : t("step {step}", { step: Math.round(at) }));

// ---- what happened: marks on the bar

/**
 * `at` on the scale; `isMinor`: drawn, but neither named nor a stop on the way.
 * @typedef {{ kind: string, at: number, text: string, lane?: number, isMinor?: boolean }} Mark
 */

/** What has happened in the run on stage as far as it is computed, in order. @type {ReadonlySignal<Mark[]>} */
export const marks = computed(() => {
  const run = shownRun.value;
  const scaleNow = scale.value;
  if (!run || !scaleNow) return [];
  const all = run.kind === "training" ? marksOfPractice(run) : marksOfRace(run);
  const last = Math.min(scaleNow.computed, scaleNow.end) + SAME_MOMENT_S;
  return all.filter(({ at }) => at <= last).sort((a, b) => a.at - b.at);
});

/** @param {Run} run @returns {Mark[]} */
function marksOfPractice(run) {
  const practice = curve.value?.run.id === run.id ? curve.value : null;
  const evaluations = (practice?.points ?? []).filter(({ step }) => step > (practice?.from ?? 0)).map((point) => ({
    kind: "evaluation", at: point.step - (practice?.from ?? 0), isMinor: true,
    text: t("test: {distance}", { distance: metres(point.distance_m) }),
  }));
  const changes = rateChanges(run).map((rateChange) => ({
    kind: "change", at: rateChange.step, text: rateInWords(run.config.agent, rateChange),
  }));
  const happened = disturbancesOf(run).filter(({ at_step }) => at_step > 0)
    .map((disturbance) => ({ kind: "disturbance", at: disturbance.at_step, text: inWords(disturbance) }));
  const fell = run.result?.fell_at_step ?? null;
  const falls = fell === null ? [] : [{ kind: "fall", at: fell, text: t("falls") }];
  return [...evaluations, ...changes, ...happened, ...falls];
}

/**
 * When a lane has first come so far [s]; null if it has not.
 * @param {Pick<TimelineLane, "points">} track
 * @param {number} distance_m
 */
export function timeAtDistance({ points }, distance_m) {
  const next = points.findIndex(([, distance]) => distance >= distance_m);
  if (next < 0) return null;
  if (next === 0) return points[0][0];
  const [[t0, d0], [t1, d1]] = [points[next - 1], points[next]];
  return t0 + ((t1 - t0) * (distance_m - d0)) / (d1 - d0 || 1);
}

/** @param {Run} race @returns {Mark[]} */
function marksOfRace(race) {
  const raceTimeline = timeline.value;
  const { time_out_s = null } = raceScene.value ?? {};
  const timeOut = time_out_s === null ? [] : [{ kind: "time-out", at: time_out_s, text: t("time-out") }];
  const finish_m = raceTimeline?.finish_line_m ?? 0;
  const ofLanes = (raceTimeline?.lanes ?? []).flatMap((track, lane) => marksOfLane(race, track, lane, finish_m));
  return [...timeOut, ...ofLanes];
}

/** @param {Run} race @param {TimelineLane} track @param {number} lane @param {number} finish_m @returns {Mark[]} */
function marksOfLane(race, track, lane, finish_m) {
  const name = laneTitle(race.config.lanes[lane] ?? track);
  const ends = stepEnds(track)?.map(([at]) => at);
  const crossed = timeAtDistance(track, finish_m);
  const fell = race.result?.lanes[lane]?.fell_at_step ?? null;
  /** @type {Mark[]} */
  const raceMarks = crossed === null
    ? []
    : [{ kind: "crossing", at: crossed, lane, text: t("{name} crosses the line", { name }) }];
  if (fell !== null && ends?.[fell] !== undefined) {
    raceMarks.push({ kind: "fall", at: ends[fell], lane, text: t("{name} falls", { name }) });
  }
  for (const disturbance of disturbancesOf(race)) {
    const at = disturbance.at_step ? ends?.[disturbance.at_step] : undefined;
    if (at !== undefined) raceMarks.push({ kind: "disturbance", at, lane, text: `${inWords(disturbance)}, ${name}` });
  }
  return raceMarks;
}

// ---- what a user can do with it

/**
 * Show a position of the scale: on the stage by its operators, by others in a replay of their own.
 * @param {number} at
 * @param {{ isHeld?: boolean }} [how]
 */
export function seekTo(at, { isHeld = false } = {}) {
  const scaleNow = scale.peek();
  const run = shownRun.peek();
  if (!scaleNow || !run || isStale.peek()) return;
  lastPress.time_ms = -Infinity;
  const to_s = scaleNow.unit_s * Math.min(Math.max(at, 0), scaleNow.computed);
  if (canPlay.peek()) setStage(isHeld ? { time_s: to_s, playing: false } : { time_s: to_s });
  else openReplay(run.id, { time_s: to_s, clock: clock.peek(), isPlaying: !isHeld });
}

/** What a press of an arrow key moves by: a tenth of a second of a race, or a step of a practice. */
const PRESS = { s: 0.1, step: 1 };
const PAGE_PRESSES = 10;
/** Presses that follow each other so soon go on from where the one before led: the picture comes later. */
const PRESS_MS = 1000;
let lastPress = { id: "", at: 0, time_ms: -Infinity };

/**
 * Keys of the time slider → the position to go to, from another.
 * @type {Record<string, (at: number, of: Scale) => number>}
 */
const SLIDER_KEYS = {
  ArrowRight: (at, { unit }) => at + PRESS[unit], ArrowUp: (at, { unit }) => at + PRESS[unit],
  ArrowLeft: (at, { unit }) => at - PRESS[unit], ArrowDown: (at, { unit }) => at - PRESS[unit],
  PageUp: (at, { unit }) => at + PAGE_PRESSES * PRESS[unit],
  PageDown: (at, { unit }) => at - PAGE_PRESSES * PRESS[unit],
  Home: () => 0, End: (_, { end }) => end,
};

/** Move by a key of the time slider; false if it is none. @param {string} key */
export function pressSlider(key) {
  const [scaleNow, run, move] = [scale.peek(), shownRun.peek(), SLIDER_KEYS[key]];
  if (!move) return false;
  if (!scaleNow || !run || isStale.peek()) return true;
  const now_ms = performance.now();
  const goesOn = lastPress.id === run.id && now_ms - lastPress.time_ms < PRESS_MS;
  const at = Math.min(Math.max(move(goesOn ? lastPress.at : scaleNow.picture, scaleNow), 0), scaleNow.computed);
  seekTo(at);
  lastPress = { id: run.id, at, time_ms: now_ms };
  return true;
}

/** Go to the next thing that happened, or to the one before. @param {1 | -1} direction */
export function seekToMark(direction) {
  const scaleNow = scale.peek();
  if (!scaleNow) return;
  const stops = marks.peek().filter(({ isMinor }) => !isMinor).map(({ at }) => at);
  const margin = 0.002 * scaleNow.end;
  const next = direction > 0
    ? stops.find((at) => at > scaleNow.picture + margin)
    : stops.findLast((at) => at < scaleNow.picture - margin);
  if (next !== undefined) seekTo(next, { isHeld: true });
}

/** Play or pause: the stage by its operators, by others a replay of their own. */
export function toggleTime() {
  const run = shownRun.peek();
  if (isStale.peek()) return;
  if (canPlay.peek()) togglePlaying();
  else if (run && !isOwn.peek()) {
    openReplay(run.id, { time_s: position.peek(), clock: clock.peek(), isPlaying: false });
  } else playReplay(true);
}

/** The lanes of the race in view as stretches of thinking and walking, for the bar. */
export const laneRows = computed(() => {
  const race = shownRun.value?.kind === "race" ? shownRun.value : null;
  return (race && timeline.value ? timeline.value.lanes : []).map((track, number) => ({
    name: laneTitle(race?.config.lanes[number] ?? track), color: agentOf(track.agent).color,
    thinking: track.thinking, until: track.points.at(-1)?.[0] ?? 0,
  }));
});

/** A mark's text as it begins a sentence. @param {Mark} mark */
export const markInWords = ({ text }) => sentence(text);
