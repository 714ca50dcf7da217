// Distance against steps: interquartile means with their intervals, single seeds, and the lines of references.
import { useLayoutEffect, useRef, useState } from "preact/hooks";
import { shown } from "../../experiments/distances.js";
import { count, whole } from "../../format.js";
import { thinned, ticks } from "../../scale.js";
import { agentOf } from "../../settings.js";
import { AsTable, Crosshair } from "../charts.js";
import { html } from "../elements.js";

/**
 * An agent's distances at some steps, in the unit that is shown.
 * @typedef {object} BandCurve
 * @property {string} key
 * @property {string} name
 * @property {string} agent
 * @property {number[]} steps
 * @property {number[]} iqm
 * @property {(number | null)[]} low
 * @property {(number | null)[]} high
 * @property {number[][]} points of every seed, by step; may be empty
 */

/**
 * A reference's distance: a line of a kind that the style sheet has. Several are told apart by a key over the chart.
 * @typedef {{ value: number, kind: string, name: string, color?: string }} Level
 */

const HEIGHT = 208;
/** More lines behind the band cannot be told apart. */
const MOST_SEEDS = 200;
const ROOM = { left: 52, right: 10, top: 20, bottom: 34 };
/** Narrower charts have fewer ticks. */
const WIDE_PX = 300;

/**
 * @param {object} props
 * @param {string} props.label the same in words
 * @param {BandCurve[]} props.curves
 * @param {Level[]} props.levels
 * @param {number} props.high where the axis ends
 * @param {string} [props.unit] of the steps
 */
export function BandChart({ label, curves, levels, high, unit = "steps of practice" }) {
  const [host, width] = useWidth();
  return html`
    <div class="band-chart" ref=${host}>
      ${width > 0 && html`
        <${Chart} label=${label} curves=${curves} levels=${levels} high=${high} width=${width} unit=${unit} />
        <${Values} label=${label} curves=${curves} levels=${levels} />
      `}
    </div>
  `;
}

/**
 * The numbers of the curves, folded.
 * @param {object} props
 * @param {string} props.label
 * @param {BandCurve[]} props.curves at the same steps
 * @param {Level[]} props.levels
 * @param {string} [props.alone] what a single curve is called
 */
export function CurveTable({ label, curves, levels, alone }) {
  const titles = curves.length === 1 && alone !== undefined ? [alone] : curves.map(({ name }) => name);
  return html`
    <${AsTable} caption=${label} rows=${rowsOf(curves, levels)}
      columns=${["Steps", ...titles.flatMap((title) => [title, "95 %"]), ...levels.map(({ name }) => name)]} />
  `;
}

const rowsOf = (curves, levels) =>
  curves[0].steps.map((steps, block) => [
    whole(steps),
    ...curves.flatMap((one) => [shown(one.iqm[block]), intervalOf(one, block)]),
    ...levels.map(({ value }) => shown(value)),
  ]);

const intervalOf = ({ low, high }, block) =>
  low[block] === null ? "–" : `${shown(low[block])} – ${shown(high[block])}`;

/** Typical distances with their intervals at the crosshair. */
function Values({ label, curves, levels }) {
  const xs = [...new Set(curves.flatMap(({ steps }) => steps))].sort((a, b) => a - b);
  const read = (index) => ({
    at: count(xs[index], "step"),
    values: [
      ...curves.map((one) => ({
        name: one.name, color: agentOf(one.agent).color, value: typicalAt(one, one.steps.indexOf(xs[index])),
      })),
      ...levels.map(({ name, color, value }) => ({ name, color, value: shown(value) })),
    ],
  });
  return html`
    <${Crosshair} label=${`Values of ${label.split(":")[0]}`} xs=${xs} low=${0} high=${Math.max(...xs)} inset=${ROOM}
      read=${read} />
  `;
}

const typicalAt = (one, block) => {
  if (block < 0) return "–";
  return one.low[block] === null ? shown(one.iqm[block]) : `${shown(one.iqm[block])} (${intervalOf(one, block)})`;
};

function Chart({ label, curves, levels, high, width, unit }) {
  const longest = Math.max(1, ...curves.flatMap(({ steps }) => steps));
  const bottom = HEIGHT - ROOM.bottom;
  const right = width - ROOM.right;
  const x = (steps) => ROOM.left + ((right - ROOM.left) * steps) / longest;
  const y = (value) => bottom - ((bottom - ROOM.top) * Math.max(value, 0)) / high;
  return html`
    <svg width=${width} height=${HEIGHT} role="img" aria-label=${label}>
      ${ticks(high, 4).map((value) => html`
        <line class="rule" x1=${ROOM.left} x2=${right} y1=${y(value)} y2=${y(value)} />
        <text x=${ROOM.left - 6} y=${y(value) + 4} text-anchor="end">${shown(value)}</text>
      `)}
      ${ticks(longest, width > WIDE_PX ? 4 : 2).map((steps) => html`
        <text x=${x(steps)} y=${bottom + 16} text-anchor=${steps === longest ? "end" : "middle"}>${whole(steps)}</text>
      `)}
      <text x=${right} y=${HEIGHT - 3} text-anchor="end">${unit}</text>
      ${curves.map((one) => html`<${Curve} key=${one.key} one=${one} x=${x} y=${y} />`)}
      ${levels.map(({ kind, value }) => html`
        <line class=${`mark ${kind}`} x1=${ROOM.left} x2=${right} y1=${y(value)} y2=${y(value)} />
      `)}
      ${levels.length === 1 && html`
        <text class="on-line" x=${ROOM.left + 4} y=${y(levels[0].value) - 5}>${levels[0].name.toLowerCase()}</text>
      `}
    </svg>
  `;
}

function Curve({ one: { agent, steps, iqm, low, high, points }, x, y }) {
  const pointsAt = (values) => values.map((value, n) => `${x(steps[n]).toFixed(1)} ${y(value).toFixed(1)}`);
  const path = (values) => `M${pointsAt(values).join("L")}`;
  const seeds = (points[0] ?? []).map((_, seed) => points.map((block) => block[seed]));
  const hasBand = low.every((value) => value !== null);
  return html`
    <g style=${{ "--agent": agentOf(agent).color }}>
      ${thinned(seeds, MOST_SEEDS).map((values) => html`<path class="seed-line" d=${path(values)} />`)}
      ${hasBand && html`<path class="band" d=${`${path(low)}L${pointsAt(high).reverse().join("L")}Z`} />`}
      <path class="typical-line" d=${path(iqm)} />
      ${iqm.map((value, n) => html`<circle class="typical-dot" cx=${x(steps[n])} cy=${y(value)} r="3" />`)}
    </g>
  `;
}

/** [ref, width in px], 0 until it is measured. @returns {[{ current: any }, number]} */
function useWidth() {
  /** @type {{ current: any }} */
  const host = useRef(null);
  const [width, setWidth] = useState(0);
  useLayoutEffect(() => {
    const watcher = new ResizeObserver(([{ contentRect }]) => setWidth(Math.round(contentRect.width)));
    watcher.observe(host.current);
    return () => watcher.disconnect();
  }, []);
  return [host, width];
}
