// The race: its scoreboard, and its chart of distance against time.
import { seekIn } from "../actions.js";
import { disturbancesOf, inTime, joinedBySteps } from "../disturbances.js";
import { form, raceBody } from "../form.js";
import { clockTime, count, decision, metres, sentence, whole } from "../format.js";
import { headline, practiceTitle, reason, ruleOf } from "../headline.js";
import {
  clipped, distanceAt, isOver, isTimedOut, shownEarlyEnd, shownTime, standings, timeline, timelineProblem,
} from "../race.js";
import { clock, earlyEnd, originalRace, raceInView, raceScene, shownRun } from "../on-stage.js";
import { replayProblem } from "../replay.js";
import { simulatedPerDecision } from "../selectors.js";
import { agentOf, laneTitle, learns } from "../settings.js";
import { runs, served, stage } from "../store.js";
import { clockTitle, flatParts, planningModelTitle } from "../titles.js";
import { practisedSteps } from "../training.js";
import { BestKnownKey, bestKnownMark, Chart, Empty } from "./charts.js";
import { html, Icon } from "./elements.js";

/** @import { Standing } from "../race.js" */
/** @import { Run, Timeline } from "../types.js" */

// ---- the scoreboard: ranks, distances, decision times and simulated transitions

export function Scoreboard() {
  const rows = standings.value;
  return html`
    <section class="panel scoreboard" aria-labelledby="scoreboard-title">
      <h2 id="scoreboard-title" class=${rows ? "sr-only" : ""}>Scoreboard</h2>
      ${rows
        ? html`
          <${Headline} words=${headline.value} />
          <p class="dim">${ruleOf(rows[0].steps, clockTitle(clock.value))}</p>
          <${BranchWords} />
          <${Board} rows=${rows} />
        `
        : html`<${Headline} words=${practiceTitle.value} /><${StartList} />`}
    </section>
  `;
}

/** How it stands, and why, in a line each. @param {{ words: string | null }} props */
const Headline = ({ words }) => words && html`
  <p class="headline" role="heading" aria-level="3">${words}</p>
  ${reason.value && html`<p class="reason">${reason.value}</p>`}
`;

