// Learners against each other: the chance that a seed of one beats a seed of another.
import { percentage, whole } from "../../format.js";
import { html } from "../../html.js";
import { agentTitle } from "../../experiments/titles.js";
import { gaitTitle, observationTitle, robotTitle } from "../../titles.js";

const VERDICTS = { yes: "better", no: "worse", "not established": "not established" };
const COLUMNS = ["Place", "First", "Second", "Chance", "The first is"];

export const Versus = ({ known }) => known.versus?.length > 0 && html`
  <section class="panel versus" aria-labelledby="versus">
    <h2 id="versus">Learners against each other</h2>
    <p class="dim">The chance that a seed of the first gets further than a seed of the second; a half is a tie.</p>
    <div class="scroller" tabindex="0" role="region" aria-label="Table of chances">
      <table class="facts-table">
        <thead><tr>${COLUMNS.map((title) => html`<th scope="col">${title}</th>`)}</tr></thead>
        <tbody>${known.versus.map((one) => html`<${Row} one=${one} />`)}</tbody>
      </table>
    </div>
  </section>
`;

function Row({ one }) {
  const place = [observationTitle(one.observation), robotTitle(one.robot).toLowerCase(), `${whole(one.steps)} steps`];
  const interval = one.low === null ? "" : `${percentage(one.low)} – ${percentage(one.high)}`;
  return html`
    <tr>
      <th scope="row">${gaitTitle(one.gait)}, <span class="dim">${place.join(", ")}</span></th>
      <td>${agentTitle(one.a)}</td><td>${agentTitle(one.b)}</td>
      <td class="num"><b>${percentage(one.probability)}</b> <span class="dim">${interval}</span></td>
      <td>${VERDICTS[one.verdict] ?? one.verdict}</td>
    </tr>
  `;
}
