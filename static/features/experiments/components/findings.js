// Findings over all seeds: gaits together, learners against each other, claims, conclusions, real clock.
import { useMemo } from "preact/hooks";
import { greedyTotals, placeOf } from "../distances.js";
import { decision, metres, percentage, whole, withGroupedDigits } from "../../../js/format.js";
import { largest } from "../../../js/scale.js";
import { agentOf } from "../../../js/settings.js";
import { served } from "../../../js/options.js";
import { agentTitle, fieldTitle, gaitTitle, observationTitle, robotTitle, variedFields } from "../../../js/titles.js";
import { DotStrip } from "../../../js/components/dot-strip.js";
import { html } from "../../../js/components/elements.js";
import { TableMenu } from "./report-tools.js";

/** @import { ClaimView, Finding, NarrativeSection, PooledView, Setting } from "../../../js/types.js" */
/** @import { Interval } from "../../../js/types.js" */
/** @import { Summary, VersusView, WallLane } from "../../../js/types.js" */

// ---- all gaits together: how near learners come to greedy, how many walk, how often they beat it at time-out

const BEATS_GREEDY = "Beats it at time-out";
const OF_BEST = "Of best known";
const SHARES = "Share of greedy’s distance, a dot for each seed";
const POOLED_COLUMNS = [
  { title: "Setting" },
  { title: SHARES, kind: "wide-cell" },
  { title: "Interquartile mean", words: "Interquartile mean, with its 95 % interval" },
  { title: OF_BEST, words: "Of the best known distance, where there is one" },
  { title: "Share that walks", words: "Get at least half as far as greedy" },
  { title: "Reach greedy", words: "Get at least 95 % as far" },
  { title: BEATS_GREEDY, words: "Under the paper clock" },
  { title: "Seeds" },
];
const MARKS = [{ value: 1, kind: "greedy" }, { value: 0.5, kind: "half" }];
const POOLED_VERDICTS = { yes: "more often than not", no: "less often than not", "not established": "not established" };

/** @param {{ summary: Summary }} props */
export function AtAGlance({ summary }) {
  const pooled = (summary.pooled ?? []).filter(({ relative }) => relative);
  const points = useMemo(() => pooled.map((entry) => pointsOf(summary, entry)), [summary]);
  if (!pooled.length || (pooled.length === 1 && pooled[0].gaits.length === 1)) return null;
  const high = 1.03 * largest(points.flat(), 1);
  const varied = variedFields(pooled, ["agent", "observation", "robot", ...summary.parameters]);
  const isRaced = pooled.some(({ relative_finished }) => relative_finished);
  const isOfSeveral = pooled.some(({ gaits }) => gaits.length > 1);
  const heading = isOfSeveral ? "All gaits together" : "All seeds together";
  const hasBest = pooled.some(({ of_best_known }) => of_best_known);
  const hidden = [!isRaced && BEATS_GREEDY, !hasBest && OF_BEST];
  const columns = POOLED_COLUMNS.filter(({ title }) => !hidden.includes(title));
  return html`
    <section class="panel glance" aria-labelledby="glance">
      <div class="report-tools">
        <h2 id="glance">${heading}</h2>
        <${TableMenu} title=${heading} />
      </div>
      <p class="dim">Total distance as a share of greedy’s in the same place; a robot that gets half as far walks.</p>
      <div class="scroller" tabindex="0" role="region" aria-label=${`Table of ${heading.toLowerCase()}`}>
        <table class="facts-table stacking" role="table">
          <caption class="sr-only">${heading}: share of greedy’s distance</caption>
          <thead role="rowgroup"><tr role="row">
            ${columns.map(({ title, words, kind }) => html`
              <th role="columnheader" scope="col" class=${kind} title=${words}>${title}</th>
            `)}
          </tr></thead>
          <tbody role="rowgroup">
            ${pooled.map((entry, n) => html`
              <${PooledRow} key=${n} entry=${entry} varied=${varied} points=${points[n]} high=${high} isRaced=${isRaced}
                hasBest=${hasBest} />
            `)}
          </tbody>
        </table>
      </div>
    </section>
  `;
}

/**
 * A share with its interval below it.
 * @param {{ share: Interval | PooledView["walkers"] | undefined }} props
 */
function Share({ share }) {
  if (!share) return "–";
  const { low, high } = share;
  return html`
    ${percentage("iqm" in share ? share.iqm : share.share)}${low !== null && high !== null && html`
      <br /><span class="dim">${Math.round(100 * low)} – ${percentage(high)}</span>
    `}
  `;
}

/**
 * @param {{
 *   entry: PooledView, varied: string[], points: number[], high: number, isRaced: boolean, hasBest: boolean
 * }} props
 */
