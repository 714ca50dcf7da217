// Charts: lines drawn by uPlot, dots on one axis, their numbers as a table, and the placeholder without data.
import { useEffect, useLayoutEffect, useRef, useState } from "preact/hooks";
import uPlot from "uplot";
import { shownTheme } from "../page.js";
import { largest, percent, shareOf, spread, swarm, thinned, ticks } from "../scale.js";
import { html } from "./elements.js";

// ---- lines

const HEIGHT = 216;
const FONT = "12px system-ui, sans-serif";

/**
 * @param {object} props
 * @param {string} props.label what the chart shows, in a sentence
 * @param {uPlot.AlignedData} props.data [xs, ys…]
 * @param {{ color: string, dash?: number[], width?: number, points?: boolean }[]} props.series one per line
 * @param {{ min?: number, max: number, unit: string }} props.x
 * @param {{ min?: number, max: number }} props.y
 * @param {{ text: string, color: string, x: number, y: number }[]} props.labels at the ends of lines
 * @param {object[]} [props.marks] straight lines, as `lineLabels` takes them
 * @param {number} [props.room] for the labels, on the right [px]
 */
export function Plot(props) {
  /** @type {{ current: any }} */
  const host = useRef(null);
  /** @type {{ current: any }} */
  const plot = useRef(null);
  const newest = useRef(props);
  newest.current = props;
  const shape = JSON.stringify(props.series);

  useLayoutEffect(() => {
    plot.current = new uPlot(optionsOf(host.current, newest), props.data, host.current);
    const watcher = new ResizeObserver(([{ contentRect }]) => {
      if (contentRect.width > 0) plot.current.setSize({ width: contentRect.width, height: HEIGHT });
    });
    watcher.observe(host.current);
    return () => {
      watcher.disconnect();
      plot.current.destroy();
    };
  }, [shape, shownTheme.value]);

  useEffect(() => plot.current.setData(props.data), [props.data, props.x.max, props.y.max]);

  return html`<div class="plot" role="img" aria-label=${props.label} ref=${host}></div>`;
}

/** @returns {any} uPlot's options; its types want more than it does */
function optionsOf(host, newest) {
  const colour = coloursOf(host);
  const axis = (more) => ({
    stroke: colour("--dim"),
    font: FONT,
    grid: { stroke: colour("--line"), width: 1 },
    ticks: { show: false },
    ...more,
  });
  const range = (name) => () => [newest.current[name].min ?? 0, newest.current[name].max];
  return {
    width: host.clientWidth || 300,
    height: HEIGHT,
    padding: [20, newest.current.room ?? 88, 0, 0],
    legend: { show: false },
    cursor: { show: false },
    select: { show: false },
    scales: { x: { time: false, range: range("x") }, y: { range: range("y") } },
    axes: [
      axis({
        size: 26, gap: 6, space: 56, grid: { show: false },
        label: newest.current.x.unit, labelSize: 18, labelFont: FONT, labelGap: 0,
      }),
      axis({ size: 44, gap: 8, space: 30, values: (_, splits) => splits.map((v) => `${v.toFixed(1)} m`) }),
    ],
    series: [
      {},
      ...newest.current.series.map(({ color, dash, width = 2.5, points }) => ({
        stroke: color.startsWith("--") ? colour(color) : color,
        width,
        dash,
        spanGaps: true,
        points: { show: Boolean(points), size: 6, fill: color, stroke: color },
      })),
    ],
    plugins: [lineLabels(() => newest.current.labels, () => newest.current.marks ?? [], colour)],
  };
}

/** A function that resolves custom properties, which a canvas does not. */
function coloursOf(host) {
  const probe = document.createElement("span");
  return (name) => {
    host.append(probe);
    probe.style.color = `var(${name})`;
    const found = getComputedStyle(probe).color;
    probe.remove();
    return found;
  };
}

const LINE_PX = 16;
const END_DOT_PX = 4;

/** The font at the canvas's resolution. */
const fontOf = (px, weight = 400) => `${weight} ${FONT.replace("12px", `${12 * px}px`)}`;

