// A chart's straight lines with their captions, and a label at the end of each curve: none over another, and captions
// on no line where another place is free.
import { chooseCaptions, overlap, passes, placeLabels } from "../labels.js";
import { html } from "./elements.js";

/** @import { Box } from "../labels.js" */
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

/** The end of a line with its label, in pixels. @typedef {{ end?: string, x: number, y: number }} End */

const FONT_FAMILY = "system-ui, sans-serif";
const FONT_PX = 12;
const LABEL_WEIGHT = 600;
const LINE_PX = 16;
const CAPTION_PX = 14;
const END_DOT_PX = 4;
const TEXT_FROM_DOT_PX = 9;
const TEXT_FROM_LINE_PX = 6;
const MIN_ROOM_PX = 12;
/** A longer label moves back over its line. */
const MAX_ROOM_PX = 132;
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
 * The room that the labels at the ends of lines need on the right of a chart [px].
 * @param {Line[]} lines
 */
export function roomFor(lines) {
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
  const ends = lines.filter(({ end }) => end).map((line) => ({
    ...line, x: frame.x(line.xs.at(-1) ?? NaN), y: frame.y(Number(line.ys.at(-1))),
  }));
  const captions = chooseCaptions(places, bounds, covering(marks, curves, ends, frame));
  const labels = placeLabels(ends.map(endBox), captions.filter((box) => box !== null), bounds);
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
 * Where the label of a line's end is wanted.
 * @param {End} one
 * @returns {Box}
 */
const endBox = ({ end, x, y }) =>
  ({ left: x + TEXT_FROM_DOT_PX, top: y - LINE_PX / 2, width: widthOf(end ?? ""), height: LINE_PX });

/**
 * Counts what a box would cover: straight lines, curves and dots; labels half, since they can move.
 * @param {Mark[]} marks
 * @param {Line[]} curves
 * @param {End[]} ends
 * @param {Frame} frame
 */
function covering(marks, curves, ends, frame) {
  const { left, right, top, bottom } = frame;
  /** @type {[number, number][][]} */
  const straight = marks.map(({ x, y }) => (x === undefined
    ? [[left, frame.y(y ?? NaN)], [right, frame.y(y ?? NaN)]]
    : [[frame.x(x), top], [frame.x(x), bottom]]));
  /** @type {[number, number][][]} */
  const paths = curves.map(({ xs, ys }) =>
    xs.flatMap((x, n) => (typeof ys[n] === "number" ? [[frame.x(x), frame.y(ys[n])]] : [])));
  const [dots, labels] = [ends.map(dotBox), ends.map(endBox)];
  return (/** @type {Box} */ box) => {
    const covered = (/** @type {Box[]} */ boxes) => boxes.filter((one) => overlap(one, box)).length;
    return [...straight, ...paths].filter((points) => passes(points, box)).length + covered(dots) + covered(labels) / 2;
  };
}

/** Shares of the width at which a caption of a horizontal line may begin. */
const SHARES = [0, 0.2, 0.4, 0.5, 0.6, 0.7, 0.8];

/**
 * Where the dot of a line's end is.
 * @param {{ x: number, y: number }} one
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
