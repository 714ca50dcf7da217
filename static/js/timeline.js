// The race in view against race time, under the clock that is shown; grows while it is simulated.
import { computed, effect, signal } from "@preact/signals";
import { getTimeline } from "./api.js";
import { clock, raceInView } from "./selectors.js";
import { connection, scene, stage } from "./store.js";

const PAUSE_MS = 700;

const newest = signal(null);

/** The timeline of the race in view, or null. */
export const timeline = computed(() => {
  const race = raceInView.value;
  const known = newest.value;
  return race && known?.id === race.id && known.clock === clock.value ? known : null;
});

/** The race time that is on screen [s]: null before it begins, Infinity for a race long over. */
export const shownTime = computed(() => {
  const race = raceInView.value;
  if (!race) return null;
  if (scene.value?.run_id === race.id && scene.value.kind === "race") return scene.value.time_s;
  // Simulated, perhaps, but the stage is at its practice still, or about to begin.
  if ([stage.value?.run_id, stage.value?.next_run_id].includes(race.id)) return null;
  return race.state === "finished" || race.state === "stopped" ? Infinity : null;
});

/** How far a lane is at a time of the race [m], from its corners [[time, distance]…]. */
export function distanceAt(points, time) {
  if (!points.length) return 0;
  const next = points.findIndex(([t]) => t >= time);
  if (next === -1) return points.at(-1)[1];
  if (next === 0) return points[0][1];
  const [[t0, d0], [t1, d1]] = [points[next - 1], points[next]];
  return t1 > t0 ? d0 + ((d1 - d0) * (time - t0)) / (t1 - t0) : d1;
}

/** How long a lane has thought and walked by a time of the race [s]. */
export function spent({ thinking, total_s }, time) {
  const elapsed = Math.min(time, total_s);
  const thought = thinking.reduce(
    (sum, [from, to]) => sum + Math.max(0, Math.min(to, elapsed) - from), 0,
  );
  return { thought, walked: elapsed - thought };
}

export function followTimeline() {
  const wanted = computed(() => {
    const race = raceInView.value;
    if (!race?.progress.done || connection.value !== "live") return "";
    return [race.id, clock.value, race.state, race.progress?.done].join(" ");
  });
  let busy = false;
  let missed = false;

  const load = async () => {
    if (busy) {
      missed = true;
      return;
    }
    const [id, shown] = wanted.peek().split(" ");
    if (!id) return;
    busy = true;
    missed = false;
    const answer = await getTimeline(id, shown).catch(() => null);
    if (answer) newest.value = { ...answer, id };
    setTimeout(() => {
      busy = false;
      if (missed) load();
    }, answer ? PAUSE_MS / 2 : PAUSE_MS);
  };
  effect(() => {
    if (wanted.value) load();
  });
}
