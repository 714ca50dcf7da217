// The settings of a sweep with every seed: the fields that vary, distances, share that walks.
import { useState } from "preact/hooks";
import { bare, factorOf, greedyTotals, inUnit, shown } from "../distances.js";
import { count, percentage } from "../../../js/format.js";
import { largest } from "../../../js/scale.js";
import { agentOf } from "../../../js/settings.js";
import { served } from "../../../js/options.js";
import { fieldTitle, isNamedByValue, valueTitle, variedFields } from "../../../js/titles.js";
import { DotStrip } from "../../../js/components/dot-strip.js";
import { html, Segments } from "../../../js/components/elements.js";
import { isPrinting } from "../printing.js";
import { BestKnownWords, StripKey, TableMenu, UnitSwitch } from "./report-tools.js";

/** @import { OnSeed } from "./all-findings.js" */
/** @import { Setting, Summary } from "../../../js/types.js" */

const ORDERS = [["grid", "In the grid’s order"], ["best", "Farthest first"]];
const MAX_ROWS = 60;
/** @typedef {ReturnType<typeof measured>} Measured */
const TITLE = "Every setting, with every seed";
const STRIP_TITLE = "Total distance in 50 steps, a dot for each seed";

/** @param {{ summary: Summary, onSeed: OnSeed | null }} props */
export function SweepTable({ summary, onSeed }) {
  const [order, setOrder] = useState("grid");
  const [isWhole, setWhole] = useState(false);
  const greedy = greedyTotals(summary.settings);
  const rows = shownSettings(summary.settings).map((setting) => measured(setting, greedy(setting)));
  const columns = columnsOf(rows, summary.parameters);
  const sorted = order === "best" ? [...rows].sort(byDistance) : rows;
  const hasBest = rows.some(({ best }) => best !== null);
  const high = 1.03 * largest(rows.flatMap(({ points, line, best }) => [line ?? 0, best ?? 0, ...points]), 1e-9);
  const agents = [...new Set(rows.map(({ setting }) => setting.agent))];
  const color = agents.length === 1 ? agentOf(agents[0]).color : "var(--dim)";
  return html`
    <section class="panel sweep-table" aria-labelledby="sweep-table">
      <div class="report-tools">
        <h2 id="sweep-table">${TITLE}</h2>
        <${Segments} label="Order" choices=${ORDERS} value=${order} onValue=${setOrder} />
        <${UnitSwitch} />
        <${TableMenu} title=${TITLE} />
      </div>
      <${StripKey} signs=${["seed", "typical", "greedy", ...(hasBest ? ["best-known"] : [])]} color=${color} />
      <div class="scroller" tabindex="0" role="region" aria-label="Every setting">
        <table class="facts-table stacking" role="table">
          <caption class="sr-only">${TITLE}</caption>
          <${Head} columns=${columns} hasBest=${hasBest} />
          <tbody role="rowgroup">
            ${(isWhole || isPrinting.value ? sorted : sorted.slice(0, MAX_ROWS)).map((row) => html`
              <${Row} key=${row.setting.key} row=${row} columns=${columns} high=${high} hasBest=${hasBest}
                onSeed=${onSeed} />
            `)}
          </tbody>
        </table>
      </div>
      ${!isWhole && !isPrinting.value && sorted.length > MAX_ROWS && html`
        <div class="older">
          <button class="secondary" onClick=${() => setWhole(true)}>Show all ${count(sorted.length, "setting")}</button>
        </div>
      `}
      ${hasBest && html`<${BestKnownWords} distances=${rows.map(({ setting }) => setting.best_known_m)} />`}
    </section>
  `;
}

/** @param {Measured} a @param {Measured} b */
const byDistance = (a, b) => (b.typical?.iqm ?? -1) - (a.typical?.iqm ?? -1);

/**
 * The fields in which the settings differ; the gait where they do not.
 * @param {Measured[]} rows
 * @param {string[]} parameters
 */
function columnsOf(rows, parameters) {
  const fields = ["gait", "observation", "robot", "agent", ...parameters];
  const varied = variedFields(rows.map(({ setting }) => setting), fields);
  return varied.length ? varied : ["gait"];
}

