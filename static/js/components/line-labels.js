// Draws a chart's straight lines with their captions, and a label at the end of each line; none over another.
import { placeCaptions, placeLabels } from "../labels.js";

/** @import { Box } from "../labels.js" */

/**
 * A label at the end of a line, in the chart's units.
 * @typedef {{ text: string, color: string, x: number, y: number }} EndLabel
 */

/**
 * A straight line across the chart; `share` of the width is where the caption of a horizontal one begins.
 * @typedef {object} Mark
 * @property {number} [x]
 * @property {number} [y]
 * @property {string} color
 * @property {string} [ink] the caption's colour
 * @property {string} [text]
 * @property {number} [share]
 * @property {number[]} [dash]
 * @property {number} [width] of the line [px]
 */

/** Of all texts of a chart. */
export const FONT = "12px system-ui, sans-serif";
const LABEL_WEIGHT = 600;
const LINE_PX = 16;
const CAPTION_PX = 14;
const END_DOT_PX = 4;
const TEXT_FROM_DOT_PX = 9;
const TEXT_FROM_LINE_PX = 6;
const HALO_PX = 4;
const LEAST_ROOM_PX = 16;
/** A longer label moves back over its line. */
const MOST_ROOM_PX = 132;

/** @type {CanvasRenderingContext2D | null} */
let ruler = null;

/** @param {string} text */
function widthOf(text) {
  ruler ??= document.createElement("canvas").getContext("2d");
  if (!ruler) return 0;
  ruler.font = `${LABEL_WEIGHT} ${FONT}`;
  return ruler.measureText(text).width;
}

/**
 * The room that labels need on the right of the chart [px].
 * @param {EndLabel[]} labels
 */
export function roomFor(labels) {
  const widest = Math.max(0, ...labels.map(({ text }) => widthOf(text)));
  return Math.round(Math.min(MOST_ROOM_PX, Math.max(LEAST_ROOM_PX, TEXT_FROM_DOT_PX + widest + 4)));
}

/** The font at the canvas's resolution. */
const fontOf = (px) => `${LABEL_WEIGHT} ${FONT.replace("12px", `${12 * px}px`)}`;

/**
 * A plugin of uPlot.
 * @param {() => EndLabel[]} labels
 * @param {() => Mark[]} marks
 * @param {(name: string) => string} resolve returns the colour of a custom property
 */
export function lineLabels(labels, marks, resolve) {
  const colourOf = (name) => (name.startsWith("--") ? resolve(name) : name);
  const draw = (u) => {
    const { ctx, bbox } = u;
    const px = devicePixelRatio;
    const pen = { u, ctx, px, colourOf };
    /** Above the axis, and up to the right edge. @type {Box} */
    const bounds = { left: bbox.left, top: 0, width: ctx.canvas.width - bbox.left, height: bbox.top + bbox.height };
    ctx.save();
    marks().forEach((mark) => drawMark(pen, mark));
    ctx.setLineDash([]);
    ctx.font = fontOf(px);
    ctx.textAlign = "left";
    ctx.textBaseline = "middle";
    drawLabels(pen, labels(), drawCaptions(pen, marks(), bounds), bounds);
    ctx.restore();
  };
  return { hooks: { draw: [draw] } };
}

/** @param {any} pen @param {Mark} mark */
function drawMark({ u, ctx, px, colourOf }, { x, y, color, dash = [], width: line = 1.5 }) {
  const { left, top, width, height } = u.bbox;
  ctx.strokeStyle = colourOf(color);
  ctx.lineWidth = line * px;
  ctx.setLineDash(dash.map((d) => d * px));
  ctx.beginPath();
  if (x === undefined) {
    const at = u.valToPos(y, "y", true);
    ctx.moveTo(left, at);
    ctx.lineTo(left + width, at);
  } else {
    const at = u.valToPos(x, "x", true);
    ctx.moveTo(at, top);
    ctx.lineTo(at, top + height);
  }
  ctx.stroke();
}

/** Draw the captions of lines, as many as have room. @returns {Box[]} where they are */
function drawCaptions(pen, marks, bounds) {
  // Horizontal lines before all; of vertical ones a later change tells more.
  const captioned = marks.filter(({ text }) => text).reverse().sort((a, b) => Number("x" in a) - Number("x" in b));
  const placed = placeCaptions(captioned.map((mark) => captionBox(pen, mark)), bounds);
  placed.forEach((box, n) => box && write(pen, captioned[n].text, captioned[n].ink ?? captioned[n].color, box));
  return placed.filter((box) => box !== null);
}

function drawLabels(pen, labels, captions, bounds) {
  const { u, ctx, px, colourOf } = pen;
  const { left, width } = u.bbox;
  const wanted = labels.map((label) => ({
    ...label, x: Math.min(u.valToPos(label.x, "x", true), left + width), y: u.valToPos(label.y, "y", true),
  }));
  const boxes = wanted.map(({ text, x, y }) => ({
    left: x + TEXT_FROM_DOT_PX * px, top: y - (LINE_PX * px) / 2,
    width: ctx.measureText(text).width, height: LINE_PX * px,
  }));
  const placed = placeLabels(boxes, captions, bounds);
  wanted.forEach(({ text, color, x, y }, n) => {
    ctx.fillStyle = colourOf(color);
    ctx.beginPath();
    ctx.arc(x, y, END_DOT_PX * px, 0, 2 * Math.PI);
    ctx.fill();
    // Not in the line's own colour: yellow on white cannot be read.
    if (placed[n]) write(pen, text, "--ink", placed[n]);
  });
}

function write({ ctx, px, colourOf }, text, color, { left, top, height }) {
  // Keeps lines that pass behind it off the text.
  ctx.strokeStyle = colourOf("--panel");
  ctx.lineWidth = HALO_PX * px;
  ctx.lineJoin = "round";
  ctx.strokeText(text, left, top + height / 2);
  ctx.fillStyle = colourOf(color);
  ctx.fillText(text, left, top + height / 2);
}

/** Where a caption is wanted: on its horizontal line, or above its vertical one. @returns {Box} */
function captionBox({ u, ctx, px }, { x, y, text, share = 0 }) {
  const { bbox } = u;
  const { width } = ctx.measureText(text);
  const height = CAPTION_PX * px;
  if (x === undefined) {
    const left = bbox.left + share * bbox.width + TEXT_FROM_LINE_PX * px;
    return { left, top: u.valToPos(y, "y", true) - height - 3 * px, width, height };
  }
  const at = u.valToPos(x, "x", true);
  const isFarRight = at > bbox.left + 0.6 * bbox.width;
  const left = isFarRight ? at + TEXT_FROM_LINE_PX * px - width : at - TEXT_FROM_LINE_PX * px;
  return { left, top: bbox.top - height - 2 * px, width, height };
}
