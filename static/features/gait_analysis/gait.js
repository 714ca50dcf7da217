// The gait of the run in view: its analysis by the server, the moment of each lane that is shown, and its figures in
// words. Times are robot time: motion only, without the time that decisions take.
import { computed, signal } from "@preact/signals";
import { setStage } from "../../js/actions.js";
import { askForNewest, call, isLasting } from "../../js/api.js";
import { count } from "../../js/format.js";
import { shownTime, timeline } from "../../js/race.js";
import { timeSpent } from "../../js/narrative/moment.js";
import { canPlay, raceInView, shownRun } from "../../js/on-stage.js";
import { limitsOf } from "../../js/settings.js";
import { playback } from "../../js/player.js";
import { connection, options, scene } from "../../js/store.js";
import { messageOf } from "../../js/titles.js";

/** @import { Signal } from "@preact/signals" */
/** @import { RequestError } from "../../js/api.js" */
/** @import { GaitAnalysis, GaitFigures, GaitLane, Run, TimelineLane } from "../../js/types.js" */

/**
 * The gait of a race, or of a part of a training; from a moment of robot time on, or all that is analysed at once.
 * @type {(id: string, part: string, from_s: number | null) => Promise<GaitAnalysis>}
 */
const getGait = (id, part, from_s) => {
  const query = new URLSearchParams(part === "race" ? {} : { part });
  if (from_s !== null) query.set("from_s", String(from_s));
  return call("GET", `runs/${encodeURIComponent(id)}/gait?${query}`);
};

const MINUS = "\u2212";
const PAUSE_MS = 1000;
/** The server analyses at most so much at once [s]. */
const longestWindow = () => limitsOf("gait_window_s").maximum ?? Infinity;
/** Of a longer walk parts are requested that overlap by half. */
const partLength = () => longestWindow() / 2;
/** Time shown before and after the present moment [s]. */
export const BEFORE_S = 3;
export const AFTER_S = 1.5;

/** Of a training: its practice, or its newest evaluation. @type {Signal<"practice" | "evaluation">} */
export const part = signal("practice");
/** Whether the whole walk is drawn, instead of what is around the present moment. */
export const isWhole = signal(false);

/** Subject of the panel: a race, or a part of a training. */
export const subject = computed(() => {
  const shown = shownRun.value;
  const isPractice = shown?.kind === "training" && (scene.value?.kind === "training" || !raceInView.value);
  if (shown && isPractice) return { run: shown, part: part.value };
  return raceInView.value && { run: raceInView.value, part: "race" };
});

/** An answer; `number` is that of the part that was requested, null where all was. */
/** @type {Signal<{ id: string, number: number | null, answer: GaitAnalysis } | null>} */
const newest = signal(null);

/** The newest answer about the subject. */
const known = computed(() => {
  const about = subject.value;
  return about && newest.value?.id === about.run.id && newest.value.answer.part === about.part ? newest.value : null;
});

/** The analysis of the subject, null while it is not known. */
export const analysis = computed(() => known.value?.answer ?? null);

/** The error of the last request. @type {Signal<{ id: string, part: string, error: RequestError } | null>} */
const failure = signal(null);

/** Why the subject is not analysed, or not any more; null where it is, or will be once the server answers again. */
export const problem = computed(() => {
  const { id, part: asked, error } = failure.value ?? {};
  const isAbout = id === subject.value?.run.id && asked === subject.value?.part;
  return error && isAbout && (isLasting(error) || !known.value) ? messageOf(error) : null;
});

// ---- the moment that is shown

/**
 * The robot time of a lane at the moment that is shown [s]; null if none is shown.
 * @param {number} number of the lane, from 0
 */
export function momentOf(number) {
  const about = subject.value;
  if (about?.part === "race") {
    const lane = timeline.value?.lanes[number];
    return lane && shownTime.value !== null ? timeSpent(lane, shownTime.value).walked : null;
  }
  return about?.part === "practice" && scene.value?.run_id === about.run.id ? scene.value.time_s : null;
}

/** The colour of a race's lane, which differs from its agent's if another lane has that. @param {number} number */
export const colorOf = (number) => timeline.value?.lanes[number]?.color;

/**
 * The race time at which a lane has walked for so long [s]; where it then thinks, the end of that.
 * @param {Pick<TimelineLane, "thinking">} lane
 * @param {number} walked
 */
export const raceTimeAt = ({ thinking }, walked) =>
  thinking.reduce((time, [from, to]) => (from <= time ? time + to - from : time), walked);

/** Whether this page may choose the moment that is shown. */
export const canSeek = computed(() => {
  const about = subject.value;
  return canPlay.value && playback.value?.run_id === about?.run.id && about?.part !== "evaluation";
});