/** Without greedy, which is a line in every row, unless there is nothing else. @param {Setting[]} settings */
function shownSettings(settings) {
  const compared = settings.filter(({ role, agent }) => role === "learner" || agent !== "greedy");
  return compared.length ? compared : settings;
}

/**
 * A setting with its distances in the chosen unit.
 * @param {Setting} setting
 * @param {number | null} greedy_m
 */
function measured(setting, greedy_m) {
  const factor = factorOf({ ...setting, greedy_m });
  const total = factor === null ? null : setting.total;
  /** @param {number | null | undefined} metres */
  const converted = (metres) => inUnit(metres, factor);
  const ofSeed = (/** @type {number} */ metres) => metres * (factor ?? NaN);
  return {
    setting,
    points: (total?.points_m ?? []).map(ofSeed),
    typical: total && { iqm: ofSeed(total.iqm_m), low: converted(total.low_m), high: converted(total.high_m) },
    line: converted(greedy_m),
    best: converted(setting.best_known_m),
  };
}

/** @param {{ columns: string[], hasBest: boolean }} props */
const Head = ({ columns, hasBest }) => html`
  <thead role="rowgroup">
    <tr role="row">
      <th role="columnheader" scope="col">${columns.map(fieldTitle).join(", ")}</th>
      <th role="columnheader" scope="col" class="wide-cell">${STRIP_TITLE}</th>
      <th role="columnheader" scope="col" title="Interquartile mean, with its 95 % interval">Interquartile mean</th>
      <th role="columnheader" scope="col" title="Get at least half as far as greedy">Share that walks</th>
      ${hasBest && html`<th role="columnheader" scope="col" title=${served().help.best_known}>Best known</th>`}
    </tr>
  </thead>
`;

/**
 * Varied settings, with their values: "Sarsa(λ), α 0.1".
 * @param {Setting} setting
 * @param {string[]} columns
 */
const nameOf = (setting, columns) =>
  columns.filter((field) => setting[field] !== null && setting[field] !== undefined)
    .map((field) => (isNamedByValue(field) ? "" : `${fieldTitle(field)}\u00a0`) + valueTitle(field, setting[field]))
    .join(", ");

/** @param {{ row: Measured, columns: string[], high: number, hasBest: boolean, onSeed: OnSeed | null }} props */
function Row({ row, columns, high, hasBest, onSeed }) {
  const { setting, typical, best } = row;
  return html`
    <tr role="row">
      <th role="rowheader" scope="row" class="num">${nameOf(setting, columns)}</th>
      <td role="cell" class="wide-cell" data-label=${STRIP_TITLE}>
        ${typical
          ? html`<${Strip} row=${row} high=${high} onSeed=${onSeed} />`
          : html`<span class="dim">waiting for its first seed</span>`}
      </td>
      <td role="cell" data-label="Interquartile mean" class="num"><${Typical} typical=${typical} /></td>
      <td role="cell" data-label="Share that walks" class="num">
        ${setting.walkers ? percentage(setting.walkers.share) : "–"}
      </td>
      ${hasBest && html`<td role="cell" data-label="Best known" class="num">${shown(best)}</td>`}
    </tr>
  `;
}

/** @param {{ row: Measured, high: number, onSeed: OnSeed | null }} props */
function Strip({ row: { setting, points, typical, line, best }, high, onSeed }) {
  const bestKnown = best === null ? "" : `, best known ${shown(best)}`;
  const label = `${count(points.length, "seed")}, typically ${shown(typical?.iqm)}, greedy ${shown(line)}${bestKnown}`;
  const marks = [{ value: line, kind: "greedy" }, { value: best, kind: "best-known" }]
    .filter(({ value }) => value !== null);
  return html`
    <${DotStrip} label=${label} points=${points} high=${high} typical=${typical} marks=${marks}
      color=${agentOf(setting.agent).color} axis=${shown}
      onDot=${onSeed && ((/** @type {number} */ n) => onSeed(setting, setting.total?.points_m[n] ?? NaN))} />
  `;
}

/** @param {{ typical: Measured["typical"] }} props */
const Typical = ({ typical }) => html`
  ${shown(typical?.iqm)}${typical && typical.low !== null && html`
    <br /><span class="dim">${bare(typical.low)} – ${bare(typical.high)}</span>
  `}
`;
