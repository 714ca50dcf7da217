// The chart of a race: distance against race time, up to the moment that is shown.
import { seekIn } from "../actions.js";
import { metres, SAME_MOMENT_S } from "../format.js";
import { raceInView } from "../on-stage.js";
import { clipped, shownTime, timeline, timelineProblem } from "../race.js";
import { distanceAt } from "../narrative/moment.js";
import { agentOf, laneTitle } from "../settings.js";
import { BestKnownKey, bestKnownMark, Chart, Empty } from "./charts.js";
import { html } from "./elements.js";

/** @import { Timeline } from "../types.js" */

const HEADROOM = 1.16;
const MAX_MOMENTS = 250;
/** The time axis shows at least so much of a race that has just begun [s]. */
const FIRST_VIEW_S = 20;

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
    ? "The lines start when the robots do."
    : "Each robot draws a line here as it walks.";

/** @param {{ known: Timeline, time: number }} props */
function Lines({ known, time }) {
  const longest = Math.max(...known.lanes.map(({ total_s }) => total_s));
  const until = Math.min(time, longest);
  const configs = raceInView.value?.config?.lanes ?? [];
  const lanes = known.lanes.map((lane, number) => {
    const shown = clipped(lane.points, until);
    const name = laneTitle(configs[number] ?? lane);
    return {
      name, end: name, color: agentOf(lane.agent).color, xs: shown.map(([t]) => t), ys: shown.map(([, d]) => d),
      at: (/** @type {number} */ t) => (t > until ? null : distanceAt(lane.points, t)),
    };
  });
  const best_m = raceInView.value?.best_known_m ?? null;
  const far = Math.max(known.finish_line_m, best_m ?? 0, ...lanes.map(({ ys }) => ys.at(-1) ?? NaN));
  const ends = lanes.map(({ name, ys }) => `${name} ${metres(ys.at(-1))}`).join(", ");
  const best = best_m === null ? "" : `; best known ${metres(best_m)}`;
  const caption = `The race after ${Math.round(until)} seconds: ${ends}${best}.`;
  const last = keptEnd(`${known.id} ${known.clock}`, lastMoment(known, until, longest));
  const moments = momentsOf(until, last);
  const x = {
    axis: `race ${known.id}`, max: last, unit: "race time, s",
    text: (/** @type {number} */ seconds) => `${seconds.toFixed(1)}\u00a0s`,
  };
  return html`
    <${Chart} name="the race" label=${caption} x=${x} lines=${lanes} marks=${marksOf(known, until, best_m)}
      y=${{ min: Math.min(0, ...lanes.flatMap(({ ys }) => ys)), max: HEADROOM * far, unit: "m", text: metres }}
      xs=${moments} now=${moments.indexOf(until)} seek=${seekIn(known.id)}
      reach=${{ shown: until, computed: longest }}>
      ${best_m !== null && html`<${BestKnownKey} distance=${best_m} />`}
    <//>
  `;
}

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
 * Where the time axis ends.
 * @param {Timeline} timeline
 * @param {number} until
 * @param {number} longest
 */
function lastMoment({ first_finish_s }, until, longest) {
  const planned = first_finish_s ? Math.min(1.3 * first_finish_s, longest) : Math.min(longest, FIRST_VIEW_S);
  return Math.max(until, planned, 1);
}

/**
 * The finish line, the best known walk, and time-out once it is past.
 * @param {Timeline} timeline
 * @param {number} until
 * @param {number | null} best_m
 */
function marksOf({ finish_line_m, first_finish_s }, until, best_m) {
  /** @type {object[]} */
  const marks = [
    { y: finish_line_m, color: "--finish", text: "finish line" },
    // The moment in the picture.
    { x: until, color: "--ink", width: 1.5 },
  ];
  if (best_m !== null) marks.push(bestKnownMark(best_m));
  if (first_finish_s && until >= first_finish_s - SAME_MOMENT_S) {
    marks.push({ x: first_finish_s, color: "--dim", dash: [2, 3], text: "time-out" });
  }
  return marks;
}
