// The timeline of the race in view under the chosen clock. It grows while the race is simulated.
import { computed, effect, signal } from "@preact/signals";
import { getTimeline } from "./api.js";
import { clock, isToCome, raceInView } from "./selectors.js";
import { connection, scene, stage } from "./store.js";

/** @import { Signal } from "@preact/signals" */
/** @import { Timeline, TimelineLane, TimelinePoint } from "./types.js" */

const PAUSE_MS = 700;

/** @type {Signal<Timeline | null>} */
const newest = signal(null);

/** The timeline of the race in view, null while it is not known. */
export const timeline = computed(() => {
  const race = raceInView.value;
  const known = newest.value;
  return race && known?.id === race.id && known.clock === clock.value ? known : null;
});

/** The race time that is shown [s]: null before the race begins, Infinity after its show. */
export const shownTime = computed(() => {
  const race = raceInView.value;
  if (!race) return null;
  if (scene.value?.run_id === race.id && scene.value.kind === "race") return scene.value.time_s;
  // The stage still shows its training, or is about to begin.
  if (stage.value?.run_id === race.id || isToCome(race)) return null;
  return race.state === "finished" || race.state === "stopped" ? Infinity : null;
});

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

/** Request the timeline whenever it has grown; one request at a time. */
export function followTimeline() {
  const wanted = computed(() => {
    const race = raceInView.value;
    if (!race?.progress.done || connection.value !== "live") return "";
    return [race.id, clock.value, race.state, race.progress.done].join(" ");
  });
  let isBusy = false;
  let hasMissed = false;

  const load = async () => {
    if (isBusy) {
      hasMissed = true;
      return;
    }
    const [id, shown] = wanted.peek().split(" ");
    if (!id) return;
    isBusy = true;
    hasMissed = false;
    const answer = await getTimeline(id, shown).catch(() => null);
    if (answer) newest.value = { ...answer, id };
    setTimeout(() => {
      isBusy = false;
      if (hasMissed) load();
    }, answer ? PAUSE_MS / 2 : PAUSE_MS);
  };
  effect(() => {
    if (wanted.value) load();
  });
}
