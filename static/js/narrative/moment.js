// The state of a run, and the lanes of a race at a moment, from what the API tells. The modules of this folder hold no
// signals: they make every sentence about a run and its moment from plain data, as `narrative.js` has it in a table.
// What is said is decided by numbers of steps; where only times are known, those that differ by at most SAME_MOMENT_S
// are the same.
import { t } from "../format.js";
import { SAME_MOMENT_S } from "../replay-frames.js";

/** @import { ClockResult, Clock, LaneConfig, LaneResult, Playback, Run, Scene, SceneLane } from "../types.js" */
/** @import { Timeline, TimelineLane } from "../types.js" */

/** What a sentence needs to know of an agent. @typedef {{ name: string, title: string, color: string }} Agent */

/** Something that happens in a run, in words: "Leg 1 limp from step 6". */
/** @typedef {{ at_step: number, until_step?: number | null, words: string }} Happening */

/**
 * What is known of a race at a moment. `scene` is of the race, null where the picture is of another run.
 * @typedef {object} KnownRace
 * @property {Run | null} race
 * @property {Scene | null} scene
 * @property {Timeline | null} timeline under the clock in use, as far as it has come
 * @property {Clock} clock
 * @property {Agent[]} agents
 */

/** Lanes that are less apart are level, while they race [m]. */
export const LEVEL_M = 0.01;
/** A decision that simulates fewer is over before it can be shown as thinking. */
const FEWEST_SHOWN_FUTURES = 100;

// ---- in which state a run or a race is

const ACTIVE = ["queued", "running", "paused"];

/** @param {Run | null | undefined} run */
export const isActive = (run) => Boolean(run && ACTIVE.includes(run.state));

/** How a run ended that did not take all its steps, as a word that begins a sentence, and as a verb. */
/** @type {Record<string, { word: string, verb: string }>} */
const EARLY_ENDS = {
  stopped: { word: t("Stopped"), verb: t("was stopped") },
  failed: { word: t("Failed"), verb: t("failed") },
  interrupted: { word: t("Interrupted"), verb: t("was interrupted") },
};

/** Null of a run that goes on or has finished. @param {Run | null} run */
export const earlyEndOf = (run) => (run ? EARLY_ENDS[run.state] ?? null : null);

/** Whether a lane has used all its steps. @param {Pick<SceneLane, "steps_made" | "steps" | "failure">} lane */
const hasUsedAll = ({ steps_made, steps, failure }) => !failure && steps > 0 && steps_made >= steps;

/** Whether a race has timed out: the first lane has used its steps, and all others are computed up to there. */
/** @param {Scene | null} scene of a race */
export const isTimedOutIn = (scene) => Boolean(scene && scene.time_out_s !== null && scene.lanes.some(hasUsedAll));

/**
 * Whether the picture of a run is where its distance can be told: at the end of a practice, or a race's time-out.
 * @param {Scene | null} scene
 * @param {string | null} run_id
 */
export const isShownToEnd = (scene, run_id) =>
  scene !== null && scene.run_id === run_id && (scene.kind === "race" ? isTimedOutIn(scene) : scene.ended);

// ---- the figures of a frame, as they are played

/** A live race that has so little left to show waits for a robot that decides [s]. */
const NOTHING_LEFT_S = 0.1;

/**
 * How a run is shown: the moment, and how far it can be shown.
 * @typedef {Pick<Scene, "time_s" | "computed_s" | "duration_s" | "time_out_s"> &
 *   { rate: number, isOwn: boolean }} Shown
 */

/** The figures of a frame, with what holds of how it is played. */
/** @type {(figures: Scene, how: Playback, shown: Shown) => Scene} */
export const sceneOf = (figures, how, shown) => ({
  ...figures, time_s: shown.time_s, computed_s: shown.computed_s, duration_s: shown.duration_s,
  time_out_s: shown.time_out_s, phase: phaseOf(figures, how, shown), playing: how.playing, ended: how.ended,
  shown_speed: shown.rate, clock: how.clock, replay: shown.isOwn || how.origin === "automatic",
});

