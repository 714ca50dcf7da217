// Table 1 in the paper's own shape, each of its numbers among all of ours.
import { useState } from "preact/hooks";
import { html } from "../../html.js";
import { whole } from "../../format.js";
import { agentOf } from "../../selectors.js";
import { gaitsOf, placesOf } from "../../experiments/places.js";
import { gaitTitle } from "../../experiments/titles.js";
import { factorOf, inUnit, unit } from "../../experiments/units.js";
import { largest } from "../../scale.js";
import { PlaceSwitch, PlaceWords } from "./place-switch.js";
import { StripKey } from "./strip-key.js";
import { LearnerCell, ReferenceCell } from "./table-one-cells.js";
import { UnitSwitch } from "./unit-switch.js";

const DISTANCES = [["finished", "Finished", "Where it is when the first robot has taken its 50 steps"], ["total", "Total", "After 50 steps of its own"]];
const REFERENCES = [["greedy", "Greedy"], ["two-step", "Two-step"]];

export function TableOne({ known }) {
  const places = placesOf(known.settings);
  const [wish, setWish] = useState(null);
  const place = places.find(({ key }) => key === wish) ?? places[0];
  const gaits = gaitsOf(known.settings, place.key);
  const steps = gaits[0].learners.map((one) => one.steps);
  return html`
    <section class="panel table-one" aria-labelledby="table-one">
      <div class="report-tools">
        <h2 id="table-one">Table 1, with every seed</h2>
        <${PlaceSwitch} places=${places} value=${place.key} onValue=${setWish} />
        <${UnitSwitch} />
      </div>
      <${PlaceWords} place=${place} />
      <${StripKey} color=${agentOf("q-learning").color} />
      <table role="table">
        <caption class="sr-only">Finished and total distance of each gait and agent, ours beside the published</caption>
        <thead role="rowgroup">
          <tr role="row">
            <th role="columnheader" scope="col">Gait</th>
            <th role="columnheader" scope="col">Distance</th>
            ${steps.map((n) => html`<th role="columnheader" scope="col">Q-learning, ${whole(n)} steps</th>`)}
            ${REFERENCES.map(([, title]) => html`<th role="columnheader" scope="col">${title}</th>`)}
          </tr>
        </thead>
        ${gaits.map((one) => html`<${Gait} key=${one.gait} gait=${one} place=${place} high=${highest(gaits, place)} />`)}
      </table>
      <${Note} />
    </section>
  `;
}

function Gait({ gait: { gait, learners, references }, place, high }) {
  const greedy_m = references.greedy?.total?.mean_m ?? null;
  const published_m = references.greedy?.published?.total_m ?? null;
  const measure = {
    ours: factorOf({ ...place, greedy_m }), paper: factorOf({ ...place, greedy_m: published_m }), high,
  };
  return html`
    <tbody role="rowgroup">
      ${DISTANCES.map(([distance, title, words], n) => html`
        <tr role="row">
          ${n === 0 && html`<th role="rowheader" class="gait-name" scope="rowgroup" rowspan="2">${gaitTitle(gait)}</th>`}
          <th role="rowheader" scope="row" class="distance" title=${words}>${title}</th>
          ${learners.map((one) => html`<${LearnerCell} key=${one.key} setting=${one} distance=${distance} greedy=${references.greedy} measure=${measure} />`)}
          ${REFERENCES.map(([agent, name]) => html`<${ReferenceCell} key=${agent} title=${name} setting=${references[agent]} distance=${distance} measure=${measure} />`)}
        </tr>
      `)}
    </tbody>
  `;
}

/** Where all axes end, so that all strips can be compared. */
function highest(gaits, place) {
  const ends = gaits.flatMap(({ learners, references }) => {
    const greedy_m = references.greedy?.total?.mean_m ?? null;
    const factor = factorOf({ ...place, greedy_m });
    const paper = factorOf({ ...place, greedy_m: references.greedy?.published?.total_m ?? null });
    const ours = [references.greedy, ...learners].flatMap((one) => one?.total?.points_m ?? []);
    const printed = [references.greedy, ...learners].map((one) => one?.published?.total_m);
    return [...ours.map((one) => inUnit(one, factor)), ...printed.map((one) => inUnit(one, paper))];
  });
  return 1.03 * largest(ends.filter((one) => one !== null), 1e-9);
}

const NOTES = {
  m: "Metres over 50 steps. Finished: where it is, under the paper’s clock, when the first robot has taken its steps.",
  h: "h is half the side of the foot grid. Finished: where it is, under the paper’s clock, when the first robot has taken its steps.",
  greedy: "Ours as a share of our greedy’s total distance in the same place, the paper’s as a share of its greedy’s.",
};

const Note = () => html`<p class="dim table-note">${NOTES[unit.value]}</p>`;
