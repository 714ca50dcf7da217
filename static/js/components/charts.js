// Charts: lines over an axis with a crosshair, zoom, table and files, and the placeholder of a chart without data.
import { useEffect, useMemo, useRef, useState } from "preact/hooks";
import {
  chartDepth, crosshair, fileNameOf, readIndex, tableOf, thinnedPath, valuesIn, within, zoomBy, zoomOf,
} from "../chart.js";
import { decimal, metres, sentence, t, whole as wholeNumber } from "../format.js";
import { cssColour, LineLabels, MarkLines, placeCaptions, roomFor, widthOf } from "./line-labels.js";
import { isProjected } from "../page.js";
import { thinned, ticks } from "../scale.js";
import { served } from "../settings.js";
import { html, useWidth } from "./elements.js";

/** @import { ComponentChildren } from "preact" */
/** @import { Axis, Line, Mark, Range } from "../chart.js" */
/** @import { CrosshairProps } from "./crosshair.js" */
/** @import { Frame } from "./line-labels.js" */
/** @import { Toggled } from "../types.js" */

// ---- lines

/** Least height of the plotting area, and for a wide picture its share of the width up to the largest [px]. */
const PLOT = { least: 220, share: 0.56, most: 320 };
const TOP_PX = 31;
const BOTTOM_PX = 38;
const DOT_PX = 3;
const TICK_GAP_PX = 6;
const TICK_PX = 14;
const REGULAR = 400;
/** Narrower charts have fewer ticks. */
const WIDE_PX = 300;
/** More lines of seeds cannot be told apart. */
const MAX_SEEDS = 200;

/**
 * Lines over an axis, in a picture that follows the width, the theme and the data. Charts with the same `x.axis`
 * are read and zoomed together.
 * @param {object} props
 * @param {string} props.name "the learning curve"
 * @param {string} props.label what the chart shows, in a sentence
 * @param {{ axis: string, min?: number, max: number, unit: string, text: (x: number) => string }} props.x its `unit` is
 *   the title of the axis: "race time, s"
 * @param {{ min?: number, max: number, unit: string, text: (y: number) => string, title?: string }} props.y its `title`
 *   is that of the axis, "distance, m"; without one it is the unit
 * @param {Line[]} props.lines
 * @param {Mark[]} [props.marks]
 * @param {number[]} props.xs where the crosshair stops: the rows of the table
 * @param {number} [props.now] the index that is read first; by default the last
 * @param {((x: number) => unknown) | null} [props.seek] shows a moment; null where there is none, or for who may not
 * @param {{ shown: number, computed: number } | null} [props.reach] of the axis: up to where lines are shown, and up to
 *   where they can be; null where all that is known is shown
 * @param {ComponentChildren} [props.children] between the picture and the table
 */
export function Chart(props) {
  const { name, label, x, y, lines, marks = [], xs, now = xs.length - 1, seek = null, reach = null, children } = props;
  const [host, width, scale] = useSize();
  /** @type {[number, number]} */
  const whole = [x.min ?? 0, x.max];
  const zoom = zoomOf(x.axis);
  const part = zoom ? within(zoom, whole) : whole;
  /** @type {[number, number]} */
  const all = [y.min ?? 0, y.max];
  const frame = frameOf(width, { lines, part, values: zoom ? valuesIn(lines, part, all) : all });
  const chart = { ...props, marks };
  const axis = { axis: x.axis, xs, whole, part, now, seek, reach };
  const inset = {
    left: scale * frame.left, right: scale * (width - frame.right), top: scale * TOP_PX, bottom: scale * BOTTOM_PX,
  };
  /** @param {{ relatedTarget: Node | null, currentTarget: HTMLElement }} event */
  const onFocusOut = ({ relatedTarget, currentTarget }) => {
    if (!currentTarget.contains(relatedTarget) && crosshair.peek()?.axis === x.axis) crosshair.value = null;
  };
  return html`
    <div class="chart-frame" onFocusOut=${onFocusOut}>
      <div class="chart-picture" ref=${host} style=${{ height: `${scale * frame.height}px` }}>
        ${width > 0 && html`
          <${Picture} label=${label} x=${x} y=${y} lines=${lines} marks=${marks} frame=${frame} scale=${scale} />
          ${canRead() && html`
            <${Crosshair} ...${axis} name=${name} lines=${lines} marks=${marks} x=${x} y=${y} inset=${inset} />
          `}
        `}
      </div>
      ${isFull() && html`
        ${children}
        <div class="chart-foot">
          <${ChartAsTable} caption=${label} chart=${chart} />
          <div class="chart-tools">
            ${zoom && html`<button class="link" onClick=${() => zoomBy(axis, 0)}>Show all</button>`}
            <${ChartMenu} chart=${chart} axis=${axis} host=${host} />
          </div>
        </div>
      `}
    </div>
  `;
}

