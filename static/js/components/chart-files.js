// A chart as a file: SVG as it is drawn, the same as PNG, and its numbers as CSV. Loaded when one is asked for.
import { csvOf, tableOf } from "../chart.js";
import { sentence } from "../format.js";
import { saveFile } from "../save-file.js";
import { widthOf } from "./line-labels.js";
import {
  colourOf, copyStyles, element, FONT, MARGIN_PX, pictureFile, savePicture, textElement, TITLE_PX, withStyles,
} from "./svg-files.js";

/** @import { Line, Mark } from "../chart.js" */

/** An entry of the legend, of a line that is drawn. @typedef {{ name: string, of: Element }} Sample */

const ROW_PX = 20;
const SAMPLE_PX = 24;
const GAP_PX = 18;

/**
 * Save a chart as a file.
 * @param {"png" | "svg" | "csv"} kind
 * @param {object} chart
 * @param {SVGSVGElement} chart.svg
 * @param {string} chart.file name without its ending
 * @param {string} chart.name
 * @param {string} chart.label
 * @param {Line[]} chart.lines
 * @param {Mark[]} chart.marks
 * @param {number[]} chart.xs
 * @param {{ unit: string }} chart.x
 * @param {{ unit: string }} chart.y
 */
export async function saveChart(kind, chart) {
  if (kind === "csv") saveFile(new Blob([csvOf(numbersOf(chart))], { type: "text/csv" }), `${chart.file}.csv`);
  else await savePicture(kind, pictureOf(chart), chart.file);
}

/** @param {{ lines: Line[], marks: Mark[], xs: number[], x: { unit: string }, y: { unit: string } }} one */
const numbersOf = ({ lines, marks, xs, x, y }) =>
  tableOf({ lines, marks, xs, titles: { x: sentence(x.unit), y: y.unit } });

/**
 * The picture with a title and a legend: on the page they stand beside it.
 * @param {{ svg: SVGSVGElement, name: string, label: string, lines: Line[], marks: Mark[] }} chart
 */
function pictureOf({ svg, name, label, lines, marks }) {
  const copy = withStyles(svg);
  const samples = [
    ...lines.map((line) => ({ name: line.name, of: svg.querySelectorAll(".curve")[lines.indexOf(line)] })),
    ...marks.filter((mark) => mark.name).map((mark) => ({ name: mark.name, of: markOf(svg, mark) })),
  ].filter(/** @returns {sample is Sample} */ (sample) => sample.of !== null && sample.name !== undefined);
  const [chartWidth, chartHeight] = [svg.width.baseVal.value, svg.height.baseVal.value];
  const rows = rowsOf(samples, chartWidth);
  const width = chartWidth + 2 * MARGIN_PX;
  const height = TITLE_PX + chartHeight + rows.length * ROW_PX + 2 * MARGIN_PX;
  copy.setAttribute("x", String(MARGIN_PX));
  copy.setAttribute("y", String(MARGIN_PX + TITLE_PX));
  const legend = rows.flatMap((row, n) => {
    const y = MARGIN_PX + TITLE_PX + chartHeight + n * ROW_PX + 14;
    return row.flatMap(({ name: words, of, left }) => legendOf({ svg, words, of, left, y }));
  });
  return pictureFile({ host: svg, width, height, title: sentence(name), label, shapes: [copy, ...legend] });
}

/**
 * A line of the legend, drawn like the one in the chart.
 * @param {{ svg: SVGSVGElement, words: string, of: Element, left: number, y: number }} heading
 */
function legendOf({ svg, words, of, left, y }) {
  const sample = element("line", { x1: left, x2: left + SAMPLE_PX, y1: y, y2: y });
  copyStyles(of, sample);
  return [sample, textElement("text", words, {
    x: left + SAMPLE_PX + 6, y: y + 4, fill: colourOf(svg, "--dim"), "font-family": FONT,
    "font-size": "12px",
  })];
}

/**
 * The samples of a legend in as many rows as they need.
 * @param {Sample[]} samples
 * @param {number} width
 */
function rowsOf(samples, width) {
  /** @type {(Sample & { left: number })[][]} */
  const rows = [];
  let left = Infinity;
  for (const { name, of } of samples) {
    const needed = SAMPLE_PX + 6 + widthOf(name, 400);
    if (left + needed > width) {
      rows.push([]);
      left = MARGIN_PX;
    }
    rows[rows.length - 1].push({ name, of, left });
    left += needed + GAP_PX;
  }
  return rows;
}

/** @param {SVGSVGElement} svg @param {Mark} other */
const markOf = (svg, { kind }) => svg.querySelector(kind ? `.mark.${kind}` : ".mark:not([class*=' '])");
