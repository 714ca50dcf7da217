// Table 1 in the paper's layout, with every seed of this run.
import { useState } from "preact/hooks";
import { bare, factorOf, gaitsOf, inUnit, placesOf, shown, unit } from "../distances.js";
import { count, percentage, whole } from "../../../js/format.js";
import { largest } from "../../../js/scale.js";
import { agentOf } from "../../../js/settings.js";
import { gaitTitle } from "../../../js/titles.js";
import { DotStrip } from "../../../js/components/dot-strip.js";
import { html } from "../../../js/components/elements.js";
import { experimentKind } from "../kinds.js";
import { drawn } from "../printing.js";
import {
  BestKnownWords, PlaceSwitch, PlaceTitle, placeTitle, PlaceWords, StripKey, TableMenu, UnitSwitch,
} from "./report-tools.js";

/** @import { OnSeed } from "./all-findings.js" */
/** @import { Distances, Place, Setting, Summary } from "../../../js/types.js" */

/** @type {[Distance, string, string][]} */
const DISTANCES = [
  ["finished", "At time-out", "Distance at time-out: when the first lane has used its 50 steps"],
  ["total", "Total", "Distance after 50 steps of its own"],
];
/** @typedef {"finished" | "total"} Distance */
/** @typedef {ReturnType<typeof gaitsOf>[number]} GaitSettings */
/**
 * Factors of the unit for this run's distances and for the paper's, the end of the axis, and the best known distance.
 * @typedef {{ ours: number | null, paper: number | null, high: number, best: number | null }} Measure
 */
const REFERENCES = ["greedy", "two-step"];

/** @param {{ summary: Summary, onSeed: OnSeed | null }} props */
export function TableOne({ summary, onSeed }) {
  const places = placesOf(summary.settings);
  const [chosen, setChosen] = useState(/** @type {string | null} */ (null));
  const place = places.find(({ key }) => key === chosen) ?? places[0];
  const gaits = gaitsOf(summary.settings, place.key);
  return html`
    <section class="panel table-one" aria-labelledby="table-one">
      <div class="report-tools">
        <h2 id="table-one">Table 1, with every seed</h2>
        <${PlaceSwitch} places=${places} value=${place.key} onValue=${setChosen} />
        <${UnitSwitch} />
        <${TableMenu} title=${`Table 1, with every seed: ${placeTitle(place, places)}`} />
      </div>
      <${StripKey} color=${agentOf(gaits[0].learners[0]?.agent).color} />
      ${drawn(places, place).map((each) => html`
        <${InPlace} key=${each.key} summary=${summary} place=${each} places=${places} onSeed=${onSeed} />
      `)}
      <p class="dim table-note">${NOTES[unit.value]} ${PAPERS}</p>
      <${BestKnownWords} distances=${gaits.map(bestKnownOf)} />
    </section>
  `;
}

/** @param {{ summary: Summary, place: Place, places: Place[], onSeed: OnSeed | null }} props */
function InPlace({ summary, place, places, onSeed }) {
  const gaits = gaitsOf(summary.settings, place.key);
  const papers = experimentKind(summary.experiment)?.paper_gaits ?? {};
  const high = highest(gaits, place);
  return html`
    <${PlaceTitle} place=${place} places=${places} />
    <${PlaceWords} place=${place} />
    <table role="table">
      <caption class="sr-only">
        Distance at time-out and total distance of each gait and agent, beside the paper’s
      </caption>
      <${Head} learners=${gaits[0].learners} />
      ${gaits.map((settings) => html`
        <${Gait} key=${settings.gait} settings=${settings} paper=${papers[settings.gait]} place=${place} high=${high}
          onSeed=${onSeed} />
      `)}
    </table>
  `;
}

/** @param {{ learners: Setting[] }} props */
const Head = ({ learners }) => html`
  <thead role="rowgroup">
    <tr role="row">
      <th role="columnheader" scope="col">Gait</th>
      <th role="columnheader" scope="col">Distance</th>
      ${learners.map(({ agent, steps }) => html`
        <th role="columnheader" scope="col">${agentOf(agent).title}, ${whole(steps)} steps</th>
      `)}
      ${REFERENCES.map((agent) => html`<th role="columnheader" scope="col">${agentOf(agent).title}</th>`)}
      <th role="columnheader" scope="col">Best known</th>
    </tr>
  </thead>
`;

