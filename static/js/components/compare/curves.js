// The learning curves of compared runs in one chart.
import { comparedCurves } from "../../compare.js";
import { count, listed, metres, whole } from "../../format.js";
import { largest } from "../../scale.js";
import { Chart } from "../charts.js";
import { html } from "../elements.js";


/** @typedef {typeof comparedCurves.value} Comparison */

const MIN_TOP_M = 0.1;
const HEADROOM = 1.16;

export function Curves() {
  const { shown, without } = comparedCurves.value;
  return html`
    <section class="panel chart" aria-labelledby="compare-curves">
      <h2 id="compare-curves">Learning</h2>
      <p class="dim">Distance in 50 steps, after so many steps of practice</p>
      ${shown.length > 0 && html`<${CurvesChart} shown=${shown} />`}
      ${without.map((words) => html`<p class="dim">${words}</p>`)}
    </section>
  `;
}

/** @param {Comparison["shown"][number]["curve"]} curve */
const lastOf = ({ points }) => points[points.length - 1];

/** @param {{ shown: Comparison["shown"] }} props */
function CurvesChart({ shown }) {
  const lines = shown.map(({ one, curve }) => ({
    name: `${one.letter}: ${one.title}`, color: one.color, dash: one.dash, xs: curve.points.map(({ step }) => step),
    ys: curve.points.map(({ distance_m }) => distance_m),
    end: `${one.letter} ${metres(lastOf(curve).distance_m)}`,
  }));
  const distances = lines.flatMap(({ ys }) => ys);
  const xs = [...new Set(lines.flatMap((line) => line.xs))].sort((a, b) => a - b);
  const ends = shown.map(({ one, curve }) =>
    `${one.letter} ${metres(lastOf(curve).distance_m)} after ${whole(lastOf(curve).step)}`);
  const x = {
    axis: `practice of ${shown.map(({ one }) => one.id).join(" ")}`,
    max: Math.max(...shown.map(({ curve }) => curve.to)), unit: "steps of practice",
    text: (/** @type {number} */ step) => count(step, "step"),
  };
  const y = {
    min: -largest(distances.map((one) => -one), 0), max: HEADROOM * largest(distances, MIN_TOP_M),
    unit: "m", text: metres,
  };
  return html`
    <${Chart} name="the learning curves" label=${`Learning curves: ${listed(ends)} steps.`} x=${x} y=${y} lines=${lines}
      xs=${xs} />
  `;
}
