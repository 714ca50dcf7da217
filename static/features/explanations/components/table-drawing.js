// The drawings of the table: its rows' names, as feet on their grid, and its cells in the colours of their values.
import { useEffect, useLayoutEffect, useRef, useState } from "preact/hooks";
import { theme } from "../../../js/page.js";
import { valueColours } from "../../../js/scale.js";
import { html } from "../../../js/components/elements.js";
import { cellKind, columnOf, stateCells } from "../steps.js";

/** @import { StateTable } from "../../../js/types.js" */

/** Of colours. @typedef {{ low: number, high: number }} Scale */

export const ROW_PX = 16;
const GAP_PX = 2;
const HATCH_PX = 6;
const DOT_PX = 2;
/** Of the feet of a group of legs on their grid, at the head of a row. */
const FEET = { width: 18, margin: 4, dot: 0.9, foot: 2.6 };
/** The colours of groups of legs in the style sheet. */
const GROUP_COLOURS = 6;

/** @param {Pick<StateTable, "pairs">} shown */
export const widthOfFeet = ({ pairs }) => FEET.width * pairs.length + FEET.margin;

/** The names of the rows, drawn: where the feet of each group of legs stand on their grid, forward up. */
/** @param {{ shown: StateTable }} props */
export function Feet({ shown }) {
  const canvas = useRef(/** @type {HTMLCanvasElement | null} */ (null));
  useDrawn(() => canvas.current && drawFeet(canvas.current, shown), [shown]);
  return html`<canvas class="heat-feet" ref=${canvas} aria-hidden="true"></canvas>`;
}

/** Draw now, and whenever something or the colours of the page change. */
/** @param {() => unknown} act @param {unknown[]} of */
function useDrawn(act, of) {
  const mode = theme.value;
  useEffect(() => {
    act();
    const media = matchMedia("(prefers-color-scheme: dark)");
    media.addEventListener("change", act);
    return () => media.removeEventListener("change", act);
  }, [...of, mode]);
}

/** @param {HTMLCanvasElement} canvas @param {StateTable} shown */
function drawFeet(canvas, shown) {
  const { first, values, pairs, cells_m } = shown;
  const context = sized(canvas, { width: widthOfFeet(shown), height: values.length * ROW_PX });
  if (!context) return;
  const colour = coloursOf(canvas.parentElement ?? canvas);
  const dim = colour("--dim");
  const ofPairs = pairs.map((_, pair) => colour(`--pair-${(pair % GROUP_COLOURS) + 1}`));
  const reach_m = Math.max(...cells_m.flat().map(Math.abs)) || 1;
  const radius = (Math.min(FEET.width, ROW_PX) - 2 * FEET.foot - 1) / 2;
  const dot = (/** @type {number} */ x, /** @type {number} */ y, /** @type {number} */ size) => {
    context.beginPath();
    context.arc(x, y, size, 0, 2 * Math.PI);
    context.fill();
  };
  values.forEach((_, row) => stateCells(first + row, shown).forEach((cell, pair) => {
    const middle = [FEET.width * (pair + 0.5), ROW_PX * (row + 0.5)];
    cells_m.forEach(([x_m, y_m], other) => {
      context.fillStyle = other === cell ? ofPairs[pair] : dim;
      const at = [middle[0] + (radius * x_m) / reach_m, middle[1] - (radius * y_m) / reach_m];
      dot(at[0], at[1], other === cell ? FEET.foot : FEET.dot);
    });
  }));
}

/** The pen of a canvas that has a size [px], as sharp as the screen; null without one. */
/** @param {HTMLCanvasElement} canvas @param {{ width: number, height: number }} size */
function sized(canvas, { width, height }) {
  const scale = Math.min(devicePixelRatio || 1, 2);
  Object.assign(canvas, { width: Math.max(1, Math.round(width * scale)), height: Math.round(height * scale) });
  Object.assign(canvas.style, { width: `${width}px`, height: `${height}px` });
  const context = canvas.getContext("2d");
  if (!context || !width) return null;
  context.scale(scale, scale);
  return context;
}

