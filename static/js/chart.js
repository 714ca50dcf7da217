// Charts over a common axis: their shared crosshair and zoom, what fits a part of it, and their numbers as CSV.
import { signal } from "@preact/signals";

/** @import { Signal } from "@preact/signals" */

/** Of an axis or of a part of it: [from, to]. @typedef {[number, number]} Range */

/**
 * A line of a chart; what is null is not known there.
 * @typedef {object} Line
 * @property {string} name
 * @property {string} color
 * @property {number[]} xs ascending
 * @property {(number | null)[]} ys
 * @property {(x: number) => number | null} [at] its value between its points; without it there is none
 * @property {(number | null)[]} [low] of the 95 % interval
 * @property {(number | null)[]} [high]
 * @property {(number | null)[][]} [seeds] each seed by x
 * @property {number[]} [dash] its dashes [px]; without any it is solid
 * @property {boolean} [dots] whether its points are marked
 * @property {string} [end] the label at its end
 */

/**
 * A straight line across a chart.
 * @typedef {object} Mark
 * @property {number} [x]
 * @property {number} [y]
 * @property {string} [name] of a horizontal line that is read like a curve
 * @property {string} [kind] of line that the style sheet has; else colour, dashes and width
 * @property {string} [color]
 * @property {string} [ink] the caption's colour
 * @property {string} [text] the caption
 * @property {number[]} [dash]
 * @property {number} [width] [px]
 */

/** How much charts offer; as the depth of the workspace, where there is one. @type {Signal<string>} */
export const chartDepth = signal("study");

// ---- the crosshair and the zoom, which all charts over the same axis share

/**
 * The position that is read, on one axis at a time; that of a mouse goes with it.
 * @type {Signal<{ axis: string, x: number, isOfMouse?: boolean } | null>}
 */
export const crosshair = signal(null);
/** Axis → the part of it that is shown; without an entry all of it. @type {Signal<Record<string, Range>>} */
const zooms = signal({});

/** @param {string} axis */
export const zoomOf = (axis) => zooms.value[axis] ?? null;

/** A part that is shorter shows nothing more. */
const MIN_PART = 1e-3;
const MIN_SHARE_OF_Y = 0.02;
const MARGIN_OF_Y = 0.1;

/**
 * Show a part of an axis; all of it where the part is not within.
 * @param {string} axis
 * @param {Range | null} part
 * @param {Range} whole
 */
export function zoomTo(axis, part, whole) {
  const { [axis]: _, ...otherZooms } = zooms.value;
  const shown = part && within(part, whole);
  zooms.value = shown && (shown[0] > whole[0] || shown[1] < whole[1]) ? { ...otherZooms, [axis]: shown } : otherZooms;
}

/**
 * A part of an axis: in order, on the axis, and not too short.
 * @param {Range} part
 * @param {Range} whole
 * @returns {Range}
 */
export function within(part, whole) {
  const [low, high] = whole;
  const length = Math.min(high - low, Math.max(Math.abs(part[1] - part[0]), MIN_PART * (high - low)));
  const from = Math.max(low, Math.min(Math.min(...part), high - length));
  return [from, from + length];
}

/**
 * A part that is shorter by a factor, in which a position keeps its place.
 * @param {Range} part
 * @param {number} x
 * @param {number} factor
 * @returns {Range}
 */
export const scaledAround = ([from, to], x, factor) => [x - (x - from) / factor, x + (to - x) / factor];

/**
 * The part in which two positions are shown at two shares of the width: where two fingers have moved to.
 * @param {Range} xs
 * @param {Range} shares
 * @returns {Range}
 */
export function pinned([x0, x1], [share0, share1]) {
  const length = Math.abs((x1 - x0) / (share1 - share0 || 1e-9));
  const from = Math.min(x0, x1) - Math.min(share0, share1) * length;
  return [from, from + length];
}

/**
 * A part of the same length in which a position lies.
 * @param {Range} part
 * @param {number} x
 * @returns {Range}
 */
export function movedTo([from, to], x) {
  if (x < from) return [x, x + to - from];
  return x > to ? [x - (to - from), x] : [from, to];
}

// ---- keys at the crosshair

const PAGE_KEY_STEP = 10;
const ZOOM_KEY_FACTOR = 2;

