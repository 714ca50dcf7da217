// Agents that learn, against each other: how often one seed of the first beats one of the second.
import { html } from "../../html.js";
import { agentTitle, gaitTitle, observationTitle } from "../../experiments/titles.js";

const WORDS = { yes: "better", no: "worse", "not established": "not established" };

export const Versus = ({ known }) => known.versus?.length > 0 && html`
  <section class="panel versus" aria-labelledby="versus">
    <h2 id="versus">One against another</h2>
    <p class="dim">The chance that a seed of the first comes further than a seed of the second; a half is a tie.</p>
    <div class="scroller" tabindex="0" role="region" aria-label="Table of chances">
      <table class="facts-table">
        <thead><tr><th scope="col">Place</th><th scope="col">First</th><th scope="col">Second</th><th scope="col">Chance</th><th scope="col">The first is</th></tr></thead>
        <tbody>
          ${known.versus.map((one) => html`
            <tr>
              <th scope="row">${gaitTitle(one.gait)}, <span class="dim">${observationTitle(one.observation).toLowerCase()}, ${one.robot}, ${one.steps} steps</span></th>
              <td>${agentTitle(one.a)}</td><td>${agentTitle(one.b)}</td>
              <td class="num"><b>${percent(one.probability)}</b>${one.low !== null && html` <span class="dim">${percent(one.low)} – ${percent(one.high)}</span>`}</td>
              <td>${WORDS[one.verdict] ?? one.verdict}</td>
            </tr>
          `)}
        </tbody>
      </table>
    </div>
  </section>
`;

const percent = (share) => `${Math.round(100 * share)} %`;