/** @type {(figures: Scene, how: Playback, shown: Shown) => string} */
function phaseOf({ kind, phase }, { playing }, { time_s, rate, isOwn, computed_s, duration_s, time_out_s }) {
  if (kind !== "race" || phase === "finished") return phase;
  if (rate === 0 && time_out_s !== null && Math.abs(time_s - time_out_s) <= SAME_MOMENT_S) return "photo-finish";
  const isLive = !isOwn && duration_s === null && playing;
  return isLive && computed_s - time_s < NOTHING_LEFT_S ? "waiting" : phase;
}

// ---- the timeline

/**
 * The times at the start and at the end of each step of a lane, or of each so many together [s], with the distances
 * there [m]; null where the timeline does not have each.
 * @param {Pick<TimelineLane, "points" | "thinking" | "futures">} track
 */
export function stepEnds({ points, thinking, futures }) {
  if (points.length - 1 !== thinking.length + futures.length) return null;
  // Each step adds the end of its motion, and before it the end of its thinking, if it took time: the same number.
  const thoughtUntil = new Set(thinking.map(([, to]) => to));
  return points.filter(([at], n) => n === 0 || !thoughtUntil.has(at));
}

/**
 * How many steps a lane has made at a time [s]; of a long race, whose steps the timeline has together, those that are
 * told of. Null where the timeline does not tell.
 * @param {Pick<TimelineLane, "points" | "thinking" | "futures" | "steps" | "stride">} track
 * @param {number} time
 */
export function madeAt(track, time) {
  const ends = stepEnds(track);
  if (!ends) return null;
  const count = ends.filter(([at]) => at <= time + SAME_MOMENT_S).length - 1;
  return Math.min(count * track.stride, track.steps);
}

/**
 * How long a lane has thought and walked until a race time [s].
 * @param {Pick<TimelineLane, "thinking" | "total_s">} lane
 * @param {number} time
 */
export function timeSpent({ thinking, total_s }, time) {
  const elapsed = Math.min(time, total_s);
  const thought = thinking.reduce((sum, [from, to]) => sum + Math.max(0, Math.min(to, elapsed) - from), 0);
  return { thought, walked: elapsed - thought };
}

/**
 * A lane's distance at a race time [m], interpolated between the points of its path.
 * @param {TimelineLane["points"]} points
 * @param {number} time
 */
export function distanceAt(points, time) {
  const last = points.at(-1);
  if (!last) return 0;
  const next = points.findIndex(([at]) => at >= time);
  if (next === -1) return last[1];
  if (next === 0) return points[0][1];
  const [[t0, d0], [t1, d1]] = [points[next - 1], points[next]];
  return t1 > t0 ? d0 + ((d1 - d0) * (time - t0)) / (t1 - t0) : d1;
}

// ---- the lanes, the first before the others

/** @typedef {ReturnType<typeof rowOf>} Row a lane at the moment; without a rank where no rule ranks it */

/** One row per lane, the leader first; null before the race. @param {KnownRace} moment @returns {Row[] | null} */
export function rowsOf(moment) {
  const { race, scene } = moment;
  if (!race || scene?.run_id !== race.id || (!isActive(race) && !race.progress.done)) return null;
  const rows = race.config.lanes.map((lane, number) => rowOf(moment, lane, number));
  return rows.sort((a, b) => a.place - b.place || a.lane - b.lane);
}

/** @type {(known: KnownRace, config: LaneConfig, number: number) => any} */
function laneOf({ race, scene, timeline, clock, agents }, config, number) {
  const seen = scene?.lanes.find(({ lane }) => lane === number) ?? null;
  const result = race?.result?.lanes?.[number] ?? null;
  return {
    seen, result, timed: result?.clocks?.[clock], track: timeline?.lanes[number] ?? null, scene, race, config,
    agent: agents.find(({ name }) => name === config.agent) ?? { title: config.agent, color: "transparent" },
    isTimedOut: isTimedOutIn(scene),
  };
}

/** @param {KnownRace} moment @param {LaneConfig} config @param {number} number of the lane, from 0 */
function rowOf(moment, config, number) {
  const lane = laneOf(moment, config, number);
  return { lane: number, agent: config.agent, training_id: config.training_id, ...placeOf(lane), ...workOf(lane),
    ...distancesOf(lane), ...postureOf(lane), ...thinkingOf(lane) };
}

