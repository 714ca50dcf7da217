// A chart's straight lines with their captions, and a label at the end of each curve: none over another, and captions
// on no line where another place is free.
import { html } from "./elements.js";

/** @import { Line, Mark } from "../chart.js" */

/**
 * The plotting area in pixels, and the positions of values in it.
 * @typedef {object} Frame
 * @property {number} width of the picture
 * @property {number} height
 * @property {number} left
 * @property {number} right
 * @property {number} top
 * @property {number} bottom
 * @property {(x: number) => number} x
 * @property {(y: number) => number} y
 */

/** The end of a line, and where its label is wanted [px]. @typedef {{ x: number, y: number, box: Box }} End */

const FONT_FAMILY = "system-ui, sans-serif";
const FONT_PX = 12;
const LABEL_WEIGHT = 600;
const LINE_PX = 16;
const CAPTION_PX = 14;
const END_DOT_PX = 4;
const TEXT_FROM_DOT_PX = 9;
const TEXT_FROM_LINE_PX = 6;
const MIN_ROOM_PX = 6;
/** A longer label stands over its line. */
const MAX_ROOM_PX = 132;
/** In narrower charts no room is kept for labels: they stand over their lines. */
const ROOMY_PX = 520;
const DEFAULT_MARK_PX = 1.5;

/** @type {CanvasRenderingContext2D | null} */
let ruler = null;

/**
 * The width of a chart's text [px].
 * @param {string} text
 */
export function widthOf(text, weight = LABEL_WEIGHT) {
  ruler ??= document.createElement("canvas").getContext("2d");
  if (!ruler) return 0;
  ruler.font = `${weight} ${FONT_PX}px ${FONT_FAMILY}`;
  return ruler.measureText(text).width;
}

/**
 * The room that is kept for labels on the right of a chart, where lines end [px].
 * @param {Line[]} lines
 * @param {number} width of the chart
 */
export function roomFor(lines, width) {
  if (width < ROOMY_PX) return MIN_ROOM_PX;
  const widest = Math.max(0, ...lines.map(({ end }) => (end ? TEXT_FROM_DOT_PX + widthOf(end) + 4 : 0)));
  return Math.round(Math.min(MAX_ROOM_PX, Math.max(MIN_ROOM_PX, widest)));
}

/** A colour, or the name of a custom property, as CSS has it. @param {string} color */
export const cssColour = (color) => (color.startsWith("--") ? `var(${color})` : color);

/** The straight lines, without their captions. @param {{ marks: Mark[], frame: Frame }} props */
export const MarkLines = ({ marks, frame }) => marks.map(({ x, y, kind, color, dash, width }) => {
  const ends = x === undefined
    ? { x1: frame.left, x2: frame.right, y1: frame.y(y ?? NaN), y2: frame.y(y ?? NaN) }
    : { x1: frame.x(x), x2: frame.x(x), y1: frame.top, y2: frame.bottom };
  const style = color && {
    stroke: cssColour(color), strokeWidth: width ?? DEFAULT_MARK_PX, strokeDasharray: dash?.join(" "),
  };
  return html`<line class=${`mark ${kind ?? ""}`} ...${ends} style=${style} />`;
});

/**
 * Captions of straight lines, as many as have room, and the ends of curves with their labels: those in the frame.
 * @param {{ marks: Mark[], lines: Line[], curves: Line[], frame: Frame }} props
 */
export function LineLabels({ marks, lines, curves, frame }) {
  const { left, bottom, width } = frame;
  /** Above the axis, and up to the right edge. @type {Box} */
  const bounds = { left, top: 0, width: width - left, height: bottom };
  const captioned = byImportance(marks.filter(({ text }) => text));
  const places = captioned.map((mark) => captionPlaces(frame, mark));
  const ends = lines.filter(({ end }) => end).map((line) => {
    const at = { x: frame.x(line.xs.at(-1) ?? NaN), y: frame.y(Number(line.ys.at(-1))) };
    return { ...line, ...at, box: labelBox(line.end ?? "", at, width) };
  });
  const captions = chooseCaptions(places, bounds, coverOf(marks, curves, ends, frame));
  const labels = placeLabels(ends.map(({ box }) => box), captions.filter((box) => box !== null), bounds);
  return html`
    ${captions.map((box, n) => box && html`
      <${Label} text=${captioned[n].text} box=${box} color=${captioned[n].ink ?? captioned[n].color ?? "--ink"} />
    `)}
    ${ends.map(({ end, color, x, y }, n) => html`
      <circle cx=${x} cy=${y} r=${END_DOT_PX} style=${{ fill: cssColour(color) }} />
      ${/* Not in the line's own colour: yellow on white cannot be read. */
      labels[n] && html`<${Label} text=${end} box=${labels[n]} color="--ink" />`}
    `)}
  `;
}

/**
 * Horizontal lines before all, the first before the others; of vertical ones a later change tells more.
 * @param {Mark[]} marks
 */
