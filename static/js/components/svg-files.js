// Pictures that are saved as files: SVG as it is drawn, with the styles of the page in it, and the same as PNG.
import { saveFile } from "../save-file.js";

/** The text of an SVG, and its size [px]. @typedef {{ text: string, width: number, height: number }} PictureFile */

const SVG = "http://www.w3.org/2000/svg";
/** Pixels of the PNG to one on the page. */
const SCALE = 2;
export const MARGIN_PX = 16;
export const TITLE_PX = 28;
export const FONT = "system-ui, sans-serif";
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
 * Save a picture as a file.
 * @param {"png" | "svg"} kind
 * @param {PictureFile} picture
 * @param {string} file name without its ending
 */
export async function savePicture(kind, picture, file) {
  const content = kind === "svg" ? new Blob([picture.text], { type: "image/svg+xml" }) : await asPng(picture);
  saveFile(content, `${file}.${kind}`);
}

/**
 * An SVG with a title at its top.
 * @param {object} picture
 * @param {Element} picture.host an element beside it on the page, whose colours it has
 * @param {number} picture.width [px]
 * @param {number} picture.height [px]
 * @param {string} picture.title
 * @param {string} picture.label what it shows, in a sentence
 * @param {Element[]} picture.shapes
 * @returns {PictureFile}
 */
export function pictureFile({ host, width, height, title, label, shapes }) {
  const root = element("svg", { xmlns: SVG, width, height, viewBox: `0 0 ${width} ${height}` });
  root.append(
    textElement("title", label),
    element("rect", { width, height, fill: colourOf(host, "--panel") }),
    textElement("text", title, {
      x: MARGIN_PX, y: MARGIN_PX + 12, fill: colourOf(host, "--ink"), "font-family": FONT, "font-size": "15px",
      "font-weight": 650,
    }),
    ...shapes,
  );
  return { text: new XMLSerializer().serializeToString(root), width, height };
}

/** A copy of a drawing that brings its styles along. @param {SVGSVGElement} svg */
export function withStyles(svg) {
  const copy = /** @type {SVGSVGElement} */ (svg.cloneNode(true));
  const originals = svg.querySelectorAll(DRAWN);
  copy.querySelectorAll(DRAWN).forEach((shape, n) => copyStyles(originals[n], shape));
  for (const shape of [copy, ...copy.querySelectorAll("g")]) {
    for (const name of ["role", "aria-label", "class", "style"]) shape.removeAttribute(name);
  }
  return copy;
}

/** @param {Element} from @param {Element} to */
export function copyStyles(from, to) {
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
export function element(name, attributes = {}) {
  const created = document.createElementNS(SVG, name);
  for (const [key, value] of Object.entries(attributes)) {
    if (key !== "xmlns") created.setAttribute(key, String(value));
  }
  return created;
}

/** @param {string} name @param {string} words */
export function textElement(name, words, attributes = {}) {
  const created = element(name, attributes);
  created.textContent = words;
  return created;
}

/**
 * The value of a custom property of colours where it is shown.
 * @param {Element} host
 * @param {string} name
 */
export function colourOf(host, name) {
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

/** @param {PictureFile} picture */
async function asPng({ text, width, height }) {
  const image = new Image();
  image.src = `data:image/svg+xml;charset=utf-8,${encodeURIComponent(text)}`;
  await image.decode();
  const canvas = new OffscreenCanvas(SCALE * width, SCALE * height);
  penOf(canvas).drawImage(image, 0, 0, SCALE * width, SCALE * height);
  return canvas.convertToBlob({ type: "image/png" });
}
