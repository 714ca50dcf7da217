// All gaits together: how near learners come to greedy, how many walk, how often they win.
import { useMemo } from "preact/hooks";
import { whole } from "../../format.js";
import { html } from "../../html.js";
import { agentOf } from "../../selectors.js";
import { greedyTotals, placeOf } from "../../experiments/places.js";
import { FIELD_TITLES, observationTitle, robotTitle, valueTitle } from "../../experiments/titles.js";
import { GRID } from "../../experiments/catalogue.js";
import { largest } from "../../scale.js";
import { DotStrip } from "../dot-strip.js";

const RACED = "Beat it at the finish";
const COLUMNS = [
  { title: "What" },
  { title: "Share of greedy’s distance", kind: "wide-cell" },
  { title: "Typical", words: "Interquartile mean, with its 95 % interval" },
  { title: "Walk", words: "Come at least half as far as greedy" },
  { title: "Reach greedy", words: "Come at least 95 % as far" },
  { title: RACED, words: "Under the paper’s clock" },
];
const MARKS = [{ value: 1, kind: "greedy" }, { value: 0.5, kind: "half" }];
const ALIKE = ["agent", ...GRID];
const RATES = GRID.filter((field) => field !== "steps");

export function AtAGlance({ known }) {
  const pooled = (known.pooled ?? []).filter(({ relative }) => relative);
  const points = useMemo(() => pooled.map((one) => pointsOf(known.settings, one)), [known]);
  if (!pooled.length || (pooled.length === 1 && pooled[0].gaits.length === 1)) return null;
  const high = 1.03 * largest(points.flat(), 1);
  const isRaced = pooled.some(({ relative_finished }) => relative_finished);
  return html`
    <section class="panel glance" aria-labelledby="glance">
      <h2 id="glance">All gaits together</h2>
      <p class="dim">Total distance as a share of greedy’s in the same place; who gets half as far walks.</p>
      <div class="scroller tall" tabindex="0" role="region" aria-label="Table of all gaits together">
        <table class="facts-table stacking" role="table">
          <thead role="rowgroup"><tr role="row">
            ${COLUMNS.filter(({ title }) => isRaced || title !== RACED).map(({ title, words, kind }) => html`
              <th role="columnheader" scope="col" class=${kind} title=${words}>${title}</th>
            `)}
          </tr></thead>
          <tbody role="rowgroup">${pooled.map((one, n) => html`<${Row} key=${n} one=${one} all=${pooled} points=${points[n]} high=${high} isRaced=${isRaced} />`)}</tbody>
        </table>
      </div>
    </section>
  `;
}

function Row({ one, all, points, high, isRaced }) {
  const share = (value) => `${Math.round(100 * value)} %`;
  const { iqm, low } = one.relative;
  const label = `${points.length} seeds, typically ${share(iqm)} of greedy’s distance`;
  return html`
    <tr role="row">
      <th role="rowheader" scope="row">${nameOf(one, all)}</th>
      <td role="cell" class="wide-cell">
        <${DotStrip} label=${label} points=${points} high=${high} typical=${one.relative} marks=${MARKS}
          color=${agentOf(one.agent).color} height=${44} />
      </td>
      <td role="cell" data-label="Typical" class="num">
        <b>${share(iqm)}</b>${low !== null && html`<br /><span class="dim">${Math.round(100 * low)} – ${share(one.relative.high)}</span>`}
      </td>
      <td role="cell" data-label="Walk" class="num">${share(one.walkers.share)}</td>
      <td role="cell" data-label="Reach greedy" class="num">${share(one.reaches_greedy.share)}</td>
      ${isRaced && html`<td role="cell" data-label=${RACED} class="num">${one.beats_greedy ? html`${share(one.beats_greedy.share)}<br /><span class="dim">${WORDS[one.beats_greedy.verdict]}</span>` : "–"}</td>`}
    </tr>
  `;
}

const WORDS = { yes: "more often than not", no: "less often than not", "not established": "not established" };

/** What tells it from the others. */
function nameOf(one, all) {
  const differs = (field) => new Set(all.map((other) => other[field])).size > 1;
  const where = [observationTitle(one.observation), differs("robot") && robotTitle(one.robot).toLowerCase()];
  const who = [differs("agent") && valueTitle("agent", one.agent), one.blocks === 1 && differs("steps") && `${whole(one.steps)} steps`];
  const rates = RATES.filter(differs).map((field) => `${FIELD_TITLES[field]}\u00a0${one[field]}`);
  if (rates.length && !differs("observation")) where.shift();
  return [...who, ...where, ...rates].filter(Boolean).join(", ");
}

/** Every seed of the gaits that were put together, in shares of greedy. */
function pointsOf(settings, one) {
  const greedy = greedyTotals(settings);
  return settings
    .filter((setting) => setting.role === "learner" && placeOf(setting) === placeOf(one) && ALIKE.every((field) => setting[field] === one[field]))
    .flatMap((setting) => (greedy(setting) ? (setting.total?.points_m ?? []).map((metres) => metres / greedy(setting)) : []));
}
