// A chart as a file: SVG as it is drawn, the same as PNG, and its numbers as CSV. Loaded when one is asked for.
import { csvOf, tableOf } from "../chart.js";
import { saveFile } from "../files.js";
import { sentence } from "../format.js";
import { widthOf } from "./line-labels.js";

/** @import { Line, Mark } from "../chart.js" */

/** An entry of the legend, of a line that is drawn. @typedef {{ name: string, of: Element }} Sample */

const SVG = "http://www.w3.org/2000/svg";
/** Pixels of the PNG to one on the page. */
const SCALE = 2;
const MARGIN_PX = 16;
const TITLE_PX = 28;
const ROW_PX = 20;
const SAMPLE_PX = 24;
const GAP_PX = 18;
/** Properties that the style sheet decides, and a file must bring along. */
const STYLES = [
  "fill", "fill-opacity", "stroke", "stroke-width", "stroke-dasharray", "stroke-linecap", "stroke-linejoin", "opacity",
  "font-family", "font-size", "font-weight", "paint-order", "dominant-baseline", "text-anchor",
];
/** Values that hold where nothing is said. @type {Record<string, string>} */
const INITIAL = {
  "fill-opacity": "1", "stroke": "none", "stroke-width": "1px", "stroke-dasharray": "none", "stroke-linecap": "butt",
  "stroke-linejoin": "miter", "opacity": "1", "font-weight": "400", "paint-order": "normal",
  "dominant-baseline": "auto", "text-anchor": "start",
};
const COLOURS = new Set(["fill", "stroke"]);
/** Elements that are drawn; what encloses them passes no style on. */
const DRAWN = "line, path, circle, text";

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
  const blobs = {
    csv: () => new Blob([csvOf(numbersOf(chart))], { type: "text/csv" }),
    svg: () => new Blob([pictureOf(chart).text], { type: "image/svg+xml" }),
    png: () => asPng(pictureOf(chart)),
  };
  saveFile(await blobs[kind](), `${chart.file}.${kind}`);
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
  const root = element("svg", { xmlns: SVG, width, height, viewBox: `0 0 ${width} ${height}` });
  root.append(
    textElement("title", label),
    element("rect", { width, height, fill: colourOf(svg, "--panel") }),
    textElement("text", sentence(name), {
      x: MARGIN_PX, y: MARGIN_PX + 12, fill: colourOf(svg, "--ink"), "font-family": "system-ui, sans-serif",
      "font-size": "15px", "font-weight": 650,
    }),
  );
  copy.setAttribute("x", String(MARGIN_PX));
  copy.setAttribute("y", String(MARGIN_PX + TITLE_PX));
  root.append(copy);
  rows.forEach((row, n) => {
    const y = MARGIN_PX + TITLE_PX + chartHeight + n * ROW_PX + 14;
    row.forEach(({ name: words, of, left }) => root.append(...legendOf({ svg, words, of, left, y })));
  });
  return { text: new XMLSerializer().serializeToString(root), width, height };
}

/**
 * A line of the legend, drawn like the one in the chart.
 * @param {{ svg: SVGSVGElement, words: string, of: Element, left: number, y: number }} heading
 */
function legendOf({ svg, words, of, left, y }) {
  const sample = element("line", { x1: left, x2: left + SAMPLE_PX, y1: y, y2: y });
  copyStyles(of, sample);
  return [sample, textElement("text", words, {
    x: left + SAMPLE_PX + 6, y: y + 4, fill: colourOf(svg, "--dim"), "font-family": "system-ui, sans-serif",
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

/** @param {SVGSVGElement} svg */
function withStyles(svg) {
  const copy = /** @type {SVGSVGElement} */ (svg.cloneNode(true));
  const originals = svg.querySelectorAll(DRAWN);
  copy.querySelectorAll(DRAWN).forEach((shape, n) => copyStyles(originals[n], shape));
  for (const shape of [copy, ...copy.querySelectorAll("g")]) {
    for (const name of ["role", "aria-label", "class", "style"]) shape.removeAttribute(name);
  }
  return copy;
}

/** @param {Element} from @param {Element} to */
function copyStyles(from, to) {
  const computed = getComputedStyle(from);
  to.removeAttribute("class");
  to.removeAttribute("style");
  for (const name of STYLES) {
    const value = computed.getPropertyValue(name);
    if (value && value !== INITIAL[name]) to.setAttribute(name, COLOURS.has(name) ? asRgb(value) : value);
    else to.removeAttribute(name);
  }
}

/** @param {string} name */
function element(name, attributes = {}) {
  const created = document.createElementNS(SVG, name);
  for (const [key, value] of Object.entries(attributes)) {
    if (key !== "xmlns") created.setAttribute(key, String(value));
  }
  return created;
}

/** @param {string} name @param {string} words */
function textElement(name, words, attributes = {}) {
  const created = element(name, attributes);
  created.textContent = words;
  return created;
}

/**
 * The value of a custom property of colours where it is shown.
 * @param {Element} host
 * @param {string} name
 */
function colourOf(host, name) {
  const probe = document.createElement("span");
  probe.style.color = `var(${name})`;
  host.parentElement?.append(probe);
  const computedColor = getComputedStyle(probe).color;
  probe.remove();
  return asRgb(computedColor);
}

/** A colour as other programs read it: not all know `oklab()`. @param {string} color */
function asRgb(color) {
  if (!/^(?!rgb)[\w-]+\(/.test(color)) return color;
  const pen = penOf(new OffscreenCanvas(1, 1));
  pen.fillStyle = color;
  pen.fillRect(0, 0, 1, 1);
  const [red, green, blue, alpha] = pen.getImageData(0, 0, 1, 1).data;
  return alpha < 255 ? `rgba(${red}, ${green}, ${blue}, ${alpha / 255})` : `rgb(${red}, ${green}, ${blue})`;
}

/** @param {OffscreenCanvas} canvas */
const penOf = (canvas) => /** @type {OffscreenCanvasRenderingContext2D} */ (canvas.getContext("2d"));

/** @param {{ text: string, width: number, height: number }} props */
async function asPng({ text, width, height }) {
  const image = new Image();
  image.src = `data:image/svg+xml;charset=utf-8,${encodeURIComponent(text)}`;
  await image.decode();
  const canvas = new OffscreenCanvas(SCALE * width, SCALE * height);
  penOf(canvas).drawImage(image, 0, 0, SCALE * width, SCALE * height);
  return canvas.convertToBlob({ type: "image/png" });
}