/**
 * Show the moment at which a lane has walked for so long [s].
 * @param {number} number of the lane, from 0
 * @param {number} walked
 */
export function seek(number, walked) {
  const lane = timeline.value?.lanes[number];
  if (!canSeek.value) return;
  if (subject.value?.part !== "race") setStage({ time_s: Math.max(0, walked) });
  else if (lane) setStage({ time_s: raceTimeAt(lane, Math.max(0, walked)) });
}

// ---- requests

/** Of a walk that is long, or recorded in parts: the number of the part that is shown. */
const partShown = computed(() => {
  const moment = momentOf(0) ?? 0;
  const isElsewhere = (/** @type {GaitLane} */ { recorded_from_s: from, recorded_to_s: to }) =>
    to - from > longestWindow() + 1e-6 || moment < from || (moment > to && subject.value?.part === "practice");
  const isInParts = known.value && (known.value.number !== null || known.value.answer.lanes.some(isElsewhere));
  return isInParts ? Math.floor(moment / partLength()) : null;
});

/** The beginning of what is requested of such a walk [s]. @param {number} shown */
const beginOf = (shown) => Math.max(0, (shown - 0.5) * partLength());

/** Request the analysis whenever the run has grown, or the moment that is shown has left the part that is known. */
export const followGait = () => askForNewest({
  key: () => {
    const about = subject.value;
    if (!about?.run.progress.done || connection.value !== "live") return "";
    const { run } = about;
    return [run.id, about.part, partShown.value, run.state, run.progress.done].join(" ");
  },
  ask: async (key) => {
    const [id, asked, shown] = key.split(" ");
    const number = shown === "" ? null : Number(shown);
    try {
      newest.value = { id, number, answer: await getGait(id, asked, number === null ? null : beginOf(number)) };
      failure.value = null;
    } catch (refused) {
      const error = /** @type {RequestError} */ (refused);
      failure.value = { id, part: asked, error };
      throw error;
    }
  },
  pause_ms: () => PAUSE_MS,
});

// ---- what is drawn

/**
 * The legs pair by pair: [number from 1, number of the pair from 1]; of a gait of one's own without pairs.
 * @param {Run} run
 * @param {number} legs
 * @returns {[number, number | null][]}
 */
export function legsInOrder(run, legs) {
  const gait = options.value?.gaits.find(({ name }) => name === run.config.gait);
  if (gait?.pairs.flat().length !== legs) return Array.from({ length: legs }, (_, n) => [n + 1, null]);
  return gait.pairs.flatMap((pair, n) => pair.map((leg) => /** @type {[number, number]} */ ([leg, n + 1])));
}

/**
 * When a foot is in the air: the gaps between its stances.
 * @param {[number, number][]} stance
 * @param {{ from_s: number, to_s: number }} window
 * @returns {[number, number][]}
 */
export function swingsOf(stance, { from_s, to_s }) {
  const starts = [from_s, ...stance.map(([, end]) => end)];
  const ends = [...stance.map(([start]) => start), to_s];
  return starts.map((start, n) => /** @type {[number, number]} */ ([start, ends[n]])).filter(([a, b]) => b - a > 1e-4);
}

/**
 * Numbers of the legs whose feet are in the air at a time.
 * @param {GaitFigures} figures
 * @param {number} time
 */
export const legsInTheAir = ({ legs }, time) =>
  legs.filter(({ stance }) => !stance.some(([from, to]) => from <= time && time <= to)).map(({ leg }) => leg);

/**
 * A line over time: `source` and `values` name the list of its values in the figures, which are multiplied by `factor`;
 * its axis is at least `least` long, and may begin at 0.
 * @typedef {object} Series
 * @property {string} name
 * @property {string} unit
 * @property {"posture" | "effort"} source
 * @property {string} values
 * @property {number} [factor]
 * @property {number} [decimals]
 * @property {number} least
 * @property {boolean} [zero]
 */

/** @type {Series[]} */
export const SERIES = [
  { name: "Body height", unit: "\u00a0mm", source: "posture", values: "height_m", factor: 1000, decimals: 0, least: 4 },
  { name: "Pitch", unit: "°", source: "posture", values: "pitch_deg", least: 2 },
  { name: "Roll", unit: "°", source: "posture", values: "roll_deg", least: 2 },
  { name: "Torque", unit: "\u00a0N·m", source: "effort", values: "torque_nm", least: 0.2, zero: true },
  { name: "Power", unit: "\u00a0W", source: "effort", values: "power_w", least: 0.5, zero: true },
];

/**
 * The times and the values of a line, in its unit; null where they were not recorded.
 * @param {GaitFigures} figures
 * @param {Series} series
 * @returns {{ times: number[], values: number[] } | null}
 */
