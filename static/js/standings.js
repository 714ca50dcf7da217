// Who is where in the race in view, up to the moment that is on screen and no further.
import { computed } from "@preact/signals";
import { agentOf, clock, isActive, raceInView } from "./selectors.js";
import { distanceAt, shownTime, spent, timeline } from "./timeline.js";
import { scene } from "./store.js";

const SURELY_THINKING_FUTURES = 100;

/** Whether the first lane has used its steps, on screen. */
export const isDecided = computed(() => {
  const first = timeline.value?.first_finish_s;
  return (
    shownTime.value === Infinity ||
    ["photo-finish", "finished"].includes(raceScene.value?.phase) ||
    (first !== null && first !== undefined && shownTime.value !== null && shownTime.value >= first)
  );
});

/** The scene, if it is of the race in view. */
export const raceScene = computed(() =>
  scene.value && scene.value.kind === "race" && scene.value.run_id === raceInView.value?.id
    ? scene.value
    : null,
);

/** One row a lane, the leader first; null while there is no race to speak of. */
export const standings = computed(() => {
  const race = raceInView.value;
  const time = shownTime.value;
  if (!race || time === null) return null;
  if (!isActive(race) && !race.progress.done) return null;
  const rows = race.config.lanes.map((lane, number) => rowOf(race, lane, number, time));
  return rows.sort((a, b) => a.rank - b.rank || a.lane - b.lane);
});

function rowOf(race, { agent, training_id }, number, time) {
  const { title, color } = agentOf(agent);
  const seen = raceScene.value?.lanes?.find(({ lane }) => lane === number) ?? null;
  const track = timeline.value?.lanes[number] ?? null;
  const result = race.result?.lanes?.[number] ?? null;
  const timed = result?.clocks?.[clock.value];
  const isOver = time === Infinity || (seen?.done ?? false);
  const distance_m = seen?.distance_m ?? (track ? distanceAt(track.points, time) : timed?.finished_distance_m);
  const steps = time === Infinity ? result?.steps : seen?.step;
  return {
    lane: number,
    agent,
    training_id,
    title: seen?.name ?? title,
    color: seen?.color ?? color,
    rank: seen?.rank ?? timed?.rank ?? 1,
    distance_m,
    finished_m: isDecided.value ? finishedDistance(track, timed) : null,
    total_m: isOver ? (result ? result.total_distance_m : distance_m) : null,
    decision_s: result && result.steps ? result.decision_s / result.steps : null,
    simulated: isOver && result ? result.simulated_transitions : futuresUntil(track, steps),
    spent: track ? spent(track, time) : { thought: 0, walked: 0 },
    step: steps ?? 0,
    steps: seen?.steps ?? race.config.steps,
    isThinking: Boolean(seen?.thinking) && seen.futures_total >= SURELY_THINKING_FUTURES,
    futures: seen?.futures ?? 0,
    futuresTotal: seen?.futures_total ?? 0,
    isDone: isOver,
    hasCrossed: seen?.crossed ?? Boolean(timed?.crossed_s),
    isMarching: seen?.marching ?? false,
    elapsed_s: track ? Math.min(time, track.total_s) : null,
    failure: seen?.failure ?? (isOver ? result?.failure : null) ?? null,
  };
}

function finishedDistance(track, timed) {
  if (timed) return timed.finished_distance_m;
  const first = timeline.value?.first_finish_s;
  return track && Number.isFinite(first) ? distanceAt(track.points, first) : null;
}

const futuresUntil = (track, steps) =>
  track ? track.futures.slice(0, steps ?? 0).reduce((sum, n) => sum + n, 0) : null;
