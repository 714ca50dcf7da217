// A table with a strip of dots in each row as a file: SVG as it is drawn, and the same as PNG. Loaded when one is asked
// for.
import { fileNameOf } from "../chart.js";
import { largest } from "../scale.js";
import { widthOf } from "./line-labels.js";
import {
  colourOf, element, FONT, MARGIN_PX, pictureFile, savePicture, textElement, TITLE_PX, withStyles,
} from "./svg-files.js";

const STRIP_PX = 300;
const LINE_PX = 16;
const GAP_PX = 20;
const ROW_GAP_PX = 12;
const LEGEND_PX = 24;
const REGULAR = 400;

/** A cell: its lines of text, and its strip, which follows the first of them. */
/** @typedef {{ lines: string[], strip: SVGSVGElement | null, isHead: boolean }} Cell */

/**
 * Save a table as a picture.
 * @param {"png" | "svg"} kind
 * @param {object} picture
 * @param {HTMLTableElement} picture.table
 * @param {Element | null} picture.legend whose children are signs, each with its words
 * @param {string} picture.title
 */
export const saveTable = (kind, { table, legend, title }) =>
  savePicture(kind, pictureOf(table, legend, title), fileNameOf(title));

/** @param {HTMLTableElement} table @param {Element | null} legend @param {string} title */
function pictureOf(table, legend, title) {
  const rows = [...table.rows].map((row) => [...row.cells].map(cellOf));
  const columns = largest(rows.map((row) => row.length), 1);
  // The name of a group of rows stands in the first of them.
  const aligned = rows.map((row) => [...Array.from({ length: columns - row.length }, () => EMPTY), ...row]);
  const widths = Array.from({ length: columns }, (_, n) => largest(aligned.map((row) => widthOfCell(row[n]))));
  const lefts = widths.map((_, column) =>
    widths.slice(0, column).reduce((sum, width) => sum + width + GAP_PX, MARGIN_PX));
  let top = MARGIN_PX + TITLE_PX;
  const shapes = aligned.flatMap((row) => {
    const drawn = row.flatMap((cell, column) => drawnCell(cell, lefts[column], top, table));
    top += largest(row.map(heightOf)) + ROW_GAP_PX;
    return drawn;
  });
  const signs = legend ? drawnLegend(legend, top) : [];
  return pictureFile({
    host: table, title, label: title, shapes: [...shapes, ...signs],
    width: widths.reduce((sum, width) => sum + width + GAP_PX, 2 * MARGIN_PX - GAP_PX),
    height: top + (legend ? LEGEND_PX : 0) + MARGIN_PX,
  });
}

/** @type {Cell} */
const EMPTY = { lines: [], strip: null, isHead: false };

/** @param {HTMLTableCellElement} cell @returns {Cell} */
function cellOf(cell) {
  /** @type {SVGSVGElement | null} */
  const strip = cell.querySelector("svg.dots");
  const texts = strip ? [...cell.querySelectorAll("p")].map((line) => line.innerText) : cell.innerText.split("\n");
  const lines = texts.map((text) => text.replace(/\s+/g, " ").trim()).filter(Boolean);
  return { lines, strip, isHead: cell.tagName === "TH" };
}

/** @param {Cell} cell */
const widthOfCell = ({ lines, strip }) =>
  Math.ceil(Math.max(strip ? STRIP_PX : 0, ...lines.map((line) => widthOf(line))));

/** @param {Cell} cell */
const heightOf = ({ lines, strip }) =>
  lines.length * LINE_PX + (strip ? strip.height.baseVal.value + LINE_PX / 2 : 0);

/** @param {Cell} cell @param {number} left @param {number} top @param {Element} host */
function drawnCell({ lines, strip, isHead }, left, top, host) {
  const stripTop = top + (lines.length ? LINE_PX : 0) + LINE_PX / 4;
  const below = strip ? stripTop + strip.height.baseVal.value + LINE_PX / 4 : top + LINE_PX;
  const texts = lines.map((line, n) => {
    const y = (n ? below + (n - 1) * LINE_PX : top) + LINE_PX - 4;
    return textAt(line, { x: left, y, fill: colourOf(host, n || isHead ? "--dim" : "--ink") });
  });
  return strip ? [...texts, placed(strip, { x: left, y: stripTop, width: STRIP_PX })] : texts;
}

/** @param {string} words @param {{ x: number, y: number, fill: string }} place */
const textAt = (words, place) =>
  textElement("text", words, { ...place, "font-family": FONT, "font-size": "12px", "font-weight": REGULAR });

/** A copy of a drawing at a place. @param {SVGSVGElement} svg @param {Record<string, number>} place */
function placed(svg, place) {
  const copy = withStyles(svg);
  for (const [name, value] of Object.entries(place)) copy.setAttribute(name, String(value));
  return copy;
}

/** @param {Element} legend @param {number} top */
function drawnLegend(legend, top) {
  let left = MARGIN_PX;
  return [...legend.children].flatMap((entry) => {
    const sign = entry.querySelector("svg");
    const words = (entry.textContent ?? "").trim();
    const width = sign ? sign.width.baseVal.value : 0;
    const x = left;
    left += width + 6 + widthOf(words, REGULAR) + GAP_PX;
    const group = element("g");
    if (sign) group.append(placed(sign, { x, y: top }));
    group.append(textAt(words, { x: x + width + 6, y: top + 12, fill: colourOf(legend, "--dim") }));
    return [group];
  });
}
