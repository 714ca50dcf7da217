// The standings of the race in view at the moment that is shown, and nothing later.
import { computed } from "@preact/signals";
import { agentOf } from "./agents.js";
import { clock, isActive, raceInView } from "./selectors.js";
import { distanceAt, shownTime, timeSpent, timeline } from "./timeline.js";
import { scene } from "./store.js";

/** @import { ClockResult, LaneConfig, LaneResult, Run, SceneLane, TimelineLane } from "./types.js" */

/** A decision that simulates fewer is over before it can be shown as thinking. */
const FEWEST_SHOWN_FUTURES = 100;

/** The scene, if it shows the race in view. */
export const raceScene = computed(() =>
  scene.value && scene.value.kind === "race" && scene.value.run_id === raceInView.value?.id
    ? scene.value
    : null,
);

/** Whether the moment that is shown is after time-out: the first lane has used its steps. */
export const isTimedOut = computed(() => {
  const timeOut = timeline.value?.first_finish_s ?? null;
  return (
    shownTime.value === Infinity ||
    ["photo-finish", "finished"].includes(raceScene.value?.phase ?? "") ||
    (timeOut !== null && shownTime.value !== null && shownTime.value >= timeOut)
  );
});

/** One row per lane, the leader first; null before the race. */
export const standings = computed(() => {
  const race = raceInView.value;
  const time = shownTime.value;
  if (!race || time === null) return null;
  if (!isActive(race) && !race.progress.done) return null;
  const rows = race.config.lanes.map((lane, number) => rowOf(race, lane, number, time));
  return rows.sort((a, b) => a.rank - b.rank || a.lane - b.lane);
});

/** @typedef {ReturnType<typeof rowOf>} Standing */

/**
 * @param {Run} race
 * @param {LaneConfig} config
 * @param {number} number of the lane, from 0
 * @param {number} time race time that is shown [s]; Infinity after the race
 */
function rowOf(race, { agent, training_id }, number, time) {
  const lane = laneOf(race, number, time);
  const { seen, result } = lane;
  return {
    lane: number,
    agent,
    training_id,
    steps: seen?.steps ?? race.config.steps,
    decision_s: result?.steps ? result.decision_s / result.steps : null,
    ...placeOf(agent, seen, result),
    ...distancesOf(lane),
    ...thinkingOf(seen),
    ...workOf(lane),
  };
}

/** @typedef {ReturnType<typeof laneOf>} Lane */

/**
 * What is known of a lane: its scene, its timeline and its result, each null while there is none.
 * @param {Run} race
 * @param {number} number
 * @param {number} time
 */
function laneOf(race, number, time) {
  const seen = raceScene.value?.lanes.find(({ lane }) => lane === number) ?? null;
  const track = timeline.value?.lanes[number] ?? null;
  const result = race.result?.lanes?.[number] ?? null;
  const isDone = time === Infinity || (seen?.done ?? false);
  return { seen, track, result, isDone, time };
}

/**
 * Steps, simulated transitions and time that a lane has used so far.
 * @param {Lane} lane
 */
function workOf({ seen, track, result, isDone, time }) {
  const step = (time === Infinity ? result?.steps : seen?.step) ?? 0;
  return {
    step,
    isDone,
    simulated: isDone && result ? result.simulated_transitions : simulatedUntil(track, step),
    spent: track ? timeSpent(track, time) : { thought: 0, walked: 0 },
    elapsed_s: track ? Math.min(time, track.total_s) : null,
    failure: seen?.failure ?? (isDone ? result?.failure : null) ?? null,
  };
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
    rank: seen?.rank ?? timed?.rank ?? 1,
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
    total_m: isDone ? result?.total_distance_m ?? distance_m : null,
  };
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
  track ? track.futures.slice(0, steps).reduce((sum, n) => sum + n, 0) : null;
