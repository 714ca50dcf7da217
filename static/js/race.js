// The race in view at the moment that is shown: its timeline, its standings, and what is announced of it.
import { computed, signal } from "@preact/signals";
import { askForNewest, getTimeline, isLasting } from "./api.js";
import { clock, earlyEnd, originalRace, raceInView, raceScene } from "./on-stage.js";
import { isActive, modelOfLane } from "./selectors.js";
import { agentOf } from "./settings.js";
import { connection } from "./store.js";
import { messageOf } from "./titles.js";

/** @import { Signal } from "@preact/signals" */
/** @import { RequestError } from "./api.js" */
/** @import { ClockResult, LaneConfig, LaneResult, Run, SceneLane, Timeline, TimelineLane } from "./types.js" */
/** @import { TimelinePoint } from "./types.js" */

// ---- the timeline under the chosen clock, which grows while the race is simulated

const PAUSE_MS = 350;

/** @type {Signal<Timeline | null>} */
const newest = signal(null);

/** The timeline of the race in view, null while it is not known. */
export const timeline = computed(() => {
  const race = raceInView.value;
  const known = newest.value;
  return race && known?.id === race.id && known.clock === clock.value ? known : null;
});

/** The error of the last request, which was for a race and a clock. @type {Signal<[string, RequestError] | null>} */
const refused = signal(null);

/** Why the timeline cannot be had, or not any more; null where it can be, or will be once the server answers again. */
export const timelineProblem = computed(() => {
  const [of, error] = refused.value ?? [];
  const isAbout = of === `${raceInView.value?.id} ${clock.value}`;
  return error && isAbout && isLasting(error) ? messageOf(error) : null;
});

/** The race time that is shown [s]; null before the stage shows the race. */
export const shownTime = computed(() => raceScene.value?.time_s ?? null);

/**
 * A lane's distance at a race time [m], interpolated between the points of its path.
 * @param {TimelinePoint[]} points
 * @param {number} time
 */
export function distanceAt(points, time) {
  const last = points.at(-1);
  if (!last) return 0;
  const next = points.findIndex(([t]) => t >= time);
  if (next === -1) return last[1];
  if (next === 0) return points[0][1];
  const [[t0, d0], [t1, d1]] = [points[next - 1], points[next]];
  return t1 > t0 ? d0 + ((d1 - d0) * (time - t0)) / (t1 - t0) : d1;
}

/**
 * A lane's path up to a race time, ending in an interpolated point where that is between two.
 * @param {TimelinePoint[]} points
 * @param {number} time
 * @returns {TimelinePoint[]}
 */
