// The learning curve of the learner in view: distance in an evaluation against steps of practice.
import { seekIn } from "../actions.js";
import { changesInWords, curve, rateInWords } from "../training.js";
import { inTime, inWords } from "../disturbances.js";
import { count, metres, whole } from "../format.js";
import { largest } from "../scale.js";
import { shownRun } from "../on-stage.js";
import { agentOf } from "../settings.js";
import { scene, served } from "../store.js";
import { scale } from "../time.js";
import { BestKnownKey, bestKnownMark, Chart, Empty } from "./charts.js";
import { html } from "./elements.js";

/** @import { Run } from "../types.js" */

/** With more, single points are not marked. */
const MAX_MARKED_POINTS = 45;
/** The axis reaches at least so far [m]. */
const MIN_TOP_M = 0.5;
const HEADROOM = 1.16;

const CURVE_INVITATION = "Each evaluation adds a point here, on its way to greedy’s line.";

export function LearningChart() {
  const learningCurve = curve.value;
  return html`
    <section class="panel chart" aria-labelledby="learning-title">
      <h2 id="learning-title">Learning: distance in 50 steps</h2>
      ${learningCurve ? html`<${Curve} known=${learningCurve} />` : html`<${Empty} words=${CURVE_INVITATION} />`}
    </section>
  `;
}

/**
 * Lines: greedy's and the best known distance, where one training continued another, what changed, what happened.
 * @param {NonNullable<typeof curve.value>} curve
 */
const marksOf = ({ greedy_m, best_known_m, blocks, changes, disturbances, run, from }) => [
  ...momentOf(run, from),
  ...(greedy_m ? [greedyMark(greedy_m)] : []),
  ...(best_known_m === null ? [] : [bestKnownMark(best_known_m)]),
  ...blocks.map((x) => ({ x, color: "--line" })),
  ...changes.map((change) => ({
    x: change.step, color: "--dim", dash: [2, 3], text: rateInWords(run.config.agent, change),
  })),
  ...disturbances.flatMap((disturbance) => {
    const mark = { color: "--warn", dash: [4, 3] };
    const begins = disturbance.at_step > 0 ? [{ ...mark, x: disturbance.at_step, text: inWords(disturbance) }] : [];
    if (!disturbance.until_step) return begins;
    return [...begins, { ...mark, x: disturbance.until_step, text: `no ${inWords(disturbance)}` }];
  }),
];

/**
 * The step in the picture, and the one that is computed.
 * @param {Run} run
 * @param {number} from steps of practice before this training
 */
function momentOf(run, from) {
  const scaleNow = shownRun.value?.id === run.id ? scale.value : null;
  if (!scaleNow) return [];
  const picture = { x: from + scaleNow.picture, color: "--ink", width: 1.5 };
  return scaleNow.isComputing ? [picture, { x: from + scaleNow.computed, color: "--accent", dash: [2, 3] }] : [picture];
}

/** @param {number} y */
const greedyMark = (y) => ({
  y, name: agentOf("greedy").title, color: agentOf("greedy").color, ink: "--dim", dash: [5, 5],
  text: `greedy, the line to beat: ${metres(y)}`,
});

/** @param {NonNullable<typeof curve.value>} curve */
function captionOf({ points, greedy_m, best_known_m }) {
  if (points.length < 2) return "Learning curve, without points so far.";
  const last = points[points.length - 1];
  const greedy = greedy_m ? `; greedy gets ${metres(greedy_m)}` : "";
  const best = best_known_m === null ? "" : `; best known ${metres(best_known_m)}`;
  return `Learning curve: ${metres(last.distance_m)} after ${whole(last.step)} steps${greedy}${best}.`;
}

/** @param {{ known: NonNullable<typeof curve.value> }} props */
function Curve({ known }) {
  const { points, to, greedy_m, best_known_m, run } = known;
  const { color, title } = agentOf(run.config.agent ?? served().defaults.training.agent);
  const steps = points.map(({ step }) => step);
  const distances = points.map(({ distance_m }) => distance_m);
  const line = {
    name: title, color, xs: steps, ys: distances, dots: points.length < MAX_MARKED_POINTS,
    end: points.length > 1 ? metres(distances.at(-1)) : "",
  };
  const levels = [greedy_m ?? 0, best_known_m ?? 0];
  const changed = changesInWords(run.config.agent, known.changes);
  const x = {
    axis: `practice of ${run.id}`, max: to, unit: "steps of practice",
    text: (/** @type {number} */ step) => count(step, "step"),
  };
  const y = {
    min: -largest(distances.map((distance) => -distance), 0),
    max: HEADROOM * largest([...levels, ...distances], MIN_TOP_M),
    unit: "m", text: metres,
  };
  return html`
    <${Chart} name="the learning curve" label=${captionOf(known)} x=${x} y=${y} lines=${[line]} xs=${steps}
      marks=${marksOf(known)} seek=${seekToStep(known)}>
      ${best_known_m !== null && html`<${BestKnownKey} distance=${best_known_m} />`}
      ${known.disturbances.length > 0 && html`
        <p class="changes happened">Happened: ${known.disturbances.map(inTime).join("; ")}</p>
      `}
      ${changed.length > 0 && html`<p class="changes dim">Changed: ${changed.join(", ")}</p>`}
    <//>
  `;
}

/** Shows a step of the practice that is on stage; null if it cannot be. @param {{ run: Run, from: number }} practice */
function seekToStep({ run, from }) {
  const seek = seekIn(run.id);
  const { duration_s } = scene.value ?? {};
  if (!seek || !duration_s) return null;
  return (/** @type {number} */ step) => seek((Math.max(0, step - from) * duration_s) / run.config.steps);
}
