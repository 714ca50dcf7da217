// The same race under another clock: what thinking costs on this machine, not what it cost in the paper.
import { decision, metres } from "../../format.js";
import { html } from "../../html.js";
import { agentOf } from "../../selectors.js";
import { gaitTitle, observationTitle, robotTitle } from "../../experiments/titles.js";

const RACE_STEPS = 50;

export function FairClocks({ timed }) {
  if (!timed.length) return null;
  const agents = timed[0].lanes.map(({ agent }) => agent);
  return html`
    <section class="panel fair-clocks" aria-labelledby="fair-clocks">
      <h2 id="fair-clocks">Under the wall clock</h2>
      <p class="dim">
        The distances above charge the paper’s price for thinking. Here a decision costs the time that it took on
        this machine: one race a place, with the first seed, and where each was when the first had taken its steps.
      </p>
      <div class="scroller tall" tabindex="0" role="region" aria-label="Races under the wall clock">
        <table class="facts-table">
          <thead><tr><th scope="col">Place</th>${agents.map((agent) => html`<th scope="col">${agentOf(agent).title}</th>`)}</tr></thead>
          <tbody>${timed.map((race) => html`<${Race} race=${race} />`)}</tbody>
        </table>
      </div>
    </section>
  `;
}

const Race = ({ race }) => html`
  <tr>
    <th scope="row">${gaitTitle(race.gait)} <span class="dim">${observationTitle(race.observation).toLowerCase()}, ${robotTitle(race.robot).toLowerCase()}</span></th>
    ${race.lanes.map((lane) => html`
      <td class="num">${lane.rank === 1 ? html`<b>${metres(lane.finished_distance_m)}</b> <span class="first">first</span>` : metres(lane.finished_distance_m)}
        <br /><span class="dim">${decision(lane.decision_s / RACE_STEPS)} a decision</span></td>
    `)}
  </tr>
`;