/** @type {import("preact").FunctionComponent<CrosshairProps> | null} */
let LoadedCrosshair = null;

/** Loaded when it is first drawn: who watches has none. @param {CrosshairProps} props */
function Crosshair(props) {
  const [, setThere] = useState(LoadedCrosshair !== null);
  useEffect(() => {
    if (LoadedCrosshair !== null) return;
    import("./crosshair.js").then((module) => {
      LoadedCrosshair = module.Crosshair;
      setThere(true);
    }, () => {});
  }, []);
  return LoadedCrosshair && html`<${LoadedCrosshair} ...${props} />`;
}

/** Who watches sees lines, who tries reads them, and who studies has their numbers as well. */
const canRead = () => chartDepth.value !== "watch";
const isFull = () => chartDepth.value === "study";

/** @typedef {Frame & { xTicks: number[], yTicks: number[] }} TickedFrame */
/** @typedef {Parameters<typeof Chart>[0]} ChartProps */
/** @typedef {ChartProps["x"]} XAxis */
/** @typedef {ChartProps["y"]} YAxis */
/** @typedef {ChartProps & { marks: Mark[] }} ShownChart */

/**
 * @param {number} width
 * @param {{ lines: Line[], part: Range, values: Range }} other
 * @returns {TickedFrame}
 */
function frameOf(width, { lines, part: [from, to], values: [least, most] }) {
  const yTicks = ticks(most, 4, least);
  const left = Math.ceil(Math.max(0, ...tickTexts(yTicks).map((text) => widthOf(text, REGULAR)))) + TICK_GAP_PX;
  const right = Math.max(left + 1, width - roomFor(lines, width));
  const bottom = TOP_PX + Math.round(Math.max(PLOT.least, Math.min(PLOT.share * width, PLOT.most)));
  return {
    width, height: bottom + BOTTOM_PX, left, right, top: TOP_PX, bottom, yTicks,
    xTicks: ticks(to, width > WIDE_PX ? 4 : 2, from),
    x: (value) => left + ((right - left) * (value - from)) / (to - from || 1),
    y: (value) => bottom - ((bottom - TOP_PX) * (value - least)) / (most - least || 1),
  };
}

/** The numbers of an axis, all with as many decimals. @param {number[]} numbers */
function tickTexts(numbers) {
  const decimals = Math.max(0, ...numbers.map((number) => (tickText(number).split(".")[1] ?? "").length));
  return numbers.map((number) => decimal(decimals
    ? number.toFixed(decimals).replace("-", number.toFixed(decimals) === `-${(0).toFixed(decimals)}` ? "" : "\u2212")
    : tickText(number)));
}

let pictures = 0;

/**
 * @param {{ label: string, x: XAxis, y: YAxis, lines: Line[], marks: Mark[], frame: TickedFrame, scale: number }} props
 */