const byImportance = (marks) => [
  ...marks.filter(({ x }) => x === undefined), ...marks.filter(({ x }) => x !== undefined).reverse(),
];

/** @param {{ text: string, box: Box, color: string }} props */
const Label = ({ text, box: { left, top, height }, color }) => html`
  <text class="line-label" x=${left} y=${top + height / 2} style=${{ fill: cssColour(color) }}>${text}</text>
`;

/**
 * Where the label of a line's end is wanted: right of it, or where there is no room over the line that comes to it.
 * @param {string} text
 * @param {{ x: number, y: number }} end
 * @param {number} width of the chart
 * @returns {Box}
 */
function labelBox(text, { x, y }, width) {
  const long = widthOf(text);
  return x + TEXT_FROM_DOT_PX + long <= width
    ? { left: x + TEXT_FROM_DOT_PX, top: y - LINE_PX / 2, width: long, height: LINE_PX }
    : { left: x - long - TEXT_FROM_LINE_PX, top: y - LINE_PX - TEXT_FROM_LINE_PX, width: long, height: LINE_PX };
}

/**
 * Counts what a box would cover: straight lines, curves and dots; labels half, since they can move.
 * @param {Mark[]} marks
 * @param {Line[]} curves
 * @param {End[]} ends
 * @param {Frame} frame
 */
function coverOf(marks, curves, ends, frame) {
  const { left, right, top, bottom } = frame;
  /** @type {[number, number][][]} */
  const straight = marks.map(({ x, y }) => (x === undefined
    ? [[left, frame.y(y ?? NaN)], [right, frame.y(y ?? NaN)]]
    : [[frame.x(x), top], [frame.x(x), bottom]]));
  /** @type {[number, number][][]} */
  const paths = curves.map(({ xs, ys }) =>
    xs.flatMap((x, n) => (typeof ys[n] === "number" ? [[frame.x(x), frame.y(ys[n])]] : [])));
  const [dots, labels] = [ends.map(dotBox), ends.map(({ box }) => box)];
  return (/** @type {Box} */ box) => {
    const covered = (/** @type {Box[]} */ boxes) => boxes.filter((other) => overlap(other, box)).length;
    return [...straight, ...paths].filter((points) => passes(points, box)).length + covered(dots) + covered(labels) / 2;
  };
}

/** Shares of the width at which a caption of a horizontal line may begin. */
const SHARES = [0, 0.2, 0.4, 0.5, 0.6, 0.7, 0.8];

/**
 * Where the dot of a line's end is.
 * @param {{ x: number, y: number }} point
 * @returns {Box}
 */
const dotBox = ({ x, y }) =>
  ({ left: x - END_DOT_PX, top: y - END_DOT_PX, width: 2 * END_DOT_PX, height: 2 * END_DOT_PX });

/**
 * Where a caption may be: along its horizontal line, above it or below, or above its vertical one.
 * @param {Frame} frame
 * @param {Mark} other
 * @returns {Box[]}
 */
function captionPlaces(frame, { x, y, text }) {
  const width = widthOf(text ?? "");
  const height = CAPTION_PX;
  if (x === undefined) {
    const level = frame.y(y ?? NaN);
    const tops = [level - height - 3, level + 3];
    return SHARES.flatMap((share) => tops.map((top) => {
      const left = frame.left + share * (frame.right - frame.left) + TEXT_FROM_LINE_PX;
      return { left, top, width, height };
    }));
  }
  const at = frame.x(x);
  const isFarRight = at > frame.left + 0.6 * (frame.right - frame.left);
  const left = isFarRight ? at + TEXT_FROM_LINE_PX - width : at - TEXT_FROM_LINE_PX;
  return [{ left, top: frame.top - height - 2, width, height }];
}

// ---- places of labels so that no two overlap: captions at their lines, labels at the ends of lines

/** @typedef {{ left: number, top: number, width: number, height: number }} Box [px] */

/** @type {(a: Box, b: Box) => boolean} */
export const overlap = (a, b) =>
  a.left < b.left + b.width && b.left < a.left + a.width && a.top < b.top + b.height && b.top < a.top + a.height;

/** @type {(value: number, low: number, high: number) => number} */
const within = (value, low, high) => Math.max(low, Math.min(value, high));

/** @type {(box: Box, bounds: Box) => Box} */
const shifted = (box, { left, width }) => ({ ...box, left: within(box.left, left, left + width - box.width) });

/**
 * Captions where they are wanted, within the bounds; null for one that would overlap another before it.
 * @param {Box[]} wanted the most important first
 * @param {Box} bounds
 */
export function placeCaptions(wanted, bounds) {
  /** @type {Box[]} */
  const placed = [];
  return wanted.map((candidate) => {
    const box = shifted(candidate, bounds);
    if (placed.some((other) => overlap(box, other))) return null;
    placed.push(box);
    return box;
  });
}

