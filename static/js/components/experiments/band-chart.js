// Curves of interquartile means with their intervals, every seed behind them, and greedy's line.
import { agentOf } from "../../agents.js";
import { whole } from "../../format.js";
import { html } from "../../html.js";
import { thinned, ticks } from "../../scale.js";
import { shown } from "../../experiments/units.js";
import { useWidth } from "../use-width.js";

const HEIGHT = 208;
/** More lines behind the band cannot be told apart. */
const MOST_SEEDS = 200;
const ROOM = { left: 52, right: 10, top: 20, bottom: 34 };
/** Narrower charts have fewer ticks. */
const WIDE_PX = 300;

/** `curves`: [{agent, steps, iqm, low, high, points}], numbers in the unit that is shown. */
export function BandChart({ label, curves, greedy, high }) {
  const [host, width] = useWidth();
  return html`
    <div class="band-chart" ref=${host}>
      ${width > 0 && html`<${Chart} label=${label} curves=${curves} greedy=${greedy} high=${high} width=${width} />`}
    </div>
  `;
}

function Chart({ label, curves, greedy, high, width }) {
  const longest = Math.max(...curves.flatMap(({ steps }) => steps));
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
      <text x=${right} y=${HEIGHT - 3} text-anchor="end">steps of practice</text>
      ${curves.map((one) => html`<${Curve} key=${one.agent} one=${one} x=${x} y=${y} />`)}
      ${greedy !== null && html`
        <line class="mark greedy" x1=${ROOM.left} x2=${right} y1=${y(greedy)} y2=${y(greedy)} />
        <text class="on-line" x=${ROOM.left + 4} y=${y(greedy) - 5}>greedy</text>
      `}
    </svg>
  `;
}

function Curve({ one: { agent, steps, iqm, low, high, points }, x, y }) {
  const pointsAt = (values) => values.map((value, n) => `${x(steps[n]).toFixed(1)} ${y(value).toFixed(1)}`);
  const path = (values) => `M${pointsAt(values).join("L")}`;
  const seeds = points[0].map((_, seed) => points.map((block) => block[seed]));
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