/**
 * The data of a lane: its scene, its timeline, its result, each null while there is none.
 * @typedef {{
 *   seen: SceneLane | null, result: LaneResult | null, timed: ClockResult | undefined, track: TimelineLane | null,
 *   scene: Scene, race: Run, agent: Agent, isTimedOut: boolean,
 * }} Lane
 */

/** The lane's name, colour and rank: of the scene, which may lag behind the result. @param {Lane} lane */
function placeOf({ seen, timed, agent, scene, race, isTimedOut }) {
  const isRanked = isTimedOut || !(earlyEndOf(race) && (scene.ended || scene.lanes.some(({ halted }) => halted)));
  return {
    title: seen?.name ?? agent.title,
    color: seen?.color ?? agent.color,
    /** Place on the board, which is the rank where there are ranks. */
    place: seen?.rank ?? 1,
    rank: isRanked ? seen?.rank ?? 1 : null,
    hasCrossed: seen?.crossed ?? Boolean(timed?.crossed_s),
  };
}

/** Steps, simulated transitions and time that a lane has used so far. @param {Lane} lane */
function workOf({ seen, track, result, scene, race }) {
  // Before it is in the picture it has done nothing.
  const { steps, step, steps_made, done, halted } = seen ?? { ...NOTHING_DONE, steps: race.config.steps };
  return {
    /** The step that it takes, counted from 1, and those that have ended. */
    step, made: steps_made, steps, isDone: done, isHalted: halted,
    decision_s: result?.steps ? result.decision_s / result.steps : null,
    simulated: done && result ? result.simulated_transitions : simulatedUntil(track, steps_made),
    failure: seen?.failure ?? (done ? result?.failure : null) ?? null,
    ...timesOf(track, scene.time_s),
  };
}

const NOTHING_DONE = { step: 0, steps_made: 0, done: false, halted: false };

/** @param {TimelineLane | null} track @param {number} time_s */
const timesOf = (track, time_s) => ({
  spent: track ? timeSpent(track, time_s) : { thought: 0, walked: 0 },
  elapsed_s: track ? Math.min(time_s, track.total_s) : null,
});

/** @type {(track: TimelineLane | null, made: number) => number | null} */
const simulatedUntil = (track, made) =>
  track ? track.futures.slice(0, Math.ceil(made / track.stride)).reduce((sum, n) => sum + n, 0) : null;

/** In which step the lane's robot fell, if that is shown already, and its heading at the end. @param {Lane} lane */
function postureOf({ seen, result }) {
  const fell = result?.fell_at_step ?? null;
  const isShown = fell !== null && fell < (seen?.steps_made ?? 0);
  return { fell_at_step: isShown ? fell : null, heading_deg: seen?.done ? result?.heading_deg ?? null : null };
}

/** Distances now, at time-out and at the end; null before. @param {Lane} lane */
function distancesOf({ seen, track, result, timed, scene, isTimedOut }) {
  const distance_m = seen?.distance_m ?? (track ? distanceAt(track.points, scene.time_s) : null);
  const atTimeOut = timed?.finished_distance_m ?? seenAtTimeOut(scene, seen) ??
    (track && scene.time_out_s !== null ? distanceAt(track.points, scene.time_out_s) : null);
  const total_m = result?.total_distance_m ?? null;
  return {
    distance_m,
    finished_m: isTimedOut ? atTimeOut : null,
    // Of a lane that still walks in the picture it is told once the show has ended with the photo finish.
    total_m: seen?.done ? total_m ?? distance_m : scene.ended ? total_m : null,
  };
}

/** The distance in the picture, where that is the photo finish [m]. */
/** @param {Scene} scene @param {SceneLane | null} seen */
const seenAtTimeOut = ({ time_s, time_out_s }, seen) =>
  (time_out_s !== null && Math.abs(time_s - time_out_s) <= SAME_MOMENT_S ? seen?.distance_m ?? null : null);

/** @param {Lane} lane */
const thinkingOf = ({ seen }) => ({
  isThinking: seen !== null && seen.thinking && seen.futures_total >= FEWEST_SHOWN_FUTURES,
  futures: seen?.futures ?? 0,
  futuresTotal: seen?.futures_total ?? 0,
  isMarching: seen?.marching ?? false,
});

/** How far a lane has come, by which it is compared: at time-out, or now [m]. @param {Row} row */
export const distanceOf = (row) => row.finished_m ?? row.distance_m ?? 0;