/**
 * @param labels returns [{text, color, x, y}] in the chart's units
 * @param marks returns [{x? or y?, color, ink?, text?, share?, dash?}]: straight lines across the chart;
 *   `share` of the width is where the caption of a horizontal one begins
 * @param resolve returns the colour of a custom property
 */
export function lineLabels(labels, marks, resolve) {
  const colourOf = (name) => (name.startsWith("--") ? resolve(name) : name);

  const drawMark = (u, mark) => {
    const { ctx } = u;
    const px = devicePixelRatio;
    ctx.save();
    ctx.strokeStyle = colourOf(mark.color);
    ctx.fillStyle = colourOf(mark.ink ?? mark.color);
    ctx.lineWidth = 1.5 * px;
    ctx.setLineDash((mark.dash ?? []).map((d) => d * px));
    ctx.beginPath();
    if (mark.x === undefined) drawHorizontal(u, mark, px);
    else drawVertical(u, mark, px);
    ctx.stroke();
    ctx.restore();
  };

  const drawLabels = (u) => {
    const { ctx, bbox } = u;
    const px = devicePixelRatio;
    const placed = labels()
      .map((label) => ({
        ...label,
        left: Math.min(u.valToPos(label.x, "x", true), bbox.left + bbox.width),
        top: u.valToPos(label.y, "y", true),
      }))
      .sort((a, b) => a.top - b.top);
    const tops = spread(placed.map(({ top }) => top), LINE_PX * px, bbox.top, bbox.top + bbox.height);
    ctx.save();
    ctx.font = fontOf(px, 600);
    ctx.textBaseline = "middle";
    ctx.textAlign = "left";
    placed.forEach(({ text, color, left, top }, n) => {
      ctx.fillStyle = colourOf(color);
      ctx.beginPath();
      ctx.arc(left, top, END_DOT_PX * px, 0, 2 * Math.PI);
      ctx.fill();
      // Not in the line's own colour: yellow on white cannot be read.
      ctx.fillStyle = colourOf("--ink");
      ctx.fillText(text, left + 9 * px, tops[n]);
    });
    ctx.restore();
  };

  return { hooks: { draw: [(u) => marks().forEach((mark) => drawMark(u, mark)), drawLabels] } };
}

function drawHorizontal(u, { y, text, share = 0 }, px) {
  const { ctx, bbox } = u;
  const at = u.valToPos(y, "y", true);
  ctx.moveTo(bbox.left, at);
  ctx.lineTo(bbox.left + bbox.width, at);
  if (!text) return;
  ctx.font = fontOf(px, 600);
  ctx.textAlign = "left";
  ctx.textBaseline = "bottom";
  ctx.fillText(text, bbox.left + share * bbox.width + 6 * px, at - 4 * px);
}

function drawVertical(u, { x, text }, px) {
  const { ctx, bbox } = u;
  const at = u.valToPos(x, "x", true);
  ctx.moveTo(at, bbox.top);
  ctx.lineTo(at, bbox.top + bbox.height);
  if (!text) return;
  const isFarRight = at > bbox.left + 0.6 * bbox.width;
  ctx.font = fontOf(px);
  ctx.textAlign = isFarRight ? "right" : "left";
  ctx.textBaseline = "bottom";
  ctx.fillText(text, at + (isFarRight ? 6 : -6) * px, bbox.top - 3 * px);
}

// ---- dots

const DOT_PX = 3;
const APART_PX = 5;
/** More cannot be told apart; an even selection stands for all. */
const MOST_DOTS = 600;
/** Height below the dots for the mean and its interval, where they hide none. */
const LANE_PX = 12;
/** Height of the axis' numbers, and about how many there are: strips may be narrow. */
const AXIS_PX = 14;
const AXIS_NUMBERS = 3;