/**
 * Captions each at one of several places, which lie within the bounds; null for one that would overlap another before
 * it at all of them. Of the places that are free it is the first that covers least.
 * @param {Box[][]} places of each caption, the most important first; of each the best place first
 * @param {Box} bounds
 * @param {(box: Box) => number} covering how much a caption would cover
 */
export function chooseCaptions(places, bounds, covering) {
  /** @type {Box[]} */
  const placed = [];
  return places.map((candidates) => {
    const free = candidates.map((candidate) => shifted(candidate, bounds))
      .filter((box) => box.top >= bounds.top && box.top + box.height <= bounds.top + bounds.height)
      .filter((box) => !placed.some((other) => overlap(box, other)));
    const counts = free.map(covering);
    const box = free[counts.indexOf(Math.min(...counts))] ?? null;
    if (box) placed.push(box);
    return box;
  });
}

/**
 * Whether a line of points, ascending, passes through a box.
 * @param {[number, number][]} points [px]
 * @param {Box} box
 */
export function passes(points, { left, top, width, height }) {
  const right = left + width;
  return points.some(([x1, y1], n) => {
    const [x0, y0] = points[Math.max(0, n - 1)];
    if (x1 < left || x0 > right) return false;
    const slope = x1 > x0 ? (y1 - y0) / (x1 - x0) : 0;
    const ends = [y0 + slope * Math.max(0, left - x0), y1 - slope * Math.max(0, x1 - right)];
    return Math.max(...ends) > top && Math.min(...ends) < top + height;
  });
}

/**
 * Labels as near as possible to where they are wanted, moved up or down from each other and from obstacles,
 * but never past each other; null for one that the bounds have no room for.
 * @param {Box[]} wanted
 * @param {Box[]} obstacles
 * @param {Box} bounds
 */
export function placeLabels(wanted, obstacles, bounds) {
  const inOrder = wanted.map((candidate, number) => ({ number, box: shifted(candidate, bounds) }));
  inOrder.sort((a, b) => a.box.top - b.box.top);
  const boxes = inOrder.map(({ box }) => box);
  const downwards = nearest(boxes, obstacles, bounds, false);
  const upwards = nearest([...boxes].reverse(), obstacles, bounds, true).reverse();
  const [near] = [downwards, upwards].filter((some) => !some.includes(null))
    .sort((a, b) => distance(a, boxes) - distance(b, boxes));
  const placed = near ?? stacked(boxes, obstacles, bounds);
  /** @type {(Box | null)[]} */
  const placedBoxes = wanted.map(() => null);
  inOrder.forEach(({ number }, n) => (placedBoxes[number] = placed[n]));
  return placedBoxes;
}

/** @type {(placed: (Box | null)[], wanted: Box[]) => number} */
const distance = (placed, wanted) =>
  wanted.reduce((sum, { top }, n) => sum + Math.abs((placed[n]?.top ?? top) - top), 0);

/** @type {(a: Box, b: Box) => boolean} */
const inOneColumn = (a, b) => a.left < b.left + b.width && b.left < a.left + a.width;

/**
 * Each at the free place nearest to its own that is below those before it, or else above.
 * @param {Box[]} boxes
 * @param {Box[]} obstacles
 * @param {Box} bounds
 * @param {boolean} isAbove
 */
function nearest(boxes, obstacles, bounds, isAbove) {
  /** @type {Box[]} */
  const placed = [];
  return boxes.map((box) => {
    const before = placed.filter((other) => inOneColumn(other, box));
    const bottom = bounds.top + bounds.height - box.height;
    const low = isAbove ? bounds.top : Math.max(bounds.top, ...before.map((other) => other.top + other.height));
    const high = isAbove ? Math.min(bottom, ...before.map((other) => other.top - box.height)) : bottom;
    const taken = [...obstacles, ...placed];
    const top = [box.top, ...taken.flatMap((other) => [other.top - box.height, other.top + other.height])]
      .map((place) => within(place, low, high))
      .sort((a, b) => Math.abs(a - box.top) - Math.abs(b - box.top))
      .find((place) => !taken.some((other) => overlap({ ...box, top: place }, other)));
    if (top === undefined || low > high) return null;
    placed.push({ ...box, top });
    return { ...box, top };
  });
}

/**
 * All from the top down without gaps, which needs the least room.
 * @param {Box[]} boxes
 * @param {Box[]} obstacles
 * @param {Box} bounds
 */
function stacked(boxes, obstacles, bounds) {
  const taken = [...obstacles];
  return boxes.map((box) => {
    let { top } = bounds;
    for (;;) {
      const blocking = taken.filter((other) => overlap({ ...box, top }, other));
      if (!blocking.length) break;
      top = Math.max(...blocking.map((other) => other.top + other.height));
    }
    if (top + box.height > bounds.top + bounds.height) return null;
    taken.push({ ...box, top });
    return { ...box, top };
  });
}
