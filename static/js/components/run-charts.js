// The charts of what is in view: of a race distance against time, up to the moment that is shown; of its learner
// distance in an evaluation against steps of practice.
import { seekIn } from "../actions.js";
import { inTime, inWords } from "../disturbances.js";
import { count, fixed, metres, t } from "../format.js";
import { distanceAt } from "../narrative/moment.js";
import { raceInView, shownRun } from "../on-stage.js";
import { SAME_MOMENT_S } from "../replay-frames.js";
import { clipped, shownTime, timeline, timelineProblem } from "../race.js";
import { largest, ticks } from "../scale.js";
import { agentOf, laneTitle } from "../settings.js";
import { scene, served } from "../store.js";
import { scale } from "../time.js";
import { changesInWords, curve, rateInWords } from "../training.js";
import { BestKnownKey, bestKnownMark, Chart, Empty } from "./charts.js";
import { html } from "./elements.js";

/** @import { Run, Timeline } from "../types.js" */

const HEADROOM = 1.12;
/** A level is in the picture of a race up to so many times the farthest distance. */
const LEVELS_WITHIN = 1.4;

/**
 * The end of an axis of what grows: a round number that has been reached, as of its grid.
 * @param {number} reached
 */
function roundEnd(reached) {
  const [first = 0, second = 1] = ticks(reached, 4);
  return Math.ceil(reached / (second - first) - 1e-9) * (second - first);
}

// ---- the race

const MAX_MOMENTS = 250;
/** The axes show at least so much of a race that has just begun [s], [m]. */
const FIRST_VIEW = { time_s: 4, distance_m: 0.05 };

export function RaceChart() {
  const raceTimeline = timeline.value;
  const time = shownTime.value;
  const problem = timelineProblem.value;
  const isOn = raceTimeline && time !== null && raceTimeline.lanes.some(({ points }) => points.length > 1);
  return html`
    <section class="panel chart" aria-labelledby="race-title">
      <h2 id="race-title">Distance against time</h2>
      ${problem && html`<p class="problem" role="alert">${problem}</p>`}
      ${isOn && html`<${Lines} known=${raceTimeline} time=${time} />`}
      ${!isOn && !problem && html`<${Empty} shape="lines" words=${invitation()} />`}
    </section>
  `;
}

const invitation = () =>
  raceInView.value
    ? t("The lines start when the robots do.")
    : t("Each robot draws a line here as it walks.");

/** @param {{ known: Timeline, time: number }} props */
function Lines({ known, time }) {
  const longest = Math.max(...known.lanes.map(({ total_s }) => total_s));
  const until = Math.min(time, longest);
  const configs = raceInView.value?.config?.lanes ?? [];
  const lanes = known.lanes.map((lane, number) => {
    const shown = clipped(lane.points, until);
    const name = laneTitle(configs[number] ?? lane);
    return {
      name, end: name, color: agentOf(lane.agent).color, xs: shown.map(([at]) => at), ys: shown.map(([, d]) => d),
      at: (/** @type {number} */ at) => (at > until ? null : distanceAt(lane.points, at)),
    };
  });
  const best_m = raceInView.value?.best_known_m ?? null;
  const farthest = largest(lanes.flatMap(({ ys }) => ys), FIRST_VIEW.distance_m);
  const far = Math.max(farthest, ...[known.finish_line_m, best_m ?? 0].filter((m) => m < LEVELS_WITHIN * farthest));
  const ends = lanes.map(({ name, ys }) => `${name} ${metres(ys.at(-1))}`).join(", ");
  const best = bestKnownInWords(best_m);
  const caption = t("The race after {seconds} seconds: {ends}.", { seconds: until, ends: ends + best });
  const end = Math.min(longest, roundEnd(Math.max(until, FIRST_VIEW.time_s)));
  const last = keptEnd(`${known.id} ${known.clock}`, end);
  const moments = momentsOf(until, last);
  const x = {
    axis: `race ${known.id}`, max: last, unit: t("race time, s"),
    text: (/** @type {number} */ seconds) => `${fixed(seconds, 1)}\u00a0s`,
  };
  const least = -largest(lanes.flatMap(({ ys }) => ys.map((distance) => -distance)), 0);
  return html`
    <${Chart} name=${t("the race")} label=${caption} x=${x} lines=${lanes} marks=${marksOfRace(known, until, best_m)}
      y=${{ min: least, max: HEADROOM * far, unit: "m", text: metres, title: t("distance, m") }}
      xs=${moments} now=${moments.indexOf(until)} seek=${seekIn(known.id)}
      reach=${{ shown: until, computed: longest }}>
      ${best_m !== null && html`<${BestKnownKey} distance=${best_m} />`}
    <//>
  `;
}