function PooledRow({ entry, varied, points, high, isRaced, hasBest }) {
  const { iqm } = /** @type {Interval} */ (entry.relative);
  const label = `${points.length} seeds, typically ${percentage(iqm)} of greedy’s distance`;
  return html`
    <tr role="row">
      <th role="rowheader" scope="row">${nameOf(entry, varied)}</th>
      <td role="cell" class="wide-cell" data-label=${SHARES}>
        <${DotStrip} label=${label} points=${points} high=${high} typical=${entry.relative} marks=${MARKS}
          color=${agentOf(entry.agent).color} height=${44} axis=${percentage} />
      </td>
      <td role="cell" data-label="Interquartile mean" class="num">
        <${Share} share=${entry.relative} />
      </td>
      ${hasBest && html`
        <td role="cell" data-label=${OF_BEST} class="num"><${Share} share=${entry.of_best_known} /></td>
      `}
      <td role="cell" data-label="Share that walks" class="num"><${Share} share=${entry.walkers} /></td>
      <td role="cell" data-label="Reach greedy" class="num"><${Share} share=${entry.reaches_greedy} /></td>
      ${isRaced && html`
        <td role="cell" data-label=${BEATS_GREEDY} class="num"><${Beats} beats=${entry.beats_greedy} /></td>
      `}
      <td role="cell" data-label="Seeds" class="num">${whole(entry.n)}</td>
    </tr>
  `;
}

/** @param {{ beats: PooledView["beats_greedy"] }} props */
const Beats = ({ beats }) =>
  beats ? html`${percentage(beats.share)}<br /><span class="dim">${POOLED_VERDICTS[beats.verdict]}</span>` : "–";

/** Fields that have words of their own in the name of a row. */
const NAMED_APART = ["agent", "observation", "robot", "steps"];

/**
 * The fields in which a row differs from the others.
 * @param {PooledView} entry
 * @param {string[]} varied
 */
function nameOf(entry, varied) {
  /** @param {string} field */
  const differs = (field) => varied.includes(field);
  const agent = [
    differs("agent") && agentTitle(entry.agent),
    entry.blocks === 1 && differs("steps") && `${whole(entry.steps)} steps`,
  ];
  const place = [observationTitle(entry.observation), differs("robot") && robotTitle(entry.robot).toLowerCase()];
  const parameters = varied.filter((field) => !NAMED_APART.includes(field));
  if (parameters.length && !differs("observation")) place.shift();
  const values = parameters.filter((field) => entry[field] !== null)
    .map((field) => `${fieldTitle(field)}\u00a0${entry[field]}`);
  return [...agent, ...place, ...values].filter(Boolean).join(", ");
}

/**
 * Every seed of the gaits that were pooled, as shares of greedy's distance.
 * @param {Summary} summary
 * @param {PooledView} entry
 */
function pointsOf({ settings, parameters }, entry) {
  const greedy = greedyTotals(settings);
  /** @param {Setting} setting */
  const isPooled = (setting) =>
    setting.role === "learner" && placeOf(setting) === placeOf(entry) &&
    ["agent", ...parameters].every((field) => setting[field] === entry[field]);
  return settings.filter(isPooled).flatMap((setting) => {
    const greedy_m = greedy(setting);
    return greedy_m ? (setting.total?.points_m ?? []).map((total_m) => total_m / greedy_m) : [];
  });
}

// ---- learners against each other: the chance that a seed of one beats a seed of another

const VERSUS_VERDICTS = { yes: "better", no: "worse", "not established": "not established" };
const VERSUS_COLUMNS = ["Place", "First", "Second", "Chance", "The first is"];

/** @param {{ summary: Summary }} props */
export const Versus = ({ summary }) => summary.versus?.length > 0 && html`
  <section class="panel versus" aria-labelledby="versus">
    <h2 id="versus">Learners against each other</h2>
    <p class="dim">The chance that a seed of the first gets further than a seed of the second; a half is a tie.</p>
    <div class="scroller" tabindex="0" role="region" aria-label="Table of chances">
      <table class="facts-table">
        <caption class="sr-only">Chance that a seed of the first gets further than a seed of the second</caption>
        <thead><tr>${VERSUS_COLUMNS.map((title) => html`<th scope="col">${title}</th>`)}</tr></thead>
        <tbody>${summary.versus.map((pair) => html`<${VersusRow} pair=${pair} />`)}</tbody>
      </table>
    </div>
  </section>
`;

/** @param {{ pair: VersusView }} props */
function VersusRow({ pair }) {
  const { observation, robot, steps, low, high, verdict } = pair;
  const place = [observationTitle(observation), robotTitle(robot).toLowerCase(), `${whole(steps)} steps`];
  const interval = low === null || high === null ? "" : `${percentage(low)} – ${percentage(high)}`;
  return html`
    <tr>
      <th scope="row">${gaitTitle(pair.gait)}, <span class="dim">${place.join(", ")}</span></th>
      <td>${agentTitle(pair.a)}</td><td>${agentTitle(pair.b)}</td>
      <td class="num">${percentage(pair.probability)} <span class="dim">${interval}</span></td>
      <td>${VERSUS_VERDICTS[verdict] ?? verdict}</td>
    </tr>
  `;
}

