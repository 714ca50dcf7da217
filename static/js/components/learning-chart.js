// How far the learner gets in 50 steps, after so much practice, against greedy: the line to beat.
import { useMemo } from "preact/hooks";
import { curve } from "../curves.js";
import { metres, whole } from "../format.js";
import { html } from "../html.js";
import { agentOf } from "../selectors.js";
import { AsTable } from "./as-table.js";
import { Empty } from "./empty.js";
import { Plot } from "./plot.js";

export function LearningChart() {
  const known = curve.value;
  return html`
    <section class="panel chart" aria-labelledby="learning-title">
      <h2 id="learning-title">Learning</h2>
      <p class="dim">How far it gets in 50 steps, after so much practice</p>
      ${known
        ? html`<${Curve} known=${known} />`
        : html`<${Empty} words="Each time the learner is tried out, a point appears here, on its way to greedy’s line." />`}
    </section>
  `;
}

function Curve({ known }) {
  const { points, to, greedy_m, blocks, run } = known;
  const { color } = agentOf(run.config.agent ?? "q-learning");
  const last = points.at(-1);
  const data = useMemo(() => [points.map((p) => p.step), points.map((p) => p.distance_m)], [points]);
  const labels = [];
  if (points.length > 1) labels.push({ text: metres(last.distance_m), color, x: last.step, y: last.distance_m });
  const top = Math.max(0.5, greedy_m ?? 0, ...points.map((p) => p.distance_m)) * 1.16;
  const low = Math.min(0, ...points.map((p) => p.distance_m));
  const marks = [
    ...(greedy_m ? [{ y: greedy_m, color: "--greedy", ink: "--dim", dash: [5, 5], text: `greedy, the line to beat: ${metres(greedy_m)}` }] : []),
    ...blocks.map((x) => ({ x, color: "--line" })),
  ];
  const said = points.length > 1
    ? `Learning curve: ${metres(last.distance_m)} after ${whole(last.step)} steps${greedy_m ? `; greedy gets ${metres(greedy_m)}` : ""}.`
    : "Learning curve, without points so far.";
  return html`
    <${Plot} label=${said} data=${data} series=${[{ color, points: points.length < 45 }]} marks=${marks} labels=${labels} room=${64}
      x=${{ min: 0, max: to, unit: "steps of practice" }} y=${{ min: low, max: top }} />
    <${AsTable} caption=${said} columns=${["Steps of practice", "Distance in 50 steps"]}
      rows=${points.map((p) => [whole(p.step), metres(p.distance_m)])} />
  `;
}
