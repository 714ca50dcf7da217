// Who is winning: ranks, distances, and what thinking costs.
import { form } from "../form.js";
import { count, decision, duration, metres, whole } from "../format.js";
import { html } from "../html.js";
import { headline } from "../outcome.js";
import { practised } from "../curves.js";
import { agentOf, clock, futures, isActive, learns, raceInView } from "../selectors.js";
import { isDecided, raceScene, standings } from "../standings.js";
import { options, runs } from "../store.js";
import { Icon } from "./icon.js";

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
      <caption class="sr-only">Standings under the ${clock.value} clock</caption>
      <thead>
        <tr>
          <th scope="col"><span class="sr-only">Rank</span></th>
          <th scope="col"><span class="sr-only">Agent</span></th>
          <th scope="col" title="Where each was when the first robot had used its steps">
            ${isDecided.value ? "At finish" : "Now"}
          </th>
          <th scope="col" title="After all of its own steps">Total</th>
          <th scope="col" class="aside" title="Measured time of one decision, on average">Decision</th>
          <th scope="col" class="aside" title="Transitions simulated in order to decide">Simulated</th>
        </tr>
      </thead>
      ${rows.map((row) => html`<${Lane} key=${row.lane} row=${row} longest=${longest} />`)}
    </table>
  `;
}

function Lane({ row, longest }) {
  const width = (seconds) => ({ width: `${(100 * seconds) / longest}%` });
  return html`
    <tbody class=${row.isThinking ? "thinking" : ""} style=${{ "--agent": row.color }}>
      <tr>
        <td class="rank">${row.rank}</td>
        <th scope="row" class="agent"><span class="swatch"></span>${row.title}</th>
        <td class="big">${metres(row.finished_m ?? row.distance_m)}</td>
        <td class=${row.isDone ? "" : "dim"}>${isDecided.value ? metres(row.total_m ?? row.distance_m) : "–"}</td>
        <td class="aside">${decision(row.decision_s)}</td>
        <td class="aside">${whole(row.simulated)}</td>
      </tr>
      <tr class="under">
        <td></td>
        <td colspan="5">
          <div class="strip" role="img" aria-label=${`Walking ${duration(row.spent.walked)}, thinking ${duration(row.spent.thought)}`}>
            <i class="walked" style=${width(row.spent.walked)}></i>
            <i class="thought" style=${width(row.spent.thought)}></i>
          </div>
          <p class="dim">
            <span>${row.isDone && html`<${Icon} name="flag" />`}${doing(row)}</span>
            <span class="facts">${factsOf(row)}</span>
          </p>
          ${row.isMarching && html`<p class="marching"><b>Marching on the spot:</b> ${whyMarching(row)}</p>`}
        </td>
      </tr>
    </tbody>
  `;
}

/** What has no column of its own on a narrow screen. */
const factsOf = ({ decision_s, simulated }) =>
  [decision_s !== null && `${decision(decision_s)} a decision`, simulated !== null && `${whole(simulated)} simulated`]
    .filter(Boolean).join(", ");

function doing(row) {
  if (row.failure) return `Went no further: ${row.failure}`;
  if (row.isDone) {
    const line = row.hasCrossed ? ", past the red line" : "";
    return row.elapsed_s ? `${count(row.steps, "step")} in ${duration(row.elapsed_s)}${line}` : count(row.steps, "step");
  }
  const step = `Step ${row.step} of ${row.steps}`;
  if (row.isThinking) return `${step}, thinking: ${whole(row.futures)} of ${whole(row.futuresTotal)} futures`;
  return row.step ? step : about(row.agent, row.training_id);
}

const whyMarching = ({ agent }) =>
  learns(agent)
    ? "under 1 cm in ten steps, since moves that undo each other still look best to it; practice changes that."
    : "under 1 cm in ten steps, since no move within its sight gains ground on this robot.";

/** What an agent brings to the race. */
function about(agent, trainingId) {
  if (learns(agent)) {
    const training = runs.value.get(trainingId);
    return training ? `${count(practised(training), "step")} of practice, then looks up` : "Practises, then looks up";
  }
  const depth = DEPTHS[agent];
  if (!depth) return options.value?.agents?.find(({ name }) => name === agent)?.description ?? "";
  return `Simulates ${whole(futures(depth, raceInView.value?.config ?? form.value))} moves before each step`;
}

function startWords(race) {
  if (!race) return "These will race. Nothing is decided.";
  return isActive(race) || race.state === "finished"
    ? "They race as soon as practice is over."
    : `The race ${race.state === "stopped" ? "was stopped" : race.state} before it began.`;
}

/** Before a race: who will race. */
function StartList() {
  const race = raceInView.value;
  const lanes = race?.config?.lanes ?? form.value.lanes.map((agent) => ({ agent }));
  return html`
    <p class="dim">${startWords(race)}</p>
    <ul class="start-list">
      ${lanes.map(({ agent, training_id }) => {
        const { title, color } = agentOf(agent);
        return html`
          <li style=${{ "--agent": color }}>
            <span class="swatch"></span><b>${title}</b><span class="dim">${about(agent, training_id)}</span>
          </li>
        `;
      })}
    </ul>
    ${raceScene.value && html`<p class="dim">On the start line.</p>`}
  `;
}
