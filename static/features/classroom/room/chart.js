// The chart of questions on which one points or draws: distance against steps of practice.
import { metres, whole } from "../../../js/format.js";
import { shareOf, ticks } from "../../../js/scale.js";

/** Distances that the chart shows [m]. */
export const [LOWEST_M, HIGHEST_M] = [-0.1, 0.8];
/** Points of a drawn curve. */
export const KNOTS = 9;
const STEP_M = 0.02;
const DEFAULT_STEPS = 500;

/** The steps of the practice that a card runs. @param {{ state?: any }} card */
export function stepsOf({ state }) {
  const steps = Number(state?.form?.steps);
  return steps > 0 ? steps : DEFAULT_STEPS;
}

/** A distance that the chart can show, to the centimetre. @param {number} value */
export const onChart = (value) =>
  Math.round(100 * Math.min(Math.max(value, LOWEST_M), HIGHEST_M)) / 100;

/**
 * The point of the chart at a share of its width and height, from its upper left corner.
 * @param {number} across @param {number} down @param {number} steps
 * @returns {[number, number]}
 */
export const pointAt = (across, down, steps) => [
  Math.round(Math.min(Math.max(across, 0), 1) * steps),
  onChart(HIGHEST_M - Math.min(Math.max(down, 0), 1) * (HIGHEST_M - LOWEST_M)),
];

/** Where a point lies, as shares of the width and the height. @param {number[]} point @param {number} steps */
export const placeOf = ([x, y], steps) => [shareOf(x, 0, steps), 1 - shareOf(y, LOWEST_M, HIGHEST_M)];

/** The steps at which a drawn curve has its points. @param {number} steps */
export const knotsOf = (steps) => Array.from({ length: KNOTS }, (_, n) => Math.round((n * steps) / (KNOTS - 1)));

/**
 * A curve after a stroke from one point to another: the points between them lie on the stroke; those that were not
 * drawn yet have the height of its end.
 * @param {number[] | null} heights of the points; null before the first stroke
 * @param {[number, number]} from
 * @param {[number, number]} to
 * @param {number} steps
 */
export function drawn(heights, from, to, steps) {
  const before = heights ?? knotsOf(steps).map(() => to[1]);
  const [first, last] = from[0] <= to[0] ? [from, to] : [to, from];
  const half = steps / (KNOTS - 1) / 2;
  return knotsOf(steps).map((x, n) => {
    if (x < first[0] - half || x > last[0] + half) return before[n];
    const share = last[0] > first[0] ? Math.min(Math.max((x - first[0]) / (last[0] - first[0]), 0), 1) : 1;
    return onChart(first[1] + share * (last[1] - first[1]));
  });
}

/**
 * A curve after a key, and the number of the point that is chosen.
 * @param {string} key
 * @param {number[] | null} heights
 * @param {number} chosen
 * @returns {{ heights: number[] | null, chosen: number } | null} null for any other key
 */
export function afterKey(key, heights, chosen) {
  const moves = /** @type {Record<string, number>} */ ({ ArrowLeft: -1, ArrowRight: 1 });
  if (key in moves) return { heights, chosen: Math.min(Math.max(chosen + moves[key], 0), KNOTS - 1) };
  const changes = /** @type {Record<string, number>} */ (
    { ArrowUp: STEP_M, ArrowDown: -STEP_M, PageUp: 5 * STEP_M, PageDown: -5 * STEP_M });
  if (!(key in changes)) return null;
  const before = heights ?? Array.from({ length: KNOTS }, () => 0);
  return { heights: before.map((y, n) => (n === chosen ? onChart(y + changes[key]) : y)), chosen };
}

/** The marks of both axes. @param {number} steps */
export const marksOf = (steps) => ({
  xs: ticks(steps, 4), ys: ticks(HIGHEST_M, 4, 0),
});

/** A point in words. @param {number[]} point */
export const inWords = ([x, y]) => `${metres(y)} after ${whole(x)} steps`;
