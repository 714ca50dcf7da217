// The charts and tables of a result, with the switches of what they show; on paper all that these choose from.
import { useState } from "preact/hooks";
import { worldTitle } from "../../../js/disturbances.js";
import { Chart } from "../../../js/components/charts.js";
import { html, Segments } from "../../../js/components/elements.js";
import { isPrinting } from "../printing.js";
import { OVERVIEW_TITLE } from "../result-worlds.js";
import { overviewOf, resultOf } from "../results.js";
import { AgentKey, LevelKey, placeTitle, PlaceWords, StripKey, UnitSwitch } from "./report-tools.js";
import { ResultTable } from "./result-table.js";

/** @import { OnSeed } from "./all-findings.js" */
/** @import { CurveChart } from "../result-curves.js" */
/** @import { Case, Result } from "../results.js" */
/** @import { Place, Summary } from "../../../js/types.js" */

/** @type {Record<string, string>} */
const ORDERS = { grid: "In the grid’s order", best: "Farthest first" };

/** @param {{ summary: Summary, onSeed: OnSeed | null }} props */
export function ResultPanels({ summary, onSeed }) {
  const [chosen, setChosen] = useState({ world: /** @type {string | null} */ (null), place: "", order: "grid" });
  const result = resultOf(summary);
  if (!result?.cases.length) return null;
  const { cases, orders = [] } = result;
  const inWorld = cases.filter(({ world }) => world === chosen.world);
  const inChosenWorld = inWorld.length ? inWorld : cases.filter(({ world }) => world === cases[0].world);
  const shown = inChosenWorld.find(({ place }) => place?.key === chosen.place) ?? inChosenWorld[0];
  const overview = overviewOf(summary, shown.place);
  /** @type {(field: string) => (value: string) => void} */
  const choose = (field) => (value) => setChosen({ ...chosen, world: shown.world, [field]: value });
  return html`
    <section class="panel result" aria-labelledby="result">
      <div class="report-tools">
        <h2 id="result">${result.title}</h2>
        <${Switch} label="World" value=${shown.world} onValue=${choose("world")}
          choices=${[...new Set(cases.map(({ world }) => world))].map((world) => [world, worldTitle(world ?? "")])} />
        <${Switch} label="Place" value=${shown.place?.key} onValue=${choose("place")}
          choices=${inChosenWorld.map(({ place }) => [place?.key, titleIn(inChosenWorld, place)])} />
        <${Switch} label="Order" value=${chosen.order} onValue=${choose("order")}
          choices=${orders.map((order) => [order, ORDERS[order]])} />
        <${UnitSwitch} />
      </div>
      ${result.signs.length > 0 && html`<${StripKey} signs=${result.signs} color=${result.color} />`}
      ${result.agents.length > 0 && html`
        <${AgentKey} agents=${result.agents}><${LevelKey} levels=${result.levels} /><//>
      `}
      ${(isPrinting.value ? cases : [shown]).map((entry) => html`
        <${CaseResult} key=${`${entry.world} ${entry.place?.key}`} result=${result} entry=${entry}
          order=${chosen.order} onSeed=${onSeed} />
      `)}
      ${result.notes.filter(Boolean).map((note) => html`<p class="dim table-note">${note}</p>`)}
    </section>
    ${overview && html`
      <section class="panel" aria-labelledby="all-worlds">
        <h2 id="all-worlds">${OVERVIEW_TITLE}</h2>
        <p class="dim small-words">In the end, as a mean over the gaits; the farthest of each world is bold.</p>
        <${ResultTable} table=${overview} />
      </section>
    `}
  `;
}

/**
 * A switch, where there is a choice.
 * @param {{ label: string, choices: [unknown, string][], value: unknown, onValue: (value: string) => void }} props
 */
const Switch = ({ choices, ...props }) =>
  choices.length > 1 && html`<${Segments} choices=${choices} ...${props} />`;

/** @param {Case[]} cases @param {Place | null} place */
const titleIn = (cases, place) =>
  place && placeTitle(place, cases.flatMap((entry) => entry.place ?? []));

/** @param {{ result: Result, entry: Case, order: string, onSeed: OnSeed | null }} props */
function CaseResult({ result, entry, order, onSeed }) {
  const { world, place } = entry;
  const { charts, tables } = result.contentOf(entry, { order });
  const about = result.about(entry);
  const inWorld = result.cases.filter((other) => other.world === world);
  const names = [
    inWorld.length < result.cases.length && worldTitle(world ?? ""), inWorld.length > 1 && titleIn(inWorld, place),
  ].filter(Boolean).join(": ");
  return html`
    ${isPrinting.value && result.cases.length > 1 && html`<h3 class="place-title">${names}</h3>`}
    ${about && html`<p class="dim small-words">${about}</p>`}
    ${place && html`<${PlaceWords} place=${place} />`}
    ${charts.length > 0 && html`
      <div class=${`gait-panels ${charts.length > 1 ? "" : "alone"}`}>
        ${charts.map((chart) => html`<${CurveFigure} key=${chart.title} chart=${chart} />`)}
      </div>
    `}
    ${tables.map((table) => html`
      <${ResultTable} key=${table.caption} table=${table} onSeed=${onSeed}
        name=${[result.title, names].filter(Boolean).join(": ")} />
    `)}
  `;
}

/** @param {{ chart: CurveChart }} props */
const CurveFigure = ({ chart: { title, note, ...chart } }) => html`
  <figure>
    <figcaption><b>${title}</b><span class="dim num">${note}</span></figcaption>
    <${Chart} name=${title} ...${chart} />
  </figure>
`;
