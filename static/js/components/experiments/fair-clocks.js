// Races under the real clock: decisions cost the time measured on the machine, not the paper's price.
import { agentOf } from "../../agents.js";
import { decision, metres } from "../../format.js";
import { html } from "../../html.js";
import { gaitTitle, observationTitle, robotTitle } from "../../titles.js";
import { served } from "../../store.js";

export function FairClocks({ timed }) {
  if (!timed.length) return null;
  const agents = timed[0].lanes.map(({ agent }) => agent);
  return html`
    <section class="panel fair-clocks" aria-labelledby="fair-clocks">
      <h2 id="fair-clocks">Under the real clock</h2>
      <p class="dim">
        The distances above are under the paper clock. Here a decision costs the time that it took on this machine:
        one race in each place, with the first seed; distances at time-out.
      </p>
      <div class="scroller tall" tabindex="0" role="region" aria-label="Races under the real clock">
        <table class="facts-table">
          <thead>
            <tr>
              <th scope="col">Place</th>
              ${agents.map((name) => html`<th scope="col">${agentOf(name).title}</th>`)}
            </tr>
          </thead>
          <tbody>${timed.map((race) => html`<${Race} race=${race} />`)}</tbody>
        </table>
      </div>
    </section>
  `;
}

const Race = ({ race }) => html`
  <tr>
    <th scope="row">
      ${gaitTitle(race.gait)}
      <span class="dim"> ${observationTitle(race.observation)}, ${robotTitle(race.robot).toLowerCase()}</span>
    </th>
    ${race.lanes.map((lane) => html`<td class="num"><${Lane} lane=${lane} /></td>`)}
  </tr>
`;

function Lane({ lane }) {
  const distance = metres(lane.finished_distance_m);
  const perDecision = decision(lane.decision_s / served().defaults.race.steps);
  return html`
    ${lane.rank === 1 ? html`<b>${distance}</b> <span class="first">first</span>` : distance}
    <br /><span class="dim">${perDecision} a decision</span>
  `;
}
