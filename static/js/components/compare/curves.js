// The learning curves of several runs in one chart.
import { comparedCurves } from "../../compare.js";
import { count, listed, metres, whole } from "../../format.js";
import { largest } from "../../scale.js";
import { Chart } from "../charts.js";
import { html } from "../elements.js";

/** @import { curveOf } from "../../training.js" */

/**
 * A curve, and how it is drawn: `name` in the readings, `label` at its end.
 * @typedef {object} NamedCurve
 * @property {string} id
 * @property {string} name
 * @property {string} label
 * @property {string} color
 * @property {number[]} [dash]
 * @property {ReturnType<typeof curveOf>} curve
 */

const MIN_TOP_M = 0.1;
const HEADROOM = 1.16;

export function Curves() {
  const { shown, without } = comparedCurves.value;
  const curves = shown.map(({ one: { id, letter, title, color, dash }, curve }) =>
    ({ id, name: `${letter}: ${title}`, label: `${letter} ${metres(lastOf(curve).distance_m)}`, color, dash, curve }));
  return html`
    <section class="panel chart" aria-labelledby="compare-curves">
      <h2 id="compare-curves">Learning</h2>
      <p class="dim">Distance in 50 steps, after so many steps of practice</p>
      ${curves.length > 0 && html`<${CurvesChart} curves=${curves} />`}
      ${without.map((words) => html`<p class="dim">${words}</p>`)}
    </section>
  `;
}

/** @param {NamedCurve["curve"]} curve */
const lastOf = ({ points }) => points[points.length - 1];

/**
 * `greedy`: greedy's distance, where it is the same for all [m].
 * @param {{ curves: NamedCurve[], greedy?: number | null }} props
 */
export function CurvesChart({ curves, greedy = null }) {
  const lines = curves.map(({ name, label, color, dash, curve: { points } }) => ({
    name, color, dash, end: label, xs: points.map(({ step }) => step), ys: points.map(({ distance_m }) => distance_m),
  }));
  const distances = lines.flatMap(({ ys }) => ys);
  const xs = [...new Set(lines.flatMap((line) => line.xs))].sort((a, b) => a - b);
  const ends = curves.map(({ name, curve }) =>
    `${name} ${metres(lastOf(curve).distance_m)} after ${whole(lastOf(curve).step)}`);
  const x = {
    axis: `practice of ${curves.map(({ id }) => id).join(" ")}`,
    max: Math.max(...curves.map(({ curve }) => curve.to)), unit: "steps of practice",
    text: (/** @type {number} */ step) => count(step, "step"),
  };
  const y = {
    min: -largest(distances.map((distance) => -distance), 0),
    max: HEADROOM * largest([...distances, greedy ?? 0], MIN_TOP_M),
    unit: "m", text: metres, title: "distance in 50 steps, m",
  };
  const marks = greedy === null ? [] : [{ y: greedy, name: "Greedy", kind: "greedy", ink: "--dim", text: "Greedy" }];
  return html`
    <${Chart} name="the learning curves" label=${`Learning curves: ${listed(ends)} steps.`} x=${x} y=${y} lines=${lines}
      xs=${xs} marks=${marks} />
  `;
}