/** Of a gait in a place [m]. @param {GaitSettings} settings */
const bestKnownOf = ({ learners, references }) => (learners[0] ?? references.greedy)?.best_known_m ?? null;

/**
 * Factors from metres to the chosen unit: for this run's distances, and for the paper's.
 * @param {Setting | null | undefined} greedy
 * @param {Place} place
 */
const factorsOf = (greedy, place) => ({
  ours: factorOf({ ...place, greedy_m: greedy?.total?.mean_m ?? null }),
  paper: factorOf({ ...place, greedy_m: greedy?.published?.total_m ?? null }),
});

/**
 * `paper`: the paper's name of the gait.
 * @param {{ settings: GaitSettings, paper?: string, place: Place, high: number, onSeed: OnSeed | null }} props
 */
function Gait({ settings, paper, place, high, onSeed }) {
  const { gait, learners, references } = settings;
  const factors = factorsOf(references.greedy, place);
  const measure = { ...factors, high, best: inUnit(bestKnownOf(settings), factors.ours) };
  return html`
    <tbody role="rowgroup">
      ${DISTANCES.map(([distance, title, words], n) => html`
        <tr role="row">
          ${n === 0 && html`
            <th role="rowheader" class="gait-name" scope="rowgroup" rowspan="2">
              ${gaitTitle(gait)}${paper && html` <span class="dim">(${paper})</span>`}
            </th>
          `}
          <th role="rowheader" scope="row" class="distance" title=${words}>${title}</th>
          ${learners.map((setting) => html`
            <${LearnerCell} key=${setting.key} setting=${setting} distance=${distance} greedy=${references.greedy}
              measure=${measure} onSeed=${onSeed} />
          `)}
          ${REFERENCES.map((agent) => html`
            <${ReferenceCell} key=${agent} title=${agentOf(agent).title} setting=${references[agent]}
              distance=${distance} measure=${measure} />
          `)}
          <td role="cell" data-label="Best known" class="reference num">${bestWords(distance, measure)}</td>
        </tr>
      `)}
    </tbody>
  `;
}

/**
 * It is a distance after 50 steps, and has none at time-out.
 * @param {Distance} distance
 * @param {{ best: number | null }} other
 */
const bestOf = (distance, { best }) => (distance === "total" ? best : null);
/** @param {Distance} distance @param {{ best: number | null }} measure */
const bestWords = (distance, measure) => html`<b>${shown(bestOf(distance, measure))}</b>`;

/**
 * The end of all axes, so that strips can be compared.
 * @param {GaitSettings[]} gaits
 * @param {Place} place
 */
function highest(gaits, place) {
  const ends = gaits.flatMap((gait) => {
    const { learners, references: { greedy } } = gait;
    const { ours, paper } = factorsOf(greedy, place);
    const walked = [greedy, ...learners].flatMap((setting) => setting?.total?.points_m ?? []);
    const printed = [greedy, ...learners].map((setting) => setting?.published?.total_m);
    return [...walked, bestKnownOf(gait)].map((far) => inUnit(far, ours))
      .concat(printed.map((far) => inUnit(far, paper)));
  });
  return 1.03 * largest(ends.filter((end) => end !== null), 1e-9);
}

const TIME_OUT = "At time-out: under the paper clock, when the first lane has used its steps.";
/** @type {Record<string, string>} */
const NOTES = {
  m: `Metres over 50 steps. ${TIME_OUT}`,
  h: `h is half the side of the foot grid. ${TIME_OUT}`,
  greedy: "Share of greedy’s total distance in the same place; the paper’s values as a share of its own greedy’s.",
};

const PAPERS = `The paper’s values are of one run. †: outside the central 95 % of the seeds here. Agents that look
  ahead throw no dice: one walk is enough.`;

// ---- cells: the seeds of this run as a strip, and the paper's value

/**
 * `measure`: {ours, paper, high, best}: factors of the unit, the end of the axis, and the best known distance.
 * @param {{
 *   setting: Setting, distance: Distance, greedy: Setting | null, measure: Measure, onSeed: OnSeed | null
 * }} props
 */