/** @type {Record<string, (at: number, last: number) => number>} */
const MOVES = {
  ArrowLeft: (at) => at - 1,
  ArrowRight: (at) => at + 1,
  ArrowDown: (at) => at - 1,
  ArrowUp: (at) => at + 1,
  PageDown: (at) => at - PAGE_KEY_STEP,
  PageUp: (at) => at + PAGE_KEY_STEP,
  Home: () => 0,
  End: (_, last) => last,
};

/**
 * The index to which a key moves the crosshair; null for any other key.
 * @param {string} key
 * @param {number} at
 * @param {number} last
 */
export const indexAfter = (key, at, last) =>
  key in MOVES ? Math.max(0, Math.min(MOVES[key](at, last), last)) : null;

/** The factor by which a key zooms: 0 for all of the axis; null for any other key. @param {string} key */
export const zoomFactorOf = (key) =>
  ({ "+": ZOOM_KEY_FACTOR, "=": ZOOM_KEY_FACTOR, "-": 1 / ZOOM_KEY_FACTOR, "0": 0 })[key] ?? null;

/**
 * The index of the nearest of ascending positions; −1 without any.
 * @param {number[]} xs
 * @param {number} x
 */
export function nearestIndex(xs, x) {
  const next = firstFrom(xs, x);
  if (next === 0) return xs.length ? 0 : -1;
  return next < xs.length && xs[next] - x < x - xs[next - 1] ? next : next - 1;
}

/** The index of the first of ascending positions that is not before x. @type {(xs: number[], x: number) => number} */
function firstFrom(xs, x) {
  let [low, high] = [0, xs.length];
  while (low < high) {
    const middle = (low + high) >> 1;
    if (xs[middle] < x) low = middle + 1;
    else high = middle;
  }
  return low;
}

// ---- what a chart shows

/**
 * A line's value at a position; null where it has none.
 * @param {Line} line
 * @param {number} x
 */
export function valueAt({ xs, ys, at }, x) {
  if (at) return at(x);
  const index = firstFrom(xs, x);
  return xs[index] === x ? ys[index] : null;
}

/**
 * The 95 % interval of a line at one of its points; null without.
 * @param {Line} line
 * @param {number} x
 * @returns {Range | null}
 */
export function intervalAt({ xs, low, high }, x) {
  const index = firstFrom(xs, x);
  const ends = xs[index] === x ? [low?.[index] ?? null, high?.[index] ?? null] : [null, null];
  return ends[0] === null || ends[1] === null ? null : [ends[0], ends[1]];
}

/**
 * The range of values of lines in a part of their axis, with a margin; that of the whole chart if there are none.
 * @param {Line[]} lines
 * @param {Range} part
 * @param {Range} whole of the values
 * @returns {Range}
 */
export function valuesIn(lines, [from, to], whole) {
  let [least, most] = [Infinity, -Infinity];
  const reaching = lines.filter(({ xs }) => xs.length > 0 && xs[0] <= to && xs[xs.length - 1] >= from);
  for (const { xs, ys, low, high } of reaching) {
    // One more on each side: the line passes on to them.
    const begin = Math.max(0, firstFrom(xs, from) - 1);
    const end = Math.min(xs.length, firstFrom(xs, to) + 1);
    const values = [ys, low ?? [], high ?? []].flatMap((list) => list.slice(begin, end));
    for (const value of values.filter((entry) => typeof entry === "number")) {
      least = Math.min(least, value);
      most = Math.max(most, value);
    }
  }
  if (!(most >= least)) return whole;
  const length = Math.max(most - least, MIN_SHARE_OF_Y * (whole[1] - whole[0]));
  const middle = (least + most) / 2;
  return [middle - (0.5 + MARGIN_OF_Y) * length, middle + (0.5 + MARGIN_OF_Y) * length];
}

/**
 * Points of a line that look like all of them: of each column of pixels the first, the least, the most and the last.
 * @param {[number, number][]} points in pixels, ascending
 * @param {number} columns
 */