// ---- the paper's claims with verdicts over all seeds, in each case that was tried

/** @type {Record<string, string[]>} */
const VERDICTS = {
  holds: ["holds", "✓", "Holds"],
  "does not hold": ["fails", "✕", "Does not hold"],
  "not established": ["open", "?", "Not established"],
  depends: ["mixed", "±", "Depends"],
};

/** @param {{ claims: ClaimView[], isComplete: boolean }} props */
export const Claims = ({ claims, isComplete }) => claims.length > 0 && html`
  <section class="panel claims" aria-labelledby="claims">
    <h2 id="claims">The paper’s claims over all seeds</h2>
    <p class="dim">
      The paper says neither how the state is read nor how stiff the servos are, so each claim is judged in every case
      that was tried. “Not established” means that the 95 % interval leaves it open.
    </p>
    ${!isComplete && html`<p class="dim">So far: a verdict may change until the last trial has ended.</p>`}
    <ul>${claims.map((claim) => html`<${Claim} key=${claim.id} ...${claim} />`)}</ul>
  </section>
`;

/** @param {{ claim: string, criterion: string, verdict: string, evidence: string, where: Finding[] }} props */
function Claim({ claim, criterion, verdict, evidence, where }) {
  const hasCases = where.length > 1;
  return html`
    <li class="claim">
      <${Verdict} verdict=${verdict} />
      <div>
        <h3>${withGroupedDigits(claim)}</h3>
        <p class="dim">${withGroupedDigits(evidence)}</p>
        <details>
          <summary>${hasCases ? `All ${where.length} cases` : "Criterion"}</summary>
          <p class="dim">Criterion: ${withGroupedDigits(criterion)}</p>
          ${hasCases && html`
            <ul class="cases">${where.map((finding) => html`<${Case} key=${finding.label} ...${finding} />`)}</ul>
          `}
        </details>
      </div>
    </li>
  `;
}

/** @param {{ label: string, verdict: string, evidence: string }} props */
const Case = ({ label, verdict, evidence }) => html`
  <li>
    <${Verdict} verdict=${verdict} />
    <p><b>${label}</b> <span class="dim">${withGroupedDigits(evidence)}</span></p>
  </li>
`;

/** @param {{ verdict: string }} props */
function Verdict({ verdict }) {
  const [kind, sign, word] = VERDICTS[verdict] ?? ["open", "?", verdict];
  return html`<p class=${`verdict ${kind}`}><span aria-hidden="true">${sign}</span>${word}</p>`;
}

// ---- conclusions in prose, written by the server from this run's numbers

/** @param {{ parts: NarrativeSection[] }} props */
export const Narrative = ({ parts }) => parts.length > 0 && html`
  <section class="panel narrative" aria-labelledby="conclusions">
    <h2 id="conclusions">Findings</h2>
    ${parts.map(({ heading, text }) => html`
      <h3>${heading}</h3>
      ${text.split("\n\n").map((paragraph) => html`<p>${withGroupedDigits(paragraph)}</p>`)}
    `)}
  </section>
`;

// ---- races under the real clock: decisions cost the time measured on the machine, not the paper's price

/** @param {{ timed: Summary["timed"] }} props */
export function FairClocks({ timed }) {
  if (!timed.length) return null;
  const agents = timed[0].lanes.map(({ agent }) => agent);
  return html`
    <section class="panel fair-clocks" aria-labelledby="fair-clocks">
      <h2 id="fair-clocks">Under the real clock</h2>
      <p class="dim">
        The distances above are under the paper clock. Here a decision costs the time that it took on this machine:
        one race in each place, with the first seed; distances at time-out.
      </p>
      <div class="scroller" tabindex="0" role="region" aria-label="Races under the real clock">
        <table class="facts-table">
          <caption class="sr-only">Distance at time-out under the real clock</caption>
          <thead>
            <tr>
              <th scope="col">Place</th>
              ${agents.map((name) => html`<th scope="col">${agentOf(name).title}</th>`)}
            </tr>
          </thead>
          <tbody>${timed.map((race) => html`<${Race} race=${race} />`)}</tbody>
        </table>
      </div>
    </section>
  `;
}

/** @param {{ race: Summary["timed"][number] }} props */
const Race = ({ race }) => html`
  <tr>
    <th scope="row">
      ${gaitTitle(race.gait)}
      <span class="dim"> ${observationTitle(race.observation)}, ${robotTitle(race.robot).toLowerCase()}</span>
    </th>
    ${race.lanes.map((lane) => html`<td class="num"><${Lane} lane=${lane} /></td>`)}
  </tr>
`;

/** @param {{ lane: WallLane }} props */
function Lane({ lane }) {
  const distance = metres(lane.finished_distance_m);
  const perDecision = decision(lane.decision_s / served().defaults.race.steps);
  return html`
    ${lane.rank === 1 ? html`<b>${distance}</b> <span class="first">first</span>` : distance}
    <br /><span class="dim">${perDecision} a decision</span>
  `;
}
