// The projector's dot plots: rows of dots over one axis, as large as their place.
import { useLayoutEffect, useRef, useState } from "preact/hooks";
import { html } from "../../../../js/components/elements.js";
import { plotAxis, stackedDots } from "./plot-geometry.js";

/** @import { PlotAxis } from "./plot-geometry.js" */

/** Of the axis' numbers, of a row's title, and of a dot at most, in the size of type. */
const [AXIS_EM, TITLE_EM, DOT_EM] = [1.7, 1.5, 0.7];

/** The size of an element, and of the type of the page [px]; 0 until it is drawn. */
export function useBox() {
  /** @type {{ current: any }} */
  const host = useRef(null);
  const [box, setBox] = useState({ width: 0, height: 0, em: 0 });
  useLayoutEffect(() => {
    const measure = () => {
      const { width, height } = host.current.getBoundingClientRect();
      const em = parseFloat(getComputedStyle(document.documentElement).fontSize);
      if (width > 0 && height > 0) setBox({ width: Math.round(width), height: Math.round(height), em });
    };
    measure();
    const watcher = new ResizeObserver(measure);
    watcher.observe(host.current);
    return () => watcher.disconnect();
  }, []);
  return /** @type {const} */ ([host, box]);
}

/**
 * A row of dots. `typical`: their interquartile mean with its interval.
 * @typedef {object} DotRow
 * @property {string} title
 * @property {"predicted" | "walked"} kind
 * @property {number[]} values
 * @property {{ iqm: number, low: number | null, high: number | null } | null} [typical]
 */

/**
 * Rows of dots over one axis, with the right answer as a line through all of them.
 * @param {object} props
 * @param {DotRow[]} props.rows
 * @param {(value: number) => string} props.format
 * @param {{ value: number, label: string } | null} [props.right]
 */
export function DotPlot({ rows, format, right = null }) {
  const [host, { width, height, em }] = useBox();
  const values = [...rows.flatMap((row) => row.values), ...(right ? [right.value] : [])];
  const axis = plotAxis(values.length ? values : [0, 1]);
  const top = right ? TITLE_EM * em : 0;
  const each = (height - top - AXIS_EM * em) / Math.max(1, rows.length);
  const words = rows.map((row) => `${row.title}: ${row.values.length}`).join(", ");
  return html`
    <div class="plot" ref=${host}>
      ${width > 0 && html`
        <svg width=${width} height=${height} role="img" aria-label=${right ? `${words}; ${right.label}` : words}>
          ${rows.map((row, n) => html`
            <${Row} key=${row.kind} row=${row} axis=${axis} em=${em} width=${width} top=${top + n * each}
              height=${each} />
          `)}
          ${right && html`<${Right} x=${axis.at(right.value) * width} words=${right.label} width=${width} em=${em}
            bottom=${height - AXIS_EM * em} />`}
          <${AxisNumbers} axis=${axis} format=${format} width=${width} y=${height - AXIS_EM * em} em=${em} />
        </svg>
        ${rows.map(({ title, kind }, n) => html`
          <p class="plot-title" key=${kind} style=${{ top: `${top + n * each}px` }}>${title}</p>
        `)}
      `}
    </div>
  `;
}

/**
 * @param {object} props
 * @param {DotRow} props.row
 * @param {PlotAxis} props.axis
 * @param {number} props.em
 * @param {number} props.width
 * @param {number} props.top
 * @param {number} props.height
 */
function Row({ row: { kind, values, typical = null }, axis, em, width, top, height }) {
  const base = top + height - 0.3 * em;
  const room = height - TITLE_EM * em - 0.5 * em;
  const { radius, dots } = stackedDots(values.map(axis.at), width, room, DOT_EM * em);
  const x = (/** @type {number} */ value) => axis.at(value) * width;
  return html`
    <g class=${`plot-row ${kind}`}>
      ${typical && typical.low !== null && typical.high !== null && html`
        <rect class="plot-interval" x=${x(typical.low)} width=${Math.max(2, x(typical.high) - x(typical.low))}
          y=${base - room} height=${room} />
      `}
      <line class="plot-base" x1="0" x2=${width} y1=${base} y2=${base} />
      ${dots.map((dot) => html`<circle cx=${dot.x} cy=${base - dot.y} r=${radius} />`)}
      ${typical && html`
        <line class="plot-typical" x1=${x(typical.iqm)} x2=${x(typical.iqm)} y1=${base - room} y2=${base} />
      `}
    </g>
  `;
}

/** @param {{ x: number, words: string, width: number, em: number, bottom: number }} props */
const Right = ({ x, words, width, em, bottom }) => html`
  <g class="plot-right">
    <line x1=${x} x2=${x} y1=${1.3 * em} y2=${bottom} />
    <text x=${x} y=${em} text-anchor=${anchorAt(x, width, words.length * 0.3 * em)}>${words}</text>
  </g>
`;

/** Where a text begins, so that it is not cut off. @param {number} x @param {number} width @param {number} half */
const anchorAt = (x, width, half) => (x < half ? "start" : x > width - half ? "end" : "middle");

/** @param {{ axis: PlotAxis, format: (value: number) => string, width: number, y: number, em: number }} props */
export const AxisNumbers = ({ axis, format, width, y, em }) => html`
  <g class="plot-axis">
    ${axis.marks.map((mark) => html`
      <line x1=${axis.at(mark) * width} x2=${axis.at(mark) * width} y1=${y} y2=${y + 0.25 * em} />
      <text x=${axis.at(mark) * width} y=${y + 1.3 * em}
        text-anchor=${anchorAt(axis.at(mark) * width, width, format(mark).length * 0.3 * em)}>${format(mark)}</text>
    `)}
  </g>
`;
