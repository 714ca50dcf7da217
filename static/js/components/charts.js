// Charts: lines drawn by uPlot with a crosshair, dots on one axis, their numbers as a table, and the placeholder
// without data.
import { useEffect, useLayoutEffect, useRef, useState } from "preact/hooks";
import uPlot from "uplot";
import { metres, whole } from "../format.js";
import { shownTheme } from "../page.js";
import { largest, percent, shareOf, swarm, thinned, ticks } from "../scale.js";
import { html } from "./elements.js";
import { FONT, lineLabels, roomFor } from "./line-labels.js";

/** @import { EndLabel, Mark } from "./line-labels.js" */

// ---- lines

const HEIGHT = 216;
const X_AXIS = { size: 26, labelSize: 18 };
const Y_AXIS_PX = 44;
const TOP_PX = 20;
/** Of the plotting area in the chart, without the right side. */
const INSET = { left: Y_AXIS_PX, top: TOP_PX, bottom: X_AXIS.size + X_AXIS.labelSize };

/**
 * A uPlot chart that is redrawn when its size, the theme or its data change.
 * @param {object} props
 * @param {string} props.label what the chart shows, in a sentence
 * @param {uPlot.AlignedData} props.data [xs, ys…]
 * @param {{ color: string, dash?: number[], width?: number, points?: boolean }[]} props.series one per line
 * @param {{ min?: number, max: number, unit: string }} props.x
 * @param {{ min?: number, max: number }} props.y
 * @param {EndLabel[]} props.labels at the ends of lines
 * @param {Mark[]} [props.marks] straight lines
 * @param {{ label: string, xs: number[], read: (index: number) => any }} props.values as a `Crosshair` takes them
 */