/** @param {number | null} best_m */
const bestKnownInWords = (best_m) =>
  (best_m === null ? "" : t("; best known {distance}", { distance: metres(best_m) }));

/** The end of the time axis, of one race under one clock. */
let longestAxis = { key: "", until: 0 };

/**
 * The largest end that an axis had: seeking back does not shorten it.
 * @param {string} key
 * @param {number} until
 */
function keptEnd(key, until) {
  if (longestAxis.key !== key || longestAxis.until < until) longestAxis = { key, until };
  return longestAxis.until;
}

/**
 * The moments at which the crosshair stops: each half second, in a long race fewer, and the one that is shown.
 * @param {number} until
 * @param {number} last
 */
function momentsOf(until, last) {
  const step = Math.max(0.5, Math.ceil(last / MAX_MOMENTS));
  const even = Array.from({ length: Math.floor(last / step) + 1 }, (_, n) => n * step);
  return [...new Set([...even, until])].sort((a, b) => a - b);
}

/**
 * The finish line, the best known walk, and time-out once it is past.
 * @param {Timeline} timeline
 * @param {number} until
 * @param {number | null} best_m
 */
function marksOfRace({ finish_line_m, first_finish_s }, until, best_m) {
  /** @type {object[]} */
  const marks = [
    { y: finish_line_m, color: "--finish", text: t("finish line") },
    // The moment in the picture.
    { x: until, color: "--ink", width: 1.5 },
  ];
  if (best_m !== null) marks.push(bestKnownMark(best_m));
  if (first_finish_s && until >= first_finish_s - SAME_MOMENT_S) {
    marks.push({ x: first_finish_s, color: "--dim", dash: [2, 3], text: t("time-out") });
  }
  return marks;
}

// ---- the learning curve

/** With more, single points are not marked. */
const MAX_MARKED_POINTS = 45;
/** The axis shows at least so many steps of a practice that has just begun. */
const FIRST_STEPS = 50;

const CURVE_INVITATION = t("Each evaluation adds a point here, on its way to greedy’s line.");

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
const marksOfCurve = ({ greedy_m, best_known_m, blocks, changes, disturbances, run, from }) => [
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
    const text = t("no {disturbance}", { disturbance: inWords(disturbance) });
    return [...begins, { ...mark, x: disturbance.until_step, text }];
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
  text: t("greedy, the line to beat: {distance}", { distance: metres(y) }),
});

/** @param {NonNullable<typeof curve.value>} curve */
function captionOf({ points, greedy_m, best_known_m }) {
  if (points.length < 2) return t("Learning curve, without points so far.");
  const last = points[points.length - 1];
  const greedy = greedy_m ? t("; greedy gets {distance}", { distance: metres(greedy_m) }) : "";
  const others = greedy + bestKnownInWords(best_known_m);
  const values = { distance: metres(last.distance_m), steps: last.step, others };
  return t("Learning curve: {distance} after {steps} steps{others}.", values);
}

/** The end of the axis: all of a practice that is over, else a round number that it has reached. */
/** @param {NonNullable<typeof curve.value>} curve */
function endOfPractice({ points, to, from, run }) {
  const { picture = 0, computed = 0 } = (shownRun.value?.id === run.id && scale.value) || {};
  const reached = Math.max(points.at(-1)?.step ?? 0, from + picture, from + computed, FIRST_STEPS);
  return reached >= to ? to : Math.min(to, roundEnd(reached));
}

/** @param {{ known: NonNullable<typeof curve.value> }} props */
function Curve({ known }) {
  const { points, greedy_m, best_known_m, run } = known;
  const { color, title } = agentOf(run.config.agent ?? served().defaults.training.agent);
  const steps = points.map(({ step }) => step);
  const distances = points.map(({ distance_m }) => distance_m);
  const line = {
    name: title, color, xs: steps, ys: distances, dots: points.length < MAX_MARKED_POINTS,
    end: points.length > 1 ? metres(distances.at(-1)) : "",
  };
  const farthest = largest([greedy_m ?? 0, ...distances], FIRST_VIEW.distance_m);
  const levels = [farthest, best_known_m ?? 0].filter((level) => level < LEVELS_WITHIN * farthest);
  const changed = changesInWords(run.config.agent, known.changes);
  const x = {
    axis: `practice of ${run.id}`, max: endOfPractice(known), unit: t("steps of practice"),
    text: (/** @type {number} */ step) => count(step, "step"),
  };
  const y = {
    min: -largest(distances.map((distance) => -distance), 0),
    max: HEADROOM * largest(levels),
    unit: "m", text: metres, title: t("distance in 50 steps, m"),
  };
  return html`
    <${Chart} name=${t("the learning curve")} label=${captionOf(known)} x=${x} y=${y} lines=${[line]} xs=${steps}
      marks=${marksOfCurve(known)} seek=${seekToStep(known)}>
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