export function thinnedPath(points, columns) {
  if (points.length <= 4 * columns) return points;
  const [[left], [right]] = [points[0], /** @type {[number, number]} */ (points.at(-1))];
  const columnOf = (/** @type {[number, number]} */ [x]) => Math.floor((columns * (x - left)) / (right - left || 1));
  /** @type {[number, number][][]} */
  const groups = [];
  let column = NaN;
  for (const point of points) {
    if (columnOf(point) !== column) {
      column = columnOf(point);
      groups.push([point, point, point, point]);
    }
    const group = groups[groups.length - 1];
    if (point[1] < group[1][1]) group[1] = point;
    if (point[1] > group[2][1]) group[2] = point;
    group[3] = point;
  }
  return groups.flatMap((group) => [...new Set(group)].sort((a, b) => a[0] - b[0]));
}

// ---- the numbers of a chart

/**
 * The numbers of a chart: a row for each position, a column for each line, its interval, and each named level.
 * Titles of columns have the unit of the values, if it is given.
 * @param {{ lines: Line[], marks: Mark[], xs: number[], titles: { x: string, y?: string } }} chart
 */
export function tableOf({ lines, marks, xs, titles }) {
  const levels = marks.filter(({ name, y }) => name && y !== undefined);
  const hasInterval = (/** @type {Line} */ { low }) => Boolean(low?.some((bound) => bound !== null));
  const columns = [
    titles.x,
    ...lines.flatMap((line) => [line.name, ...(hasInterval(line) ? ["95 % from", "95 % to"] : [])]),
    ...levels.map(({ name }) => name ?? ""),
  ].map((title, n) => (n && titles.y ? `${title} (${titles.y})` : title));
  const rows = xs.map((x) => /** @type {[number, ...(number | null)[]]} */ ([
    x,
    ...lines.flatMap((line) => [valueAt(line, x), ...(hasInterval(line) ? intervalAt(line, x) ?? [null, null] : [])]),
    ...levels.map(({ y }) => y ?? null),
  ]));
  // Where no line has a value yet there is nothing to tell.
  return { columns, rows: rows.filter((_, n) => lines.some((line) => valueAt(line, xs[n]) !== null)) };
}

/** First characters that a spreadsheet would take for a formula. */
const FORMULA = /^[=+\-@\t\r]/;

/** @param {string} text */
function cellOf(text) {
  const safe = FORMULA.test(text) ? `'${text}` : text;
  return /[",\r\n]/.test(safe) ? `"${safe.replaceAll('"', '""')}"` : safe;
}

/**
 * A table as CSV (RFC 4180), which a spreadsheet runs nothing of.
 * @param {{ columns: string[], rows: (number | null)[][] }} table
 */
export const csvOf = ({ columns, rows }) =>
  [columns.map(cellOf), ...rows.map((cells) => cells.map((cell) => (cell === null ? "" : String(cell))))]
    .map((cells) => `${cells.join(",")}\r\n`).join("");

/** A file's name of words: "learning-curve". @param {string} words */
export const fileNameOf = (words) =>
  words.toLowerCase().normalize("NFKD").replace(/[^a-z0-9]+/g, "-").replace(/^-|-$/g, "") || "chart";

// ---- the axis of a chart as it is drawn

/**
 * The axis that a chart's keys, pointer and menu act on.
 * @typedef {object} Axis
 * @property {string} axis
 * @property {number[]} xs where there are values, ascending
 * @property {Range} whole
 * @property {Range} part that is shown
 * @property {number} now the index that is read first
 * @property {((x: number) => unknown) | null} seek
 * @property {{ shown: number, computed: number } | null} reach up to where lines are shown, and to where they can be
 */

/** The index at the crosshair, if it is on this axis and in view; else null. @param {Axis} axis */
export function readIndex({ axis, xs, part: [low, high] }) {
  const at = crosshair.value;
  if (at?.axis !== axis) return null;
  const index = nearestIndex(xs, at.x);
  return index >= 0 && xs[index] >= low && xs[index] <= high ? index : null;
}

/**
 * Zoom by a factor around the crosshair, or around the middle; 0 shows all.
 * @param {Axis} chart
 * @param {number} factor
 */
export function zoomBy(chart, factor) {
  const { axis, whole, part, xs } = chart;
  const index = readIndex(chart);
  const middle = index === null ? (part[0] + part[1]) / 2 : xs[index];
  zoomTo(axis, factor ? scaledAround(part, middle, factor) : null, whole);
}