function LearnerCell({ setting, distance, greedy, measure, onSeed }) {
  const label = `${agentOf(setting.agent).title}, ${count(setting.steps, "step")}`;
  if (!setting[distance] || measure.ours === null) return html`<${EmptyCell} label=${label} />`;
  const shares = inUnits({ setting, distance, greedy, measure });
  const { typical, points, printed, marks } = shares;
  const show = onSeed && ((/** @type {number} */ n) => onSeed(setting, setting.total?.points_m[n] ?? NaN));
  return html`
    <td role="cell" class="learner" data-label=${label}>
      <p class="cell-words num"><b>${shown(typical.iqm)}</b> <span class="dim">${intervalOf(typical)}</span></p>
      <${DotStrip} label=${captionOf(shares)} points=${points} high=${measure.high} typical=${typical} marks=${marks}
        color=${agentOf(setting.agent).color} axis=${shown}
        onDot=${distance === "total" ? show : null} />
      <${Published} value=${printed} quantile=${setting.published?.[`${distance}_quantile`] ?? null} />
    </td>
  `;
}

/** @param {{ label: string }} props */
const EmptyCell = ({ label }) => html`
  <td role="cell" data-label=${label} class="learner empty-cell">
    <span class="dim">waiting for its first seed</span>
  </td>
`;

/**
 * The distances of a cell in the chosen unit.
 * @param {{ setting: Setting, distance: Distance, greedy: Setting | null, measure: Measure }} cell
 */
function inUnits({ setting, distance, greedy, measure }) {
  const ours = /** @type {Distances} */ (setting[distance]);
  /** @param {number | null | undefined} metres */
  const converted = (metres) => inUnit(metres, measure.ours);
  const line = converted(greedy?.[distance]?.mean_m ?? null);
  const printed = inUnit(setting.published?.[`${distance}_m`] ?? null, measure.paper);
  const best = bestOf(distance, measure);
  const marks = [
    { value: line, kind: "greedy" }, { value: best, kind: "best-known" }, { value: printed, kind: "published" },
  ];
  return {
    line,
    best,
    printed,
    marks: marks.filter(({ value }) => value !== null),
    points: ours.points_m.map((metres) => metres * (measure.ours ?? NaN)),
    typical: { iqm: converted(ours.iqm_m), low: converted(ours.low_m), high: converted(ours.high_m) },
  };
}

/** @param {{ low: number | null, high: number | null }} typical */
const intervalOf = ({ low, high }) => (low === null ? "" : `${bare(low)} – ${bare(high)}`);

/** @param {ReturnType<typeof inUnits>} shares */
function captionOf({ points, typical, line, best, printed }) {
  const interval = intervalOf(typical);
  const lowest = -largest(points.map((point) => -point), -Infinity);
  return [
    `${count(points.length, "seed")} from ${shown(lowest)} to ${shown(largest(points, -Infinity))}`,
    `typically ${shown(typical.iqm)}${interval && `, 95 % interval ${interval}`}`,
    line !== null && `greedy ${shown(line)}`,
    best !== null && `best known ${shown(best)}`,
    printed !== null && `the paper ${shown(printed)}`,
  ].filter(Boolean).join("; ");
}

/** Whether a printed value is outside the central 95 % of the seeds. @param {number} quantile */
const isOutside = (quantile) => quantile < 0.025 || quantile > 0.975;

/** @param {{ value: number | null, quantile: number | null }} props */
function Published({ value, quantile }) {
  if (value === null) return null;
  const above = quantile === null ? "" : `, above ${percentage(quantile)} of seeds${isOutside(quantile) ? " †" : ""}`;
  return html`<p class="printed dim num">paper ${shown(value)}${above}</p>`;
}

/**
 * Agents that look ahead do the same with every seed.
 * @param {{ title: string, setting: Setting | null, distance: Distance, measure: Measure }} props
 */
function ReferenceCell({ title, setting, distance, measure }) {
  const ours = inUnit(setting?.[distance]?.mean_m ?? null, measure.ours);
  const printed = inUnit(setting?.published?.[`${distance}_m`] ?? null, measure.paper);
  const isUnfinished = setting?.published && setting.published[`${distance}_m`] === null;
  return html`
    <td role="cell" data-label=${title} class="reference num">
      <b>${shown(ours)}</b>
      ${printed !== null && html`<span class="dim printed">paper ${shown(printed)}</span>`}
      ${isUnfinished && html`<span class="dim printed">paper: unfinished</span>`}
    </td>
  `;
}