/** Disturbances of the race, and the race of which it is a branch. */
function BranchWords() {
  const race = raceInView.value;
  const branch = race?.config.branch_from;
  const happens = joinedBySteps(race ? disturbancesOf(race) : []).map(inTime).join("; ");
  if (!branch) return happens && html`<p class="happened">${sentence(happens)}.</p>`;
  const original = originalRace.value;
  const title = original?.name || "another race";
  return html`
    <p class="happened">
      The same as <a href=${`#runs?search=${branch.race_id}`}>${title}</a> before step ${branch.step + 1}.
      ${happens && ` ${sentence(happens)}.`}
    </p>
  `;
}

/** @param {{ rows: Standing[] }} props */
function Board({ rows }) {
  const longest = Math.max(...rows.map((row) => row.elapsed_s ?? 0), 1e-9);
  return html`
    <table class="board">
      <caption class="sr-only">Standings (${clockTitle(clock.value)})</caption>
      <thead>
        <tr>
          <th scope="col"><span class="sr-only">Rank</span></th>
          <th scope="col"><span class="sr-only">Agent</span></th>
          <th scope="col" title="Distance at time-out: when the first lane has used its steps">
            ${distanceTitle()}
          </th>
          <th scope="col" title="Distance after all of its own steps">Total</th>
          <th scope="col" class="aside" title="Measured time of one decision, on average">Decision</th>
          <th scope="col" class="aside" title="Transitions simulated in order to decide">Simulated</th>
        </tr>
      </thead>
      ${rows.map((row) => html`<${Lane} key=${row.lane} row=${row} longest=${longest} />`)}
      <${BestKnown} />
    </table>
  `;
}

function distanceTitle() {
  if (isTimedOut.value) return html`<span class="sr-only">Distance </span>At time-out`;
  return shownEarlyEnd.value ? "Reached" : "Now";
}

function BestKnown() {
  const best_m = raceInView.value?.best_known_m ?? null;
  return best_m !== null && html`
    <tfoot>
      <tr title=${served().help.best_known}>
        <td></td><th scope="row" class="agent">Best known</th><td></td><td>${metres(best_m)}</td>
        <td class="aside"></td><td class="aside"></td>
      </tr>
    </tfoot>
  `;
}

/** @param {{ row: Standing, longest: number }} props */
const Lane = ({ row, longest }) => html`
  <tbody class=${row.isThinking ? "thinking" : ""} style=${{ "--agent": row.color }} aria-label=${row.title}>
    <tr>
      <td class="rank">${row.rank ?? "–"}</td>
      <th scope="row" class="agent"><span class="swatch"></span>${row.title}</th>
      <td class="big">${metres(row.finished_m ?? row.distance_m)}</td>
      <td class=${row.isDone ? "" : "dim"}>${isTimedOut.value ? metres(row.total_m ?? distanceSoFar(row)) : "–"}</td>
      <td class="aside">${decision(row.decision_s)}</td>
      <td class="aside">${whole(row.simulated)}</td>
    </tr>
    <tr class="under">
      <td></td>
      <td colspan="5">
        <${TimeStrip} spent=${row.spent} longest=${longest} />
        <p class="dim">
          <span>${row.hasCrossed && html`<${Icon} name="flag" />`}${activityOf(row)}</span>
          <span class="facts">${factsOf(row)}</span>
        </p>
        ${postureOf(row) && html`<p class="happened">${postureOf(row)}</p>`}
        <p class="dim">
          ${row.original && html`
            <span>
              Original: ${metres(row.original.finished_m)} at time-out, total ${metres(row.original.total_m)}
            </span>
          `}
          <span>${planningModelOf(row)}</span>
        </p>
        ${row.isMarching && html`<p class="marching"><b>Marching on the spot:</b> ${reasonForMarching(row)}</p>`}
      </td>
    </tr>
  </tbody>
`;

/** Distance of a lane that walks on after time-out; none once the show has ended there. @param {Standing} row */
const distanceSoFar = (row) => (isOver.value ? null : row.distance_m);

/** @param {{ spent: { walked: number, thought: number }, longest: number }} props */
function TimeStrip({ spent: { walked, thought }, longest }) {
  /** @param {number} seconds */
  const width = (seconds) => ({ width: `${(100 * seconds) / longest}%` });
  const label = `Walking ${clockTime(walked)}, thinking ${clockTime(thought)} (minutes:seconds)`;
  return html`
    <div class="strip" role="img" aria-label=${label}>
      <i class="walked" style=${width(walked)}></i>
      <i class="thought" style=${width(thought)}></i>
    </div>
  `;
}

/** The values of the columns that a narrow screen has no room for. @param {Standing} one */
const factsOf = ({ decision_s, simulated }) =>
  [decision_s !== null && `${decision(decision_s)} a decision`, simulated !== null && `${whole(simulated)} simulated`]
    .filter(Boolean).join(", ");

/** A robot that has turned less is said to walk straight [°]. */
const MIN_TURN_DEG = 20;

/** Whether it fell or turned. @param {Standing} one */
function postureOf({ fell_at_step, heading_deg }) {
  const fell = typeof fell_at_step === "number" && `fell at step ${whole(fell_at_step + 1)}`;
  const turn = heading_deg ?? 0;
  const turned = Math.abs(turn) > MIN_TURN_DEG &&
    `turned ${Math.round(Math.abs(turn))}° ${turn > 0 ? "left" : "right"}`;
  return sentence([fell, turned].filter(Boolean).join(", "));
}

/** Model that a search plans with; empty if the agent does not search, or if nothing happens. @param {Standing} one */
const planningModelOf = ({ plans_with }) => (plans_with ? `plans with the ${planningModelTitle(plans_with)}` : "");

/** @param {Standing} row */
function activityOf(row) {
  if (row.failure) return `Stopped: ${row.failure}`;
  if (row.isDone) {
    const crossed = row.hasCrossed ? ", crossed the finish line" : "";
    const steps = count(row.steps, "step");
    return row.elapsed_s ? `${steps} in ${clockTime(row.elapsed_s)}${crossed}` : steps;
  }
  if (row.isHalted) return `${earlyEnd(raceInView.value) ?? "Stopped"} at step ${row.step}`;
  const step = `Step ${row.step} of ${row.steps}`;
  if (isOver.value && row.step) return `${step} at time-out`;
  if (row.isThinking) return `${step}, thinking: ${whole(row.futures)} of ${whole(row.futuresTotal)} simulated`;
  return row.step ? step : agentSummary(row.agent, row.training_id);
}

/** @param {{ agent: string }} one */
const reasonForMarching = ({ agent }) =>
  learns(agent)
    ? "under 1 cm in ten steps: moves that undo each other still have the highest values. More practice changes that."
    : "under 1 cm in ten steps: no move that it simulates gains distance on this robot.";

/**
 * Decision rule of an agent, in a few words.
 * @param {string} agent
 * @param {string | null | undefined} trainingId
 */
function agentSummary(agent, trainingId) {
  if (learns(agent)) {
    const training = runs.value.get(trainingId ?? "");
    return training
      ? `${count(practisedSteps(training), "step")} of practice, then looks up its table`
      : raceInView.value ? "Learns while it races" : "Practises, then looks up its table";
  }
  const { description, steps_ahead } = agentOf(agent);
  if (!steps_ahead) return description;
  const simulated = simulatedPerDecision(steps_ahead, raceInView.value?.config ?? form.value);
  return `Simulates ${whole(simulated)} moves before each step`;
}

/** @param {Run | null} race */
function startSentence(race) {
  if (!race) return "The lanes of the next race.";
  if (shownRun.value === race) {
    const end = earlyEnd(race);
    if (end && !race.progress.done) return `${end} before it began.`;
    return race.progress.done ? "Its figures come with the picture." : "The race is about to begin.";
  }
  return "The race starts when practice is over.";
}

/** The lanes before the race. */
function StartList() {
  const race = raceInView.value;
  if (!race && stage.value?.run_id && !shownRun.value) {
    const words = replayProblem.value ? "No run is shown, so there are no figures." : "Loading the run on stage…";
    return html`<p class="dim" role="status">${words}</p>`;
  }
  /** @type {import("../types.js").LaneConfig[]} */
  const lanes = race?.config?.lanes ?? raceBody().lanes;
  return html`
    <p class="dim">${startSentence(race)}</p>
    <ul class="start-list" aria-label="Lanes of the race">
      ${lanes.map((lane) => html`
        <li style=${{ "--agent": agentOf(lane.agent).color }}>
          <span class="swatch"></span><b>${laneTitle(lane)}</b>
          <span class="dim">${agentSummary(lane.agent, lane.training_id)}</span>
        </li>
      `)}
    </ul>
    ${raceScene.value && html`<p class="dim">On the start line.</p>`}
  `;
}

// ---- the chart: distance against race time up to the moment that is shown

const HEADROOM = 1.16;
const MAX_MOMENTS = 250;
/** The time axis shows at least so much of a race that has just begun [s]. */
const FIRST_VIEW_S = 20;

export function RaceChart() {
  const known = timeline.value;
  const time = shownTime.value;
  const problem = timelineProblem.value;
  const isOn = known && time !== null && known.lanes.some(({ points }) => points.length > 1);
  return html`
    <section class="panel chart" aria-labelledby="race-title">
      <h2 id="race-title">The race</h2>
      <p class="dim">${flatParts(clock.value)}</p>
      ${problem && html`<p class="problem" role="alert">${problem}</p>`}
      ${isOn && html`<${Lines} known=${known} time=${time} />`}
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
 * @param {Timeline} one
 * @param {number} until
 * @param {number} longest
 */
function lastMoment({ first_finish_s }, until, longest) {
  const planned = first_finish_s ? Math.min(1.3 * first_finish_s, longest) : Math.min(longest, FIRST_VIEW_S);
  return Math.max(until, planned, 1);
}

/**
 * The finish line, the best known walk, and time-out once it is past.
 * @param {Timeline} one
 * @param {number} until
 * @param {number | null} best_m
 */
function marksOf({ finish_line_m, first_finish_s }, until, best_m) {
  /** @type {object[]} */
  const marks = [{ y: finish_line_m, color: "--finish", text: "finish line" }];
  if (best_m !== null) marks.push(bestKnownMark(best_m));
  if (first_finish_s && until >= first_finish_s) {
    marks.push({ x: first_finish_s, color: "--dim", dash: [2, 3], text: "time-out" });
  }
  return marks;
}
