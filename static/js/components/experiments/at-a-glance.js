// All gaits together: how near learners come to greedy, how many walk, how often they beat it at time-out.
import { useMemo } from "preact/hooks";
import { agentOf } from "../../agents.js";
import { percentage, whole } from "../../format.js";
import { html } from "../../html.js";
import { greedyTotals, placeOf } from "../../experiments/places.js";
import { agentTitle, fieldTitle, variedFields } from "../../experiments/titles.js";
import { largest } from "../../scale.js";
import { observationTitle, robotTitle } from "../../titles.js";
import { DotStrip } from "../dot-strip.js";

const BEATS_GREEDY = "Beats it at time-out";
const COLUMNS = [
  { title: "Setting" },
  { title: "Share of greedy’s distance", kind: "wide-cell" },
  { title: "Typical", words: "Interquartile mean, with its 95 % interval" },
  { title: "Walk", words: "Get at least half as far as greedy" },
  { title: "Reach greedy", words: "Get at least 95 % as far" },
  { title: BEATS_GREEDY, words: "Under the paper clock" },
];
const MARKS = [{ value: 1, kind: "greedy" }, { value: 0.5, kind: "half" }];
const VERDICTS = { yes: "more often than not", no: "less often than not", "not established": "not established" };

export function AtAGlance({ known }) {
  const pooled = (known.pooled ?? []).filter(({ relative }) => relative);
  const points = useMemo(() => pooled.map((one) => pointsOf(known, one)), [known]);
  if (!pooled.length || (pooled.length === 1 && pooled[0].gaits.length === 1)) return null;
  const high = 1.03 * largest(points.flat(), 1);
  const varied = variedFields(pooled, ["agent", "observation", "robot", ...known.parameters]);
  const isRaced = pooled.some(({ relative_finished }) => relative_finished);
  return html`
    <section class="panel glance" aria-labelledby="glance">
      <h2 id="glance">All gaits together</h2>
      <p class="dim">Total distance as a share of greedy’s in the same place; a robot that gets half as far walks.</p>
      <div class="scroller tall" tabindex="0" role="region" aria-label="Table of all gaits together">
        <table class="facts-table stacking" role="table">
          <thead role="rowgroup"><tr role="row">
            ${COLUMNS.filter(({ title }) => isRaced || title !== BEATS_GREEDY).map(({ title, words, kind }) => html`
              <th role="columnheader" scope="col" class=${kind} title=${words}>${title}</th>
            `)}
          </tr></thead>
          <tbody role="rowgroup">
            ${pooled.map((one, n) => html`
              <${Row} key=${n} one=${one} varied=${varied} points=${points[n]} high=${high} isRaced=${isRaced} />
            `)}
          </tbody>
        </table>
      </div>
    </section>
  `;
}

function Row({ one, varied, points, high, isRaced }) {
  const { iqm, low } = one.relative;
  const interval = low === null ? null : `${Math.round(100 * low)} – ${percentage(one.relative.high)}`;
  const label = `${points.length} seeds, typically ${percentage(iqm)} of greedy’s distance`;
  return html`
    <tr role="row">
      <th role="rowheader" scope="row">${nameOf(one, varied)}</th>
      <td role="cell" class="wide-cell">
        <${DotStrip} label=${label} points=${points} high=${high} typical=${one.relative} marks=${MARKS}
          color=${agentOf(one.agent).color} height=${44} />
      </td>
      <td role="cell" data-label="Typical" class="num">
        <b>${percentage(iqm)}</b>${interval && html`<br /><span class="dim">${interval}</span>`}
      </td>
      <td role="cell" data-label="Walk" class="num">${percentage(one.walkers.share)}</td>
      <td role="cell" data-label="Reach greedy" class="num">${percentage(one.reaches_greedy.share)}</td>
      ${isRaced && html`
        <td role="cell" data-label=${BEATS_GREEDY} class="num"><${Beats} beats=${one.beats_greedy} /></td>
      `}
    </tr>
  `;
}

const Beats = ({ beats }) =>
  beats ? html`${percentage(beats.share)}<br /><span class="dim">${VERDICTS[beats.verdict]}</span>` : "–";

/** Fields that have words of their own in the name of a row. */
const NAMED_APART = ["agent", "observation", "robot", "steps"];

/** The fields in which a row differs from the others. */
function nameOf(one, varied) {
  const differs = (field) => varied.includes(field);
  const agent = [
    differs("agent") && agentTitle(one.agent),
    one.blocks === 1 && differs("steps") && `${whole(one.steps)} steps`,
  ];
  const place = [observationTitle(one.observation), differs("robot") && robotTitle(one.robot).toLowerCase()];
  const parameters = varied.filter((field) => !NAMED_APART.includes(field));
  if (parameters.length && !differs("observation")) place.shift();
  const own = parameters.filter((field) => one[field] !== null)
    .map((field) => `${fieldTitle(field)}\u00a0${one[field]}`);
  return [...agent, ...place, ...own].filter(Boolean).join(", ");
}

/** Every seed of the gaits that were pooled, as shares of greedy's distance. */
function pointsOf({ settings, parameters }, one) {
  const greedy = greedyTotals(settings);
  const isPooled = (setting) =>
    setting.role === "learner" && placeOf(setting) === placeOf(one) &&
    ["agent", ...parameters].every((field) => setting[field] === one[field]);
  return settings.filter(isPooled).flatMap((setting) => {
    const greedy_m = greedy(setting);
    return greedy_m ? (setting.total?.points_m ?? []).map((metres) => metres / greedy_m) : [];
  });
}
