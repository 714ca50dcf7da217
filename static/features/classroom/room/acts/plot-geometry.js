// Places on the projector's plots: axes that hold all values, and dots that lie on each other.
import { largest, shareOf, ticks } from "../../../../js/scale.js";

/** Factor between the least and the greatest value from which an axis has powers of ten. */
const WIDE = 200;
const HEADROOM = 0.04;
/** Least span of an axis, so that equal values lie in its middle. */
const LEAST_SPAN = 1e-6;
/** Room of a dot against its diameter. */
const PITCH = 1.12;
const SMALLER = 0.92;
const LEAST_RADIUS_PX = 1.5;

/**
 * An axis. `at`: the place of a value, from 0 to 1. `marks`: its round numbers.
 * @typedef {{ low: number, high: number, at: (value: number) => number, marks: number[] }} PlotAxis
 */

/**
 * An axis on which all values lie; with powers of ten where they differ by orders of magnitude.
 * @param {number[]} values
 * @param {number} count about how many marks there are
 * @returns {PlotAxis}
 */
export function plotAxis(values, count = 5) {
  const [least, most] = [Math.min(...values), Math.max(...values)];
  if (least > 0 && most / least >= WIDE) {
    const [low, high] = [Math.floor(Math.log10(least)), Math.ceil(Math.log10(most))];
    return {
      low: 10 ** low, high: 10 ** high,
      at: (value) => shareOf(Math.log10(Math.max(value, 10 ** low)), low, high),
      marks: Array.from({ length: high - low + 1 }, (_, n) => 10 ** (low + n)),
    };
  }
  const start = Math.min(0, least);
  const span = Math.max(most - start, LEAST_SPAN);
  const low = start - (start < 0 ? HEADROOM * span : 0);
  const high = start + span * (1 + HEADROOM);
  return { low, high, at: (value) => shareOf(value, low, high), marks: ticks(high, count, low) };
}

/**
 * Dots that stand on each other where they would cover one another, as large as the place allows.
 * @param {number[]} shares places across, from 0 to 1
 * @param {number} width of the place [px]
 * @param {number} height [px]
 * @param {number} most radius of a dot at most [px]
 * @returns {{ radius: number, dots: { x: number, y: number }[] }} middles from the lower left corner [px]
 */
export function stackedDots(shares, width, height, most) {
  let radius = Math.max(most, LEAST_RADIUS_PX);
  let dots = dotsAt(shares, width, radius);
  while (radius > LEAST_RADIUS_PX && largest(dots.map(({ y }) => y)) + radius > height) {
    radius *= SMALLER;
    dots = dotsAt(shares, width, radius);
  }
  const top = largest(dots.map(({ y }) => y));
  // More than fit even so lie on each other.
  const squeeze = top + radius > height ? (height - 2 * radius) / (top - radius) : 1;
  return { radius, dots: dots.map(({ x, y }) => ({ x, y: radius + (y - radius) * squeeze })) };
}

/** @param {number[]} shares @param {number} width @param {number} radius */
function dotsAt(shares, width, radius) {
  const pitch = 2 * radius * PITCH;
  const columns = Math.max(1, Math.floor((width - 2 * radius) / pitch));
  /** @type {Map<number, number>} */
  const taken = new Map();
  return shares.map((share) => {
    const column = Math.round(share * columns);
    const below = taken.get(column) ?? 0;
    taken.set(column, below + 1);
    return { x: radius + (column / columns) * (width - 2 * radius), y: radius + below * pitch };
  });
}

/**
 * Dots moved to a side where they would cover one another: thirty at one place are a row of thirty.
 * @param {{ x: number, y: number }[]} dots middles [px]
 * @param {number} radius [px]
 * @param {number} width of the place, within which they stay while there is room [px]
 */
export function besideEachOther(dots, radius, width) {
  const pitch = 2 * radius * PITCH;
  /** @type {{ x: number, y: number }[]} */
  const placed = [];
  for (const { x, y } of dots) {
    const shifts = placed.flatMap((_, n) => [(n + 1) * pitch, -(n + 1) * pitch]);
    const isFree = (/** @type {number} */ shift) => x + shift >= radius && x + shift <= width - radius
      && placed.every((other) => Math.hypot(other.x - x - shift, other.y - y) >= 2 * radius);
    placed.push({ x: x + ([0, ...shifts].find(isFree) ?? 0), y });
  }
  return placed;
}
