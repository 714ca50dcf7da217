// Every seed as a dot on one axis, with the interquartile mean and reference values.
import { largest, percent, shareOf, swarm, thinned, ticks } from "../scale.js";
import { html, useWidth } from "./elements.js";
import { placeCaptions, widthOf } from "./line-labels.js";

const DOT_PX = 3;
const APART_PX = 5;
/** More cannot be told apart; an even selection stands for all. */
const MAX_DOTS = 600;
/** Height below the dots for the mean and its interval, where they hide none. */
const LANE_PX = 12;
/** Height of the axis' numbers, and about how many there are: strips may be narrow. */
const AXIS_PX = 14;
const AXIS_NUMBERS = 3;
const NUMBER_GAP_PX = 6;

/**
 * Every seed as a dot on one axis, with the interquartile mean and reference values.
 * @param {object} props
 * @param {string} props.label the same in words
 * @param {number[]} props.points one per seed
 * @param {number} [props.low] where the axis begins
 * @param {number} props.high where the axis ends
 * @param {{ iqm: number, low?: number | null, high?: number | null } | null} [props.typical] interquartile
 *   mean and, if known, its interval
 * @param {{ value: number, kind: "greedy" | "best-known" | "half" | "published" }[]} [props.marks] lines; a diamond
 *   where published
 * @param {string} [props.color]
 * @param {number} [props.height] without the axis
 * @param {((value: number) => string) | null} [props.axis] a number of the axis in words; null: no axis
 * @param {((n: number) => unknown) | null} [props.onDot] called with the number of a point whose dot is clicked
 * @param {number} [props.size] of dots, lines and the axis, 1 for a strip in a panel
 * @param {number | null} [props.own] a value that is marked as one's own
 */
export function DotStrip({
  label, points, low = 0, high, typical = null, marks = [], color, height: plain = 36, axis = null, onDot = null,
  size = 1, own = null,
}) {
  const [host, width] = useWidth();
  /** @param {number} value */
  const at = (value) => percent(shareOf(value, low, high));
  const drawn = points.length > MAX_DOTS ? thinned([...points].sort((a, b) => a - b), MAX_DOTS) : points;
  const rows = swarm(drawn.map((value) => shareOf(value, low, high)));
  const tallest = largest(rows.map(Math.abs), 1);
  const height = plain * size;
  const middle = (height - LANE_PX * size) / 2;
  const apart = Math.min(APART_PX * size, (middle - DOT_PX * size) / tallest);
  const style = color && { "--agent": color };
  return html`
    <svg class="dots" width="100%" height=${height + (axis ? AXIS_PX * size : 0)} role="img" aria-label=${label}
      style=${style} ref=${host}>
      <line class="axis" x1="0" x2="100%" y1=${middle} y2=${middle} />
      ${marks.filter(({ kind }) => kind !== "published").map(({ value, kind }) => html`
        <line class=${`mark ${kind}`} x1=${at(value)} x2=${at(value)} y1="0" y2=${height} />
      `)}
      ${drawn.map((value, n) => html`
        <circle class=${`dot-of-seed ${onDot ? "to-seed" : ""}`} cx=${at(value)} cy=${middle + rows[n] * apart}
          r=${DOT_PX * size} onClick=${onDot && (() => onDot(points.indexOf(value)))} />
      `)}
      ${own !== null && html`<circle class="own-dot" cx=${at(own)} cy=${middle} r=${DOT_PX * size * 1.8} />`}
      ${typical && html`<${Typical} typical=${typical} at=${at} y=${height - (LANE_PX * size) / 2} size=${size} />`}
      ${axis && html`<${Axis} low=${low} high=${high} axis=${axis} at=${at} width=${width} y=${height} size=${size} />`}
      ${marks.filter(({ kind }) => kind === "published").map(({ value }) => html`
        <svg x=${at(value)} y=${middle} overflow="visible"><path class="mark published" d="M0-7 6 0 0 7-6 0z" /></svg>
      `)}
    </svg>
  `;
}

/**
 * Round numbers, of which a narrow strip has room for fewer.
 * @param {object} props
 * @param {number} props.low
 * @param {number} props.high
 * @param {(value: number) => string} props.axis
 * @param {(value: number) => string} props.at
 * @param {number} props.width
 * @param {number} props.y
 * @param {number} props.size
 */
function Axis({ low, high, axis, at, width, y, size }) {
  const values = ticks(high, AXIS_NUMBERS, low);
  const boxes = values.map((value) => {
    const room = size * (widthOf(axis(value)) + NUMBER_GAP_PX);
    const middle = shareOf(value, low, high) * width;
    return { left: value === low ? 0 : middle - room / 2, top: 0, width: room, height: AXIS_PX };
  });
  const placed = placeCaptions(boxes, { left: 0, top: 0, width: Math.max(width, 1e4), height: AXIS_PX });
  return values.map((value, n) => html`
    <line class="axis" x1=${at(value)} x2=${at(value)} y1=${y} y2=${y + 3} />
    ${width > 0 && placed[n] && html`
      <text class="axis-number" x=${at(value)} y=${y + AXIS_PX * size}
        text-anchor=${value === low ? "start" : "middle"}>
        ${axis(value)}
      </text>
    `}
  `);
}

/**
 * @param {object} props
 * @param {{ iqm: number, low?: number | null, high?: number | null }} props.typical
 * @param {(value: number) => string} props.at
 * @param {number} props.y
 * @param {number} props.size
 */
const Typical = ({ typical, at, y, size }) => html`
  ${typical.low !== null && typical.low !== undefined && html`
    <line class="interval" x1=${at(typical.low)} x2=${at(typical.high ?? NaN)} y1=${y} y2=${y} />
  `}
  <line class="typical" x1=${at(typical.iqm)} x2=${at(typical.iqm)} y1=${y - 5 * size} y2=${y + 5 * size} />
`;
