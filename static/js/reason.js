// Why the leader is ahead: steps and distance a step of the first two, from what was recorded.
import { computed } from "@preact/signals";
import { count, metres } from "./format.js";
import { shownTime, standings, timeline } from "./race.js";

/** @import { TimelineLane } from "./types.js" */

/**
 * The steps that a lane has ended until a race time, and the distance that they made [m]; null where the timeline does
 * not have the end of each step.
 * @param {Pick<TimelineLane, "points" | "thinking" | "futures">} lane
 * @param {number} time [s]
 */
export function stepsUntil({ points, thinking, futures }, time) {
  if (points.length - 1 !== thinking.length + futures.length) return null;
  // Each step adds the end of its motion, and before it the end of its thinking, if it took time.
  const reached = points.filter(([t]) => t <= time);
  const steps = reached.length - 1 - thinking.filter(([, to]) => to <= time).length;
  return { steps, distance_m: reached.at(-1)?.[1] ?? 0 };
}

/**
 * A line on each of the first two lanes: "Greedy: 0.37 m, 36 steps of 10.2 mm"; none without figures of both.
 * @param {{ lane: number, title: string }[]} rows the leader first
 * @param {Pick<TimelineLane, "points" | "thinking" | "futures">[]} lanes of the timeline
 * @param {number} time [s]
 */
export function reasonOf(rows, lanes, time) {
  const told = rows.slice(0, 2).map(({ lane, title }) => {
    const { steps, distance_m } = (lanes[lane] && stepsUntil(lanes[lane], time)) ?? { steps: 0, distance_m: 0 };
    const each_mm = ((1000 * distance_m) / steps).toFixed(1).replace("-", "−");
    return steps ? `${title}: ${metres(distance_m)}, ${count(steps, "step")} of ${each_mm}\u00a0mm` : "";
  });
  return told.every(Boolean) ? told : [];
}

/** Of the race at the moment that is shown, or at its time-out once that is past. */
export const reason = computed(() => {
  const [rows, known, time] = [standings.value, timeline.value, shownTime.value];
  if (!rows || !known || time === null) return [];
  return reasonOf(rows, known.lanes, Math.min(time, known.first_finish_s ?? Infinity));
});