export function Plot(props) {
  /** @type {{ current: any }} */
  const host = useRef(null);
  /** @type {{ current: any }} */
  const plot = useRef(null);
  const newest = useRef(props);
  newest.current = props;
  const room = roomFor(props.labels);
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
  // New data alone would not measure the padding again.
  useEffect(() => plot.current.redraw(true, true), [room]);

  return html`
    <div class="plot-frame">
      <div class="plot" role="img" aria-label=${props.label} ref=${host}></div>
      <${Crosshair} ...${props.values} low=${props.x.min ?? 0} high=${props.x.max} inset=${{ ...INSET, right: room }} />
    </div>
  `;
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
    padding: [TOP_PX, () => roomFor(newest.current.labels), 0, 0],
    legend: { show: false },
    cursor: { show: false },
    select: { show: false },
    scales: { x: { time: false, range: range("x") }, y: { range: range("y") } },
    axes: [
      axis({
        ...X_AXIS, gap: 6, space: 56, grid: { show: false }, values: (_, splits) => splits.map(tickText),
        label: newest.current.x.unit, labelFont: FONT, labelGap: 0,
      }),
      axis({ size: Y_AXIS_PX, gap: 8, space: 30, values: (_, splits) => splits.map((v) => `${v.toFixed(1)} m`) }),
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

/** @type {(value: number) => string} */
const tickText = (value) => (Number.isInteger(value) ? whole(value) : String(Number(value.toFixed(3))));

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

/** The line of the best known walk, thin; its caption stands where those of other lines do not begin. */
export const bestKnownMark = (y) => ({
  y, color: "--ink", ink: "--dim", width: 0.75, share: 0.62, text: `best known: ${metres(y)}`,
});

/** What the thin line is, where its caption has no room. */
export const BestKnownKey = ({ distance }) => html`
  <p class="line-key dim">
    <i class="thin-line" aria-hidden="true"></i>
    ${" "}Best known: ${metres(distance)}, found by a wide search
  </p>
`;

// ---- the values at a crosshair, which follows the pointer, a finger, or the arrow keys

/** A line's value at the crosshair. @typedef {{ name: string, color?: string, value: string }} ReadValue */

const PAGE_KEY_STEP = 10;
/** From this share of the width on, the values stand on the left of the crosshair. */
const FLIP_SHARE = 0.5;

/** @type {Record<string, (at: number, last: number) => number>} */
const KEYS = {
  ArrowLeft: (at) => at - 1,
  ArrowRight: (at) => at + 1,
  ArrowDown: (at) => at - 1,
  ArrowUp: (at) => at + 1,
  PageDown: (at) => at - PAGE_KEY_STEP,
  PageUp: (at) => at + PAGE_KEY_STEP,
  Home: () => 0,
  End: (_, last) => last,
};

/**
 * The index of the nearest of ascending positions.
 * @param {number[]} xs
 * @param {number} x
 */
export const nearestIndex = (xs, x) =>
  xs.reduce((best, one, n) => (Math.abs(one - x) < Math.abs(xs[best] - x) ? n : best), 0);

/**
 * Covers the plotting area of a chart whose frame is positioned.
 * @param {object} props
 * @param {string} props.label
 * @param {number[]} props.xs where there are values, ascending
 * @param {number} props.low where the axis begins
 * @param {number} props.high where it ends
 * @param {{ left: number, right: number, top: number, bottom: number }} props.inset of the area in the frame [px]
 * @param {(index: number) => { at: string, values: ReadValue[] }} props.read
 */
export function Crosshair({ label, xs, low, high, inset, read }) {
  const [chosen, setChosen] = useState(/** @type {number | null} */ (null));
  const last = xs.length - 1;
  if (last < 0) return null;
  const index = Math.min(chosen ?? last, last);
  const { at, values } = read(index);

  const onPointer = ({ clientX, currentTarget }) => {
    const { left, width } = currentTarget.getBoundingClientRect();
    if (width > 0) setChosen(nearestIndex(xs, low + ((high - low) * (clientX - left)) / width));
  };
  const onLeave = ({ pointerType, currentTarget }) => {
    // A finger that is lifted leaves the values until something else is touched.
    if (pointerType === "mouse" && document.activeElement !== currentTarget) setChosen(null);
  };
  const onKeyDown = (event) => {
    if (event.key === "Escape") setChosen(null);
    const move = KEYS[event.key];
    if (!move || event.ctrlKey || event.altKey || event.metaKey) return;
    event.preventDefault();
    setChosen(Math.max(0, Math.min(move(index, last), last)));
  };

  const share = shareOf(xs[index], low, high);
  const style = Object.fromEntries(Object.entries(inset).map(([side, px]) => [side, `${px}px`]));
  const words = `${at}: ${values.map(({ name, value }) => `${name} ${value}`).join(", ")}`;
  return html`
    <div class="crosshair" style=${style} tabindex="0" role="slider" aria-label=${label}
      aria-valuemin="0" aria-valuemax=${last} aria-valuenow=${index} aria-valuetext=${words}
      onPointerMove=${onPointer} onPointerDown=${onPointer} onPointerLeave=${onLeave} onKeyDown=${onKeyDown}
      onFocus=${() => setChosen((now) => now ?? last)} onBlur=${() => setChosen(null)}>
      ${chosen !== null && html`
        <i style=${{ left: percent(share) }}></i>
        <${Readout} at=${at} values=${values} share=${share} />
      `}
    </div>
  `;
}

function Readout({ at, values, share }) {
  // Beside the crosshair, on the side with more room and no wider than that.
  const side = share < FLIP_SHARE
    ? { left: percent(share), maxWidth: percent(1 - share) }
    : { right: percent(1 - share), maxWidth: percent(share) };
  return html`
    <div class="readout num" style=${side} aria-hidden="true">
      <p class="dim">${at}</p>
      ${values.map(({ name, color, value }) => html`
        <p>${color && html`<span class="swatch" style=${{ "--agent": color }}></span>`}${name} <b>${value}</b></p>
      `)}
    </div>
  `;
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
 * Every seed as a dot on one axis, with the interquartile mean and reference values.
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
 * @param {((n: number) => unknown) | null} [props.onDot] called with the number of a point whose dot is clicked
 */
export function DotStrip({
  label, points, low = 0, high, typical = null, marks = [], color, height = 36, axis = null, onDot = null,
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
        <circle class=${`dot-of-seed ${onDot ? "to-seed" : ""}`} cx=${at(value)} cy=${middle + rows[n] * apart}
          r=${DOT_PX} onClick=${onDot && (() => onDot(points.indexOf(value)))} />
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