/** @param {{ shown: StateTable, scale: Scale }} props */
export function Cells({ shown, scale }) {
  const canvas = useRef(/** @type {HTMLCanvasElement | null} */ (null));
  const [width, setWidth] = useState(0);
  useLayoutEffect(() => {
    const host = /** @type {HTMLElement} */ (canvas.current?.parentElement);
    setWidth(host.clientWidth);
    const observer = new ResizeObserver(() => setWidth(host.clientWidth));
    observer.observe(host);
    return () => observer.disconnect();
  }, []);
  useDrawn(() => canvas.current && draw(canvas.current, shown, width, scale), [shown, width, scale.low, scale.high]);
  return html`<canvas ref=${canvas} aria-hidden="true"></canvas>`;
}

/**
 * Moves never tried are hatched, as in the table of one state; the best move of a state has a dot.
 * @param {HTMLCanvasElement} canvas
 * @param {StateTable} shown
 * @param {number} width
 * @param {Scale} scale
 */
function draw(canvas, shown, width, { low, high }) {
  const rows = shown.values.length;
  const columns = shown.values[0].length;
  const context = sized(canvas, { width, height: rows * ROW_PX });
  if (!context) return;
  const colour = coloursOf(canvas.parentElement ?? canvas);
  const [sunk, line, dim] = [colour("--sunk"), colour("--line"), colour("--dim")];
  const hatch = hatched(context, sunk, line);
  const cellsOfPair = shown.cell_names.length;
  for (let row = 0; row < rows; row += 1) {
    const best = columnOf(shown.best[row], shown);
    for (let column = 0; column < columns; column += 1) {
      const left = (column * width) / columns;
      const right = ((column + 1) * width) / columns - (column % cellsOfPair === cellsOfPair - 1 ? GAP_PX : 0.5);
      /** @type {[number, number, number, number]} */
      const box = [left, row * ROW_PX, right - left, ROW_PX - 1];
      const kind = cellKind(shown, row, column);
      if (kind === "stays") {
        context.fillStyle = dim;
        context.fillRect((left + right) / 2 - 2, row * ROW_PX + ROW_PX / 2 - 1, 4, 1);
        continue;
      }
      const colours = valueColours(shown.values[row][column] ?? 0, low, high);
      context.fillStyle = kind === "tried" ? colours.background : hatch;
      context.fillRect(...box);
      if (kind !== "tried" || column !== best) continue;
      context.fillStyle = colours.color;
      context.beginPath();
      context.arc((left + right) / 2, row * ROW_PX + (ROW_PX - 1) / 2, DOT_PX, 0, 2 * Math.PI);
      context.fill();
    }
  }
}

/** @param {CanvasRenderingContext2D} context @param {string} ground @param {string} stroke */
function hatched(context, ground, stroke) {
  const tile = document.createElement("canvas");
  Object.assign(tile, { width: HATCH_PX, height: HATCH_PX });
  const pen = tile.getContext("2d");
  if (!pen) return ground;
  pen.fillStyle = ground;
  pen.fillRect(0, 0, HATCH_PX, HATCH_PX);
  pen.strokeStyle = stroke;
  pen.lineWidth = 1.5;
  pen.beginPath();
  for (const shift of [-HATCH_PX, 0, HATCH_PX]) {
    pen.moveTo(shift, HATCH_PX);
    pen.lineTo(shift + HATCH_PX, 0);
  }
  pen.stroke();
  return context.createPattern(tile, "repeat") ?? ground;
}

/** A function that resolves custom properties, which a canvas does not. @param {Element} host */
function coloursOf(host) {
  const probe = document.createElement("span");
  return (/** @type {string} */ name) => {
    host.append(probe);
    probe.style.color = `var(${name})`;
    const computedColor = getComputedStyle(probe).color;
    probe.remove();
    return computedColor;
  };
}
