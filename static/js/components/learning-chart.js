// The learning curve: distance in an evaluation against steps of practice, with greedy's distance.
import { useMemo } from "preact/hooks";
import { agentOf } from "../agents.js";
import { curve } from "../curves.js";
import { metres, whole } from "../format.js";
import { html } from "../html.js";
import { served } from "../store.js";
import { AsTable } from "./as-table.js";
import { Empty } from "./empty.js";
import { Plot } from "./plot.js";

/** With more, single points are not marked. */
const MOST_MARKED_POINTS = 45;
/** The axis reaches at least so far [m]. */
const LEAST_TOP_M = 0.5;
const HEADROOM = 1.16;

const INVITATION = "Each evaluation adds a point here, on its way to greedy’s line.";

export function LearningChart() {
  const known = curve.value;
  return html`
    <section class="panel chart" aria-labelledby="learning-title">
      <h2 id="learning-title">Learning</h2>
      <p class="dim">Distance in 50 steps, after so many steps of practice</p>
      ${known ? html`<${Curve} known=${known} />` : html`<${Empty} words=${INVITATION} />`}
    </section>
  `;
}

/** Thin lines: greedy's distance, and where one training continued another. */
const marksOf = ({ greedy_m, blocks }) => [
  ...(greedy_m ? [greedyMark(greedy_m)] : []),
  ...blocks.map((x) => ({ x, color: "--line" })),
];

const greedyMark = (y) => ({
  y, color: agentOf("greedy").color, ink: "--dim", dash: [5, 5], text: `greedy, the line to beat: ${metres(y)}`,
});

function captionOf({ points, greedy_m }) {
  if (points.length < 2) return "Learning curve, without points so far.";
  const last = points.at(-1);
  const greedy = greedy_m ? `; greedy gets ${metres(greedy_m)}` : "";
  return `Learning curve: ${metres(last.distance_m)} after ${whole(last.step)} steps${greedy}.`;
}

function Curve({ known }) {
  const { points, to, greedy_m, run } = known;
  const { color } = agentOf(run.config.agent ?? served().defaults.training.agent);
  const last = points.at(-1);
  const data = useMemo(() => [points.map((p) => p.step), points.map((p) => p.distance_m)], [points]);
  const end = { text: metres(last.distance_m), color, x: last.step, y: last.distance_m };
  const distances = points.map((p) => p.distance_m);
  const caption = captionOf(known);
  return html`
    <${Plot} label=${caption} data=${data} marks=${marksOf(known)} labels=${points.length > 1 ? [end] : []} room=${64}
      series=${[{ color, points: points.length < MOST_MARKED_POINTS }]}
      x=${{ min: 0, max: to, unit: "steps of practice" }}
      y=${{ min: Math.min(0, ...distances), max: HEADROOM * Math.max(LEAST_TOP_M, greedy_m ?? 0, ...distances) }} />
    <${AsTable} caption=${caption} columns=${["Steps of practice", "Distance in 50 steps"]}
      rows=${points.map((p) => [whole(p.step), metres(p.distance_m)])} />
  `;
}
