// Table 1 in the paper's layout, with every seed of this run.
import { useState } from "preact/hooks";
import { agentOf } from "../../agents.js";
import { html } from "../../html.js";
import { whole } from "../../format.js";
import { gaitsOf, placesOf } from "../../experiments/places.js";
import { factorOf, inUnit, unit } from "../../experiments/units.js";
import { largest } from "../../scale.js";
import { gaitTitle } from "../../titles.js";
import { PlaceSwitch, PlaceWords } from "./place-switch.js";
import { StripKey } from "./strip-key.js";
import { LearnerCell, ReferenceCell } from "./table-one-cells.js";
import { UnitSwitch } from "./unit-switch.js";

const DISTANCES = [
  ["finished", "At time-out", "Distance at time-out: when the first lane has used its 50 steps"],
  ["total", "Total", "Distance after 50 steps of its own"],
];
const REFERENCES = ["greedy", "two-step"];

export function TableOne({ known }) {
  const places = placesOf(known.settings);
  const [chosen, setChosen] = useState(null);
  const place = places.find(({ key }) => key === chosen) ?? places[0];
  const gaits = gaitsOf(known.settings, place.key);
  const high = highest(gaits, place);
  return html`
    <section class="panel table-one" aria-labelledby="table-one">
      <div class="report-tools">
        <h2 id="table-one">Table 1, with every seed</h2>
        <${PlaceSwitch} places=${places} value=${place.key} onValue=${setChosen} />
        <${UnitSwitch} />
      </div>
      <${PlaceWords} place=${place} />
      <${StripKey} color=${agentOf(gaits[0].learners[0]?.agent).color} />
      <table role="table">
        <caption class="sr-only">
          Distance at time-out and total distance of each gait and agent, beside the paper’s
        </caption>
        <${Head} learners=${gaits[0].learners} />
        ${gaits.map((one) => html`<${Gait} key=${one.gait} gait=${one} place=${place} high=${high} />`)}
      </table>
      <p class="dim table-note">${NOTES[unit.value]}</p>
    </section>
  `;
}

const Head = ({ learners }) => html`
  <thead role="rowgroup">
    <tr role="row">
      <th role="columnheader" scope="col">Gait</th>
      <th role="columnheader" scope="col">Distance</th>
      ${learners.map(({ agent, steps }) => html`
        <th role="columnheader" scope="col">${agentOf(agent).title}, ${whole(steps)} steps</th>
      `)}
      ${REFERENCES.map((agent) => html`<th role="columnheader" scope="col">${agentOf(agent).title}</th>`)}
    </tr>
  </thead>
`;

/** Factors from metres to the chosen unit: for this run's distances, and for the paper's. */
const factorsOf = (greedy, place) => ({
  ours: factorOf({ ...place, greedy_m: greedy?.total?.mean_m ?? null }),
  paper: factorOf({ ...place, greedy_m: greedy?.published?.total_m ?? null }),
});

function Gait({ gait: { gait, learners, references }, place, high }) {
  const measure = { ...factorsOf(references.greedy, place), high };
  return html`
    <tbody role="rowgroup">
      ${DISTANCES.map(([distance, title, words], n) => html`
        <tr role="row">
          ${n === 0 && html`
            <th role="rowheader" class="gait-name" scope="rowgroup" rowspan="2">${gaitTitle(gait)}</th>
          `}
          <th role="rowheader" scope="row" class="distance" title=${words}>${title}</th>
          ${learners.map((one) => html`
            <${LearnerCell} key=${one.key} setting=${one} distance=${distance} greedy=${references.greedy}
              measure=${measure} />
          `)}
          ${REFERENCES.map((agent) => html`
            <${ReferenceCell} key=${agent} title=${agentOf(agent).title} setting=${references[agent]}
              distance=${distance} measure=${measure} />
          `)}
        </tr>
      `)}
    </tbody>
  `;
}

/** The end of all axes, so that strips can be compared. */
function highest(gaits, place) {
  const ends = gaits.flatMap(({ learners, references: { greedy } }) => {
    const { ours, paper } = factorsOf(greedy, place);
    const walked = [greedy, ...learners].flatMap((one) => one?.total?.points_m ?? []);
    const printed = [greedy, ...learners].map((one) => one?.published?.total_m);
    return [...walked.map((one) => inUnit(one, ours)), ...printed.map((one) => inUnit(one, paper))];
  });
  return 1.03 * largest(ends.filter((one) => one !== null), 1e-9);
}

const TIME_OUT = "At time-out: under the paper clock, when the first lane has used its steps.";
const NOTES = {
  m: `Metres over 50 steps. ${TIME_OUT}`,
  h: `h is half the side of the foot grid. ${TIME_OUT}`,
  greedy: "Share of greedy’s total distance in the same place; the paper’s values as a share of its own greedy’s.",
};
