// Every setting of a grid with its seeds: what it varies, how far it gets, how many walk.
import { useState } from "preact/hooks";
import { html } from "../../html.js";
import { agentOf } from "../../selectors.js";
import { greedyTotals } from "../../experiments/places.js";
import { GRID } from "../../experiments/catalogue.js";
import { FIELD_TITLES, valueTitle } from "../../experiments/titles.js";
import { bare, factorOf, inUnit, shown } from "../../experiments/units.js";
import { largest } from "../../scale.js";
import { DotStrip } from "../dot-strip.js";
import { Segments } from "../segments.js";
import { StripKey } from "./strip-key.js";
import { UnitSwitch } from "./unit-switch.js";

const FIELDS = ["gait", "observation", "robot", "agent", ...GRID];
const ORDERS = [["grid", "In the grid’s order"], ["best", "Furthest first"]];
const MOST_ROWS = 60;

export function SweepTable({ known }) {
  const [order, setOrder] = useState("grid");
  const [isWhole, setWhole] = useState(false);
  const greedy = greedyTotals(known.settings);
  const rows = shownOf(known.settings).map((setting) => measured(setting, greedy(setting)));
  const varied = FIELDS.filter((field) => new Set(rows.map(({ setting }) => setting[field]).filter((one) => one !== null)).size > 1);
  const columns = varied.length ? varied : ["gait"];
  const sorted = order === "best" ? [...rows].sort((a, b) => (b.typical?.iqm ?? -1) - (a.typical?.iqm ?? -1)) : rows;
  const high = 1.03 * largest(rows.flatMap(({ points, line }) => [line ?? 0, ...points]), 1e-9);
  const color = rows[0] && agentOf(rows[0].setting.agent).color;
  return html`
    <section class="panel sweep-table" aria-labelledby="sweep-table">
      <div class="report-tools">
        <h2 id="sweep-table">Every setting, with every seed</h2>
        <${Segments} label="Order" choices=${ORDERS} value=${order} onValue=${setOrder} />
        <${UnitSwitch} />
      </div>
      <${StripKey} signs=${["seed", "typical", "greedy"]} color=${color} />
      <div class="scroller tall" tabindex="0" role="region" aria-label="Every setting">
        <table class="facts-table stacking" role="table">
          <thead role="rowgroup"><tr role="row">${columns.map((field) => html`<th role="columnheader" scope="col">${FIELD_TITLES[field]}</th>`)}
            <th role="columnheader" scope="col" class="wide-cell">Total distance, 50 steps</th>
            <th role="columnheader" scope="col" title="Interquartile mean, with its 95 % interval">Typical</th>
            <th role="columnheader" scope="col" title="Come at least half as far as greedy">Walk</th>
          </tr></thead>
          <tbody role="rowgroup">
            ${(isWhole ? sorted : sorted.slice(0, MOST_ROWS)).map((row) => html`
              <${Row} key=${row.setting.key} row=${row} varied=${columns} high=${high} />
            `)}
          </tbody>
        </table>
      </div>
      ${!isWhole && sorted.length > MOST_ROWS && html`<div class="older"><button class="secondary" onClick=${() => setWhole(true)}>Show all ${sorted.length} settings</button></div>`}
    </section>
  `;
}

/** Who learns, and who looks ahead; greedy is the line that all have, unless there is nobody else. */
function shownOf(settings) {
  const shown = settings.filter(({ role, agent }) => role === "learner" || agent !== "greedy");
  return shown.length ? shown : settings;
}

/** A setting with its distances in the chosen unit. */
function measured(setting, greedy_m) {
  const factor = factorOf({ ...setting, greedy_m });
  const total = factor === null ? null : setting.total;
  const own = (metres) => inUnit(metres, factor);
  return {
    setting,
    points: (total?.points_m ?? []).map(own),
    typical: total && { iqm: own(total.iqm_m), low: own(total.low_m), high: own(total.high_m) },
    line: own(greedy_m),
  };
}

function Row({ row: { setting, points, typical, line }, varied, high }) {
  const label = typical ? `${points.length} seeds, typically ${shown(typical.iqm)}, greedy ${shown(line)}` : "no seed yet";
  const [first, ...others] = varied.map((field) => [FIELD_TITLES[field], valueTitle(field, setting[field])]);
  return html`
    <tr role="row">
      <th role="rowheader" scope="row">${first[1]}</th>${others.map(([title, one]) => html`<td role="cell" data-label=${title} class="num">${one}</td>`)}
      <td role="cell" class="wide-cell">${typical ? html`<${DotStrip} label=${label} points=${points} high=${high} typical=${typical} marks=${line === null ? [] : [{ value: line, kind: "greedy" }]} color=${agentOf(setting.agent).color} />` : html`<span class="dim">waits for its first seed</span>`}</td>
      <td role="cell" data-label="Typical" class="num"><b>${shown(typical?.iqm)}</b>${typical && typical.low !== null && html`<br /><span class="dim">${bare(typical.low)} – ${bare(typical.high)}</span>`}</td>
      <td role="cell" data-label="Walk" class="num">${setting.walkers ? `${Math.round(100 * setting.walkers.share)} %` : "–"}</td>
    </tr>
  `;
}