export function lineOf(figures, { source, values, factor = 1 }) {
  const lists = /** @type {any} */ (source === "posture" ? figures.posture : figures.effort);
  return lists && { times: lists.time_s, values: lists[values].map((/** @type {number} */ value) => factor * value) };
}

/**
 * The lowest and the highest value that an axis must show.
 * @param {number[][]} lists of values
 * @param {Pick<Series, "least" | "zero">} series
 */
export function extentOf(lists, { least, zero = false }) {
  const reduce = (/** @type {(a: number, b: number) => number} */ pick, /** @type {number} */ start) =>
    lists.reduce((best, values) => values.reduce((picked, value) => pick(picked, value), best), start);
  const low = zero ? 0 : reduce(Math.min, Infinity);
  const high = reduce(Math.max, -Infinity);
  const missing = Math.max(0, least - (high - low));
  return zero ? { low, high: high + missing } : { low: low - missing / 2, high: high + missing / 2 };
}

// ---- the figures in words

/** @param {number} value @param {number} decimals */
const number = (value, decimals) => value.toFixed(decimals).replace(/^-(?=.*[1-9])/, MINUS).replace(/^-/, "");

/**
 * A range in words: "98 to 102 mm".
 * @type {(range: [number, number], decimals: number, unit: string, factor?: number) => string}
 */
export const rangeInWords = ([low, high], decimals, unit, factor = 1) => {
  const [from, to] = [number(factor * low, decimals), number(factor * high, decimals)];
  return from === to ? `${from}${unit}` : `${from} to ${to}${unit}`;
};

/** @param {GaitFigures} figures */
const cycleInWords = ({ cycle }) =>
  cycle ? `${count(cycle.steps, "step")}, ${number(cycle.period_s, 2)}\u00a0s` : "none";

/**
 * [name, what it is, its words, null where there are none].
 * @type {[string, string, (figures: GaitFigures) => string | null][]}
 */
export const FIGURES = [
  ["Speed", "Distance by robot time: motion only, without the time in which the agent decides.",
    ({ speed_m_s }) => `${number(speed_m_s, 3)}\u00a0m/s`],
  ["Body lengths", "Speed in body lengths a second. A body length is the diameter of the torso.",
    ({ speed_body_lengths_s }) => `${number(speed_body_lengths_s, 2)} a\u00a0second`],
  ["Duty factor", "The share of time in which a foot is on the ground, mean of all legs.",
    ({ duty_factor }) => number(duty_factor, 2)],
  ["Cycle", "The steps that the walk repeats at its end, at least three times in a row.", cycleInWords],
  ["Body height", "Of the torso’s centre over flat ground, lowest to highest.",
    ({ posture }) => rangeInWords(posture.height_range_m, 1, "\u00a0mm", 1000)],
  ["Pitch", "How far the front is up; below zero it is down.",
    ({ posture }) => rangeInWords(posture.pitch_range_deg, 1, "°")],
  ["Roll", "How far the left side is up; below zero it is down.",
    ({ posture }) => rangeInWords(posture.roll_range_deg, 1, "°")],
  ["Largest torque", "Of any servo, with the most that this servo has.",
    ({ effort }) => effort && `${number(effort.largest_torque_nm, 2)} of ${effort.torque_limit_nm}\u00a0N·m`],
  ["Energy", "Mechanical work of all servos. What motors and electronics lose is not simulated.",
    ({ effort }) => effort && `${number(effort.energy_j, 1)}\u00a0J`],
  ["Power", "Energy by robot time.", ({ effort }) => effort && `${number(effort.mean_power_w, 2)}\u00a0W`],
  ["Cost of transport", "Energy by weight and distance: the lower, the cheaper the walk. None without distance.",
    ({ effort }) => effort && (effort.cost_of_transport === null ? null : number(effort.cost_of_transport, 2))],
];

/**
 * The cycle of a lane as a sentence with its pairs of legs: "From step 6 on it repeats 3 steps: 2 and 5, …".
 * @param {GaitFigures} figures
 * @param {[number, number | null][]} legs in order
 */
export function cycleSentence({ cycle }, legs) {
  if (!cycle) return "";
  const pairs = cycle.actions.map(([pair]) => {
    const legsOfPair = legs.filter(([, its]) => its === pair + 1).map(([leg]) => leg);
    return legsOfPair.length ? legsOfPair.join(" and ") : `pair ${pair + 1}`;
  });
  const advance = `${number(100 * cycle.advance_m, 1)}\u00a0cm`;
  return `From step ${cycle.first_step + 1} on it repeats ${count(cycle.steps, "step")} of ${advance} in all; ` +
    `legs ${pairs.join(", then ")}.`;
}