export function clipped(points, time) {
  const before = points.filter(([t]) => t <= time);
  if (!before.length) return [[0, 0]];
  return before.length < points.length ? [...before, [time, distanceAt(points, time)]] : before;
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

/** Request the timeline whenever it has grown. */
export const followTimeline = () => askForNewest({
  key: () => {
    const race = raceInView.value;
    if (!race?.progress.done || connection.value !== "live") return "";
    return [race.id, clock.value, race.state, race.progress.done].join(" ");
  },
  ask: async (key) => {
    const [id, shown] = key.split(" ");
    try {
      newest.value = { ...await getTimeline(id, shown), id };
      refused.value = null;
    } catch (error) {
      refused.value = [`${id} ${shown}`, /** @type {RequestError} */ (error)];
      throw error;
    }
  },
  pause_ms: () => PAUSE_MS,
});

// ---- the standings at the moment that is shown, and nothing later

/** A decision that simulates fewer is over before it can be shown as thinking. */
const FEWEST_SHOWN_FUTURES = 100;

/** Lanes that are less apart are level, while they race [m]. */
export const LEVEL_M = 0.01;
const SAME_S = 1e-6;
/** Times of a scene are rounded to milliseconds. */
const SAME_MOMENT_S = 0.001;

/** Numbers of the lanes that use all their steps first, under the clock in use; none while it is not known. */
export const firstTimedOut = computed(() => {
  const race = raceInView.value;
  if (!race) return [];
  const ends = race.config.lanes.map((_, number) => endOf(race, number));
  const first = Math.min(...ends);
  return ends.flatMap((end, number) => (Number.isFinite(end) && end - first < SAME_S ? [number] : []));
});

/**
 * When a lane has used all its steps [s]; Infinity if it has not.
 * @param {Run} race
 * @param {number} number
 */
function endOf(race, number) {
  const result = race.result?.lanes?.[number];
  const track = timeline.value?.lanes[number];
  if (result) return result.steps === race.config.steps ? timedResult(result)?.elapsed_s ?? Infinity : Infinity;
  return track?.steps === race.config.steps ? track.total_s : Infinity;
}

/** Whether the show of the race has ended: at its last step, or with its photo finish. */
export const isOver = computed(() => raceScene.value?.ended ?? false);

/** Whether the moment that is shown is after time-out: the first lane has used its steps. */
export const isTimedOut = computed(() => {
  const { time_s, time_out_s } = raceScene.value ?? { time_s: 0, time_out_s: null };
  return time_out_s !== null && time_s >= time_out_s - SAME_MOMENT_S;
});

/** How the race ended at the moment that is shown, if before its time-out: "Stopped"; else null. */
export const shownEarlyEnd = computed(() =>
  isOver.value && !isTimedOut.value ? earlyEnd(raceInView.value) : null,
);

/** One row per lane, the leader first; null before the race. */
export const standings = computed(() => {
  const race = raceInView.value;
  const time = shownTime.value;
  if (!race || time === null) return null;
  if (!isActive(race) && !race.progress.done) return null;
  const rows = race.config.lanes.map((lane, number) => rowOf(race, lane, number, time));
  return rows.sort((a, b) => a.place - b.place || a.lane - b.lane);
});

/**
 * A row of the board; without a rank if the race ended before its time-out, when no rule ranks its lanes.
 * @typedef {ReturnType<typeof rowOf>} Standing
 */

/**
 * @param {Run} race
 * @param {LaneConfig} config
 * @param {number} number of the lane, from 0
 * @param {number} time race time that is shown [s]
 */
function rowOf(race, config, number, time) {
  const { agent, training_id } = config;
  const lane = laneOf(race, number, time);
  const { seen, result } = lane;
  return {
    lane: number,
    agent,
    training_id,
    plans_with: modelOfLane(race, config),
    steps: seen?.steps ?? race.config.steps,
    decision_s: result?.steps ? result.decision_s / result.steps : null,
    ...placeOf(agent, seen, result),
    ...distancesOf(lane),
    original: originalOf(number),
    ...postureOf(lane),
    ...thinkingOf(seen),
    ...workOf(lane),
  };
}

/** @typedef {ReturnType<typeof laneOf>} Lane */

/**
 * The data of a lane: its scene, its timeline and its result, each null while there is none.
 * @param {Run} race
 * @param {number} number
 * @param {number} time
 */
function laneOf(race, number, time) {
  const seen = raceScene.value?.lanes.find(({ lane }) => lane === number) ?? null;
  const track = timeline.value?.lanes[number] ?? null;
  const result = race.result?.lanes?.[number] ?? null;
  const { done: isDone = false, halted: isHalted = false } = seen ?? {};
  return { seen, track, result, isDone, isHalted, time };
}

/**
 * Steps, simulated transitions and time that a lane has used so far.
 * @param {Lane} lane
 */
function workOf({ seen, track, result, isDone, isHalted, time }) {
  const step = seen?.step ?? 0;
  return {
    step,
    isDone,
    isHalted,
    simulated: isDone && result ? result.simulated_transitions : simulatedUntil(track, step),
    spent: track ? timeSpent(track, time) : { thought: 0, walked: 0 },
    elapsed_s: track ? Math.min(time, track.total_s) : null,
    failure: seen?.failure ?? (isDone ? result?.failure : null) ?? null,
  };
}

/**
 * In which step the lane's robot fell, if that is shown already, and its heading at the end.
 * @param {Lane} lane
 */
function postureOf({ seen, result, isDone }) {
  const fell = result?.fell_at_step ?? null;
  const isShown = fell !== null && (isDone || fell < (seen?.step ?? 0));
  return { fell_at_step: isShown ? fell : null, heading_deg: isDone ? result?.heading_deg ?? null : null };
}

/** @type {(result: LaneResult | null) => ClockResult | undefined} */
const timedResult = (result) => result?.clocks?.[clock.value];

/**
 * The lane's name, colour and rank: of the scene, which may lag behind the result.
 * @param {string} agent
 * @param {SceneLane | null} seen
 * @param {LaneResult | null} result
 */
function placeOf(agent, seen, result) {
  const { title, color } = agentOf(agent);
  const timed = timedResult(result);
  return {
    title: seen?.name ?? title,
    color: seen?.color ?? color,
    /** Place on the board, which is the rank where there are ranks. */
    place: seen?.rank ?? 1,
    rank: shownEarlyEnd.value ? null : seen?.rank ?? 1,
    hasCrossed: seen?.crossed ?? Boolean(timed?.crossed_s),
  };
}

/**
 * Distances now, at time-out and at the end; null before.
 * @param {Lane} lane
 */
function distancesOf({ seen, track, result, isDone, time }) {
  const timed = timedResult(result);
  const distance_m = seen?.distance_m ?? (track ? distanceAt(track.points, time) : timed?.finished_distance_m);
  return {
    distance_m,
    finished_m: isTimedOut.value ? timeOutDistance(track, timed) : null,
    total_m: isDone ? result?.total_distance_m ?? distance_m : totalBeside(result),
  };
}

/**
 * The total distance of a lane that still walks in the picture: told once the show has ended with the photo finish.
 * @param {LaneResult | null} result
 */
const totalBeside = (result) => (isOver.value ? result?.total_distance_m ?? null : null);

/**
 * How far a lane came in the race from which this one branches off; null without one.
 * @param {number} number
 */
function originalOf(number) {
  const result = originalRace.value?.result?.lanes?.[number];
  const timed = timedResult(result ?? null);
  return result && timed ? { finished_m: timed.finished_distance_m, total_m: result.total_distance_m } : null;
}

/** @param {SceneLane | null} seen */
const thinkingOf = (seen) => ({
  isThinking: seen !== null && seen.thinking && seen.futures_total >= FEWEST_SHOWN_FUTURES,
  futures: seen?.futures ?? 0,
  futuresTotal: seen?.futures_total ?? 0,
  isMarching: seen?.marching ?? false,
});

/** @type {(track: TimelineLane | null, timed: ClockResult | undefined) => number | null} */
function timeOutDistance(track, timed) {
  if (timed) return timed.finished_distance_m;
  const timeOut = timeline.value?.first_finish_s ?? null;
  return track && timeOut !== null ? distanceAt(track.points, timeOut) : null;
}

/** @type {(track: TimelineLane | null, steps: number) => number | null} */
const simulatedUntil = (track, steps) =>
  track ? track.futures.slice(0, Math.ceil(steps / track.stride)).reduce((sum, n) => sum + n, 0) : null;