function Picture({ label, x, y, lines, marks, frame, scale }) {
  const { current: id } = useRef(`chart-${(pictures += 1)}`);
  const { left, right, top, bottom, width, height } = frame;
  /** @param {number} at */
  const isAcross = (at) => at >= left - 1 && at <= right + 1;
  /** @param {number} at */
  const isUp = (at) => at >= top - 1 && at <= bottom + 1;
  const inView = marks.filter((mark) =>
    (mark.x === undefined ? isUp(frame.y(mark.y ?? NaN)) : isAcross(frame.x(mark.x))));
  const ended = lines.filter(({ xs, ys }) => isAcross(frame.x(xs.at(-1) ?? NaN)) && isUp(frame.y(Number(ys.at(-1)))));
  return html`
    <svg class="chart-lines" width=${scale * width} height=${scale * height} viewBox=${`0 0 ${width} ${height}`}
      role="img" aria-label=${label}>
      <clipPath id=${id}>
        <rect x=${left - DOT_PX} y=${top - DOT_PX} width=${right - left + 2 * DOT_PX}
          height=${bottom - top + 2 * DOT_PX} />
      </clipPath>
      <${Axes} x=${x} y=${y} frame=${frame} />
      <g clip-path=${`url(#${id})`}>
        ${lines.map((line) => html`<${Curve} key=${line.name} line=${line} frame=${frame} />`)}
      </g>
      <${MarkLines} marks=${inView} frame=${frame} />
      <${LineLabels} marks=${inView} lines=${ended} curves=${lines} frame=${frame} />
    </svg>
  `;
}

/** @param {{ x: XAxis, y: YAxis, frame: TickedFrame }} props */
function Axes({ x, y, frame }) {
  const { left, right, bottom, height, xTicks, yTicks } = frame;
  const [xTexts, yTexts] = [tickTexts(xTicks), tickTexts(yTicks)];
  const boxes = xTicks.map((tick, n) => {
    const width = widthOf(xTexts[n], REGULAR);
    const middle = frame.x(tick) - width / 2;
    return { left: Math.min(middle, right - width), top: bottom + 4, width: width + TICK_GAP_PX, height: TICK_PX };
  });
  const placed = placeCaptions(boxes, { left: 0, top: 0, width: frame.width + TICK_GAP_PX, height });
  return html`
    ${yTicks.map((tick, n) => html`
      <line class="rule" x1=${left} x2=${right} y1=${frame.y(tick)} y2=${frame.y(tick)} />
      <text x=${left - TICK_GAP_PX} y=${frame.y(tick) + 4} text-anchor="end">${yTexts[n]}</text>
    `)}
    <text x="0" y="11" text-anchor="start">${y.title ?? y.unit}</text>
    ${placed.map((box, n) => box && html`<text x=${box.left} y=${bottom + 16}>${xTexts[n]}</text>`)}
    <text x=${right} y=${height - 4} text-anchor="end">${x.unit}</text>
  `;
}

/** @type {(value: number) => string} */
const tickText = (value) => (Number.isInteger(value) ? wholeNumber(value) : String(Number(value.toFixed(3))));

/** @param {{ line: Line, frame: TickedFrame }} props */
function Curve({ line: { color, dash = [], xs, ys, low, high, seeds = [], dots }, frame }) {
  /** @param {(number | null)[]} values */
  const at = (values) => thinnedPath(
    values.flatMap((value, n) => (value === null || value === undefined ? [] : [[frame.x(xs[n]), frame.y(value)]])),
    Math.max(1, frame.right - frame.left),
  ).map(([left, top]) => `${left.toFixed(1)} ${top.toFixed(1)}`);
  /** @param {(number | null)[]} values */
  const path = (values) => (values.length ? `M${at(values).join("L")}` : "");
  const each = (seeds[0] ?? []).map((_, seed) => seeds.map((block) => block[seed]));
  const hasBand = low?.length && low.every((value) => value !== null);
  return html`
    <g style=${{ "--agent": cssColour(color) }} class=${low ? "with-band" : ""}>
      ${thinned(each, MAX_SEEDS).map((values) => html`<path class="seed-line" d=${path(values)} />`)}
      ${hasBand && html`<path class="band" d=${`${path(low)}L${at(high ?? []).reverse().join("L")}Z`} />`}
      <path class="curve" d=${path(ys)} stroke-dasharray=${dash.length ? dash.join(" ") : undefined} />
      ${dots && ys.map((value, n) => html`
        <circle class="curve-dot" cx=${frame.x(xs[n])} cy=${frame.y(Number(value))} r=${DOT_PX} />
      `)}
    </g>
  `;
}

const USUAL_FONT_PX = 16;

/**
 * A ref, the width that there is to draw in [px], 0 until it is measured, and by how much it is drawn larger, as the
 * page's type is.
 * @returns {[{ current: any }, number, number]}
 */
function useSize() {
  const [host, width] = useWidth();
  // Not at each drawing, which would compute styles in between.
  const larger = useMemo(
    () => parseFloat(getComputedStyle(document.documentElement).fontSize) / USUAL_FONT_PX,
    [width, isProjected.value],
  );
  return [host, Math.round(width / larger), larger];
}

/** The line of the best known walk, thin. @param {number} y */
export const bestKnownMark = (y) =>
  ({
    y, name: t("Best known"), kind: "best-known", ink: "--dim",
    text: t("best known: {distance}", { distance: metres(y) }),
  });

/** Note on the thin line, where its caption has no room. @param {{ distance: number }} props */
export const BestKnownKey = ({ distance }) => html`
  <p class="line-key dim" title=${served().help.best_known}>
    <i class="thin-line" aria-hidden="true"></i>
    ${" "}Best known: ${metres(distance)}
  </p>
`;

// ---- the menu: what the keys do, and the chart as a file

const MENU_FACTOR = 2;

/** @param {{ chart: ShownChart, axis: Axis, host: { current: HTMLElement } }} props */
function ChartMenu({ chart, axis, host }) {
  const index = readIndex(axis);
  const x = index === null ? null : axis.xs[index];
  /** @param {FileKind} kind */
  const save = async (kind) => {
    const { saveChart } = await import("./chart-files.js");
    const svg = /** @type {SVGSVGElement} */ (host.current.querySelector("svg"));
    await saveChart(kind, { ...chart, svg, file: fileNameOf(chart.name) });
  };
  return html`
    <${FileMenu} label=${t("More of {chart}: zoom, download", { chart: chart.name })}
      kinds=${["png", "svg", "csv"]} save=${save}>
      ${axis.seek && x !== null && html`
        <button class="quiet" onClick=${() => axis.seek?.(x)}>Show this moment: ${chart.x.text(x)}</button>
      `}
      <button class="quiet" onClick=${() => zoomBy(axis, MENU_FACTOR)}>Zoom in</button>
      ${zoomOf(axis.axis) && html`
        <button class="quiet" onClick=${() => zoomBy(axis, 1 / MENU_FACTOR)}>Zoom out</button>
      `}
    <//>
  `;
}

// ---- the numbers of a chart as a table, folded

const MAX_ROWS = 100;

/**
 * Numbers as a table, folded; `columns` and `rows` return them, and are called when it is opened.
 * @param {{ caption: string, columns: () => string[], rows: () => string[][] }} props
 */
export function AsTable({ caption, columns, rows }) {
  const [isOpen, setOpen] = useState(false);
  return html`
    <details class="as-table" onToggle=${(/** @type {Toggled} */ { target }) => setOpen(target.open)}>
      <summary>As a table</summary>
      ${isOpen && html`
        <div class="scroller" tabindex="0" role="region" aria-label=${caption}>
          <table>
            <caption class="sr-only">${caption}</caption>
            <thead><tr>${columns().map((title) => html`<th scope="col">${title}</th>`)}</tr></thead>
            <tbody>
              ${rows().map(([first, ...cells]) => html`
                <tr><th scope="row">${first}</th>${cells.map((cell) => html`<td>${cell}</td>`)}</tr>
              `)}
            </tbody>
          </table>
        </div>
      `}
    </details>
  `;
}

/** @param {{ caption: string, chart: ShownChart }} props */
function ChartAsTable({ caption, chart: { x, y, lines, marks, xs } }) {
  const table = () => tableOf({ lines, marks, xs: thinned(xs, MAX_ROWS), titles: { x: sentence(x.unit) } });
  /** @param {number | null} value */
  const words = (value) => (value === null ? "–" : y.text(value));
  const rows = () => table().rows.map(([at, ...values]) => [x.text(at), ...values.map(words)]);
  return html`<${AsTable} caption=${caption} columns=${() => table().columns} rows=${rows} />`;
}

// ---- a chart or table without data: a sketch, and what will fill it

const CURVE = html`
  <svg viewBox="0 0 320 110" preserveAspectRatio="none" aria-hidden="true">
    <path class="rule" d="M0 109H320M0 73H320M0 37H320" />
    <path class="sketch" d="M0 108C60 98 80 62 140 50S230 28 320 22" />
  </svg>
`;
const LINES = html`
  <svg viewBox="0 0 320 110" preserveAspectRatio="none" aria-hidden="true">
    <path class="rule" d="M0 109H320M0 73H320M0 37H320" />
    <path class="sketch" d="M0 108 210 20" /><path class="sketch" d="M0 108 230 32" />
    <path class="sketch" d="M0 108H40L48 102H92L100 96H144L152 90H196L204 84H248L256 78H300" />
  </svg>
`;
const CELLS = html`
  <div class="sketch-cells" aria-hidden="true">${Array.from({ length: 15 }, () => html`<i></i>`)}</div>
`;

const SHAPES = { curve: CURVE, lines: LINES, cells: CELLS };

/** @param {{ words: string, shape?: keyof typeof SHAPES }} props */
export const Empty = ({ words, shape = "curve" }) => html`
  <div class=${`empty ${shape}`}>
    ${SHAPES[shape]}
    <p>${words}</p>
  </div>
`;

// ---- the menu of a picture, with its downloads

/** @typedef {"png" | "svg" | "csv"} FileKind */

/** @type {Record<FileKind, string>} */
const DOWNLOADS = {
  png: t("Download as PNG"), svg: t("Download as SVG"), csv: t("Download its numbers as CSV"),
};

/**
 * `children` come before the downloads.
 * @param {{
 *   label: string, kinds: FileKind[], save: (kind: FileKind) => Promise<unknown>, children?: ComponentChildren
 * }} props
 */
export function FileMenu({ label, kinds, save, children }) {
  const [problem, setProblem] = useState("");
  /** @param {FileKind} kind */
  const download = (kind) => {
    setProblem("");
    save(kind).catch(() => setProblem(t("The file could not be made. Load the page again.")));
  };
  return html`
    <details class="menu chart-menu">
      <summary class="quiet square small" aria-label=${label}>⋯</summary>
      <div class="menu-body">
        ${children}
        ${kinds.map((kind) => html`<button class="quiet" onClick=${() => download(kind)}>${DOWNLOADS[kind]}</button>`)}
        ${problem && html`<p class="bad" role="alert">${problem}</p>`}
      </div>
    </details>
  `;
}
