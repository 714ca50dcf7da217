// The scoreboard: ranks, distances, decision times and simulated transitions.
import { agentOf, learns } from "../agents.js";
import { form } from "../form.js";
import { count, decision, duration, metres, whole } from "../format.js";
import { html } from "../html.js";
import { headline } from "../outcome.js";
import { practisedSteps } from "../curves.js";
import { clock, isActive, raceInView, simulatedPerDecision } from "../selectors.js";
import { isTimedOut, raceScene, standings } from "../standings.js";
import { runs } from "../store.js";
import { clockTitle } from "../titles.js";
import { Icon } from "./icon.js";

/** How many steps the look-ahead agents simulate. */
const DEPTHS = { greedy: 1, "two-step": 2 };

export function Scoreboard() {
  const rows = standings.value;
  return html`
    <section class="panel scoreboard" aria-labelledby="scoreboard-title">
      <h2 id="scoreboard-title" class=${rows ? "sr-only" : ""}>Scoreboard</h2>
      ${rows
        ? html`<p class="headline">${headline.value}</p><${Board} rows=${rows} />`
        : html`<${StartList} />`}
    </section>
  `;
}

function Board({ rows }) {
  const longest = Math.max(...rows.map((row) => row.elapsed_s ?? 0), 1e-9);
  return html`
    <table class="board">
      <caption class="sr-only">Standings under the ${clockTitle(clock.value)}</caption>
      <thead>
        <tr>
          <th scope="col"><span class="sr-only">Rank</span></th>
          <th scope="col"><span class="sr-only">Agent</span></th>
          <th scope="col" title="Distance at time-out: when the first lane has used its steps">
            ${isTimedOut.value ? html`<span class="sr-only">Distance </span>At time-out` : "Now"}
          </th>
          <th scope="col" title="Distance after all of its own steps">Total</th>
          <th scope="col" class="aside" title="Measured time of one decision, on average">Decision</th>
          <th scope="col" class="aside" title="Transitions simulated in order to decide">Simulated</th>
        </tr>
      </thead>
      ${rows.map((row) => html`<${Lane} key=${row.lane} row=${row} longest=${longest} />`)}
    </table>
  `;
}

const Lane = ({ row, longest }) => html`
  <tbody class=${row.isThinking ? "thinking" : ""} style=${{ "--agent": row.color }}>
    <tr>
      <td class="rank">${row.rank}</td>
      <th scope="row" class="agent"><span class="swatch"></span>${row.title}</th>
      <td class="big">${metres(row.finished_m ?? row.distance_m)}</td>
      <td class=${row.isDone ? "" : "dim"}>${isTimedOut.value ? metres(row.total_m ?? row.distance_m) : "–"}</td>
      <td class="aside">${decision(row.decision_s)}</td>
      <td class="aside">${whole(row.simulated)}</td>
    </tr>
    <tr class="under">
      <td></td>
      <td colspan="5">
        <${TimeStrip} spent=${row.spent} longest=${longest} />
        <p class="dim">
          <span>${row.isDone && html`<${Icon} name="flag" />`}${activityOf(row)}</span>
          <span class="facts">${factsOf(row)}</span>
        </p>
        ${row.isMarching && html`<p class="marching"><b>Marching on the spot:</b> ${reasonForMarching(row)}</p>`}
      </td>
    </tr>
  </tbody>
`;

function TimeStrip({ spent: { walked, thought }, longest }) {
  const width = (seconds) => ({ width: `${(100 * seconds) / longest}%` });
  const label = `Walking ${duration(walked)}, thinking ${duration(thought)}`;
  return html`
    <div class="strip" role="img" aria-label=${label}>
      <i class="walked" style=${width(walked)}></i>
      <i class="thought" style=${width(thought)}></i>
    </div>
  `;
}

/** The values of the columns that a narrow screen has no room for. */
const factsOf = ({ decision_s, simulated }) =>
  [decision_s !== null && `${decision(decision_s)} a decision`, simulated !== null && `${whole(simulated)} simulated`]
    .filter(Boolean).join(", ");

function activityOf(row) {
  if (row.failure) return `Stopped: ${row.failure}`;
  if (row.isDone) {
    const crossed = row.hasCrossed ? ", crossed the finish line" : "";
    const steps = count(row.steps, "step");
    return row.elapsed_s ? `${steps} in ${duration(row.elapsed_s)}${crossed}` : steps;
  }
  const step = `Step ${row.step} of ${row.steps}`;
  if (row.isThinking) return `${step}, thinking: ${whole(row.futures)} of ${whole(row.futuresTotal)} simulated`;
  return row.step ? step : agentSummary(row.agent, row.training_id);
}

const reasonForMarching = ({ agent }) =>
  learns(agent)
    ? "under 1 cm in ten steps: moves that undo each other still have the highest values. More practice changes that."
    : "under 1 cm in ten steps: no move that it simulates gains distance on this robot.";

/** How an agent decides, in a few words. */
function agentSummary(agent, trainingId) {
  if (learns(agent)) {
    const training = runs.value.get(trainingId);
    return training
      ? `${count(practisedSteps(training), "step")} of practice, then looks up its table`
      : "Practises, then looks up its table";
  }
  const depth = DEPTHS[agent];
  if (!depth) return agentOf(agent).description;
  const simulated = simulatedPerDecision(depth, raceInView.value?.config ?? form.value);
  return `Simulates ${whole(simulated)} moves before each step`;
}

function startSentence(race) {
  if (!race) return "The lanes of the next race.";
  return isActive(race) || race.state === "finished"
    ? "The race starts when practice is over."
    : `The race ${race.state === "stopped" ? "was stopped" : race.state} before it began.`;
}

/** The lanes before the race. */
function StartList() {
  const race = raceInView.value;
  const lanes = race?.config?.lanes ?? form.value.lanes.map((agent) => ({ agent, training_id: null }));
  return html`
    <p class="dim">${startSentence(race)}</p>
    <ul class="start-list">
      ${lanes.map(({ agent, training_id }) => html`
        <li style=${{ "--agent": agentOf(agent).color }}>
          <span class="swatch"></span><b>${agentOf(agent).title}</b>
          <span class="dim">${agentSummary(agent, training_id)}</span>
        </li>
      `)}
    </ul>
    ${raceScene.value && html`<p class="dim">On the start line.</p>`}
  `;
}