/**
 * @param {object} props
 * @param {string} props.label the same in words
 * @param {number[]} props.points one per seed
 * @param {number} [props.low] where the axis begins
 * @param {number} props.high where the axis ends
 * @param {{ iqm: number, low?: number | null, high?: number | null } | null} [props.typical] interquartile
 *   mean and, if known, its interval
 * @param {{ value: number, kind: "greedy" | "half" | "published" }[]} [props.marks] lines; published is a diamond
 * @param {string} [props.color]
 * @param {number} [props.height] without the axis
 * @param {((value: number) => string) | null} [props.axis] a number of the axis in words; null: no axis
 */
export function DotStrip({
  label, points, low = 0, high, typical = null, marks = [], color, height = 36, axis = null,
}) {
  const at = (value) => percent(shareOf(value, low, high));
  const drawn = points.length > MOST_DOTS ? thinned([...points].sort((a, b) => a - b), MOST_DOTS) : points;
  const rows = swarm(drawn.map((value) => shareOf(value, low, high)));
  const tallest = largest(rows.map(Math.abs), 1);
  const middle = (height - LANE_PX) / 2;
  const apart = Math.min(APART_PX, (middle - DOT_PX) / tallest);
  const style = color && { "--agent": color };
  return html`
    <svg class="dots" width="100%" height=${height + (axis ? AXIS_PX : 0)} role="img" aria-label=${label}
      style=${style}>
      <line class="axis" x1="0" x2="100%" y1=${middle} y2=${middle} />
      ${marks.filter(({ kind }) => kind !== "published").map(({ value, kind }) => html`
        <line class=${`mark ${kind}`} x1=${at(value)} x2=${at(value)} y1="0" y2=${height} />
      `)}
      ${drawn.map((value, n) => html`
        <circle class="dot-of-seed" cx=${at(value)} cy=${middle + rows[n] * apart} r=${DOT_PX} />
      `)}
      ${typical && html`<${Typical} typical=${typical} at=${at} y=${height - LANE_PX / 2} />`}
      ${axis && ticks(high, AXIS_NUMBERS).map((value) => html`
        <line class="axis" x1=${at(value)} x2=${at(value)} y1=${height} y2=${height + 3} />
        <text class="axis-number" x=${at(value)} y=${height + AXIS_PX} text-anchor=${value ? "middle" : "start"}>
          ${axis(value)}
        </text>
      `)}
      ${marks.filter(({ kind }) => kind === "published").map(({ value }) => html`
        <svg x=${at(value)} y=${middle} overflow="visible"><path class="mark published" d="M0-7 6 0 0 7-6 0z" /></svg>
      `)}
    </svg>
  `;
}

const Typical = ({ typical, at, y }) => html`
  ${typical.low !== null && typical.low !== undefined && html`
    <line class="interval" x1=${at(typical.low)} x2=${at(typical.high)} y1=${y} y2=${y} />
  `}
  <line class="typical" x1=${at(typical.iqm)} x2=${at(typical.iqm)} y1=${y - 5} y2=${y + 5} />
`;

// ---- the numbers of a chart as a table, folded

const MOST_ROWS = 100;

export function AsTable({ caption, columns, rows }) {
  const [isOpen, setOpen] = useState(false);
  return html`
    <details class="as-table" onToggle=${({ target }) => setOpen(target.open)}>
      <summary>As a table</summary>
      ${isOpen && html`
        <div class="scroller" tabindex="0" role="region" aria-label=${caption}>
          <table>
            <caption class="sr-only">${caption}</caption>
            <thead><tr>${columns.map((title) => html`<th scope="col">${title}</th>`)}</tr></thead>
            <tbody>${thinned(rows, MOST_ROWS).map((cells) => html`<${Row} cells=${cells} />`)}</tbody>
          </table>
        </div>
      `}
    </details>
  `;
}

const Row = ({ cells: [first, ...others] }) => html`
  <tr><th scope="row">${first}</th>${others.map((one) => html`<td>${one}</td>`)}</tr>
`;

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

export const Empty = ({ words, shape = "curve" }) => html`
  <div class=${`empty ${shape}`}>
    ${SHAPES[shape]}
    <p>${words}</p>
  </div>
`;
