// A league, a recovery, groups or bodies: in each world the learners' curves with the walks of their
// references, and a table.
import { useState } from "preact/hooks";
import { worldTitle } from "../../../js/disturbances.js";
import {
  asMarks, bare, distanceAxis, factorOf, inUnit, placeOf, placesOf, shown, stepsAxis, unit, UNIT_NAMES,
} from "../distances.js";
import { count, percentage, whole } from "../../../js/format.js";
import { largest } from "../../../js/scale.js";
import { agentOf } from "../../../js/settings.js";
import { agentTitle, gaitTitle, planningModelTitle } from "../../../js/titles.js";
import { experimentKind } from "../kinds.js";
import { Chart } from "../../../js/components/charts.js";
import { html, Segments } from "../../../js/components/elements.js";
import { drawn } from "../printing.js";
import { AgentKey, BestKnownWords, LevelKey, PlaceSwitch, PlaceTitle, UnitSwitch } from "./report-tools.js";

/** @import { Interval, Place, ScoredCurve, Summary, Until, WorldView } from "../../../js/types.js" */
/** @import { ComponentChildren } from "preact" */

/** In the unit that is shown, if it has one. @typedef {{ [Part in keyof Interval]: number | null }} MaybeInterval */

const NOMINAL = "nominal";

/** @param {Summary} summary */
const isRecovery = ({ experiment }) => experimentKind(experiment)?.measure === "recovery";

/** The question that an experiment asks, by what it varies. @param {Summary} summary */
function titleOf(summary) {
  if (isRecovery(summary)) return "Recovery by agent and disturbance";
  const { robots = [], worlds = [] } = summary.config;
  return `Distances by agent and ${robots.length > 1 ? "body" : worlds.length > 1 ? "world" : "gait"}`;
}

/** @param {Summary} summary */
const stepsOf = (summary) => (isRecovery(summary) ? "steps after it happened" : "steps of practice");

/** @param {{ summary: Summary }} props */
export function Worlds({ summary }) {
  const entries = summary.worlds ?? [];
  const worlds = [...new Set(entries.map(({ world }) => /** @type {string} */ (world)))];
  const [wantedWorld, setWorld] = useState(/** @type {string | null} */ (null));
  const [wantedPlace, setPlace] = useState(/** @type {string | null} */ (null));
  if (!entries.length) return null;
  const world = wantedWorld !== null && worlds.includes(wantedWorld) ? wantedWorld : worlds[0];
  const places = placesOf(entries.filter((entry) => entry.world === world));
  const place = places.find(({ key }) => key === wantedPlace) ?? places[0];
  const learners = [...new Set(entries.filter(({ curve }) => curve).map(({ agent }) => agent))];
  return html`
    <section class="panel worlds" aria-labelledby="worlds">
      <div class="report-tools">
        <h2 id="worlds">${titleOf(summary)}</h2>
        ${worlds.length > 1 && html`
          <${Segments} label="World" choices=${worlds.map((name) => [name, worldTitle(name)])} value=${world}
            onValue=${setWorld} />
        `}
        <${PlaceSwitch} places=${places} value=${place.key} onValue=${setPlace} />
        <${UnitSwitch} />
      </div>
      ${drawn(worlds, world).flatMap((name) => drawn(places, place).map((each) => html`
        <${InWorld} key=${`${name} ${each.key}`} world=${name} place=${each} places=${places} learners=${learners}
          summary=${summary} />
      `))}
      <${TableWords} summary=${summary} />
      <${BestKnownWords} distances=${entries.map(({ best_known_m }) => best_known_m)} />
    </section>
    ${worlds.length > 1 && html`
      <${Overview} entries=${entries.filter((entry) => placeOf(entry) === place.key)} worlds=${worlds}
        summary=${summary} />
    `}
  `;
}

/** @param {{ world: string, place: Place, places: Place[], learners: string[], summary: Summary }} props */
function InWorld({ world, place, places, learners, summary }) {
  const here = (summary.worlds ?? []).filter((entry) => entry.world === world && placeOf(entry) === place.key);
  const gaits = [...new Set(here.map(({ gait }) => gait))];
  /** @param {string} gait */
  const inGait = (gait) => here.filter((entry) => entry.gait === gait);
  return here.length > 0 && html`
    <${PlaceTitle} place=${place} places=${places} />
    <p class="dim">
      ${worldTitle(world)}: ${UNIT_NAMES[unit.value]}, against ${stepsOf(summary)}.
      Curve: interquartile mean; band: its 95 % interval.
    </p>
    <${AgentKey} agents=${learners}><${LevelKey} levels=${levelsOf(here[0])} /><//>
    <div class=${`gait-panels ${gaits.length > 1 ? "" : "alone"}`}>
      ${gaits.map((gait) => html`<${Gait} key=${gait} gait=${gait} entries=${inGait(gait)} summary=${summary} />`)}
    </div>
    ${gaits.map((gait) => html`<${Table} key=${gait} gait=${gait} entries=${inGait(gait)} summary=${summary} />`)}
  `;
}

// ---- the lines of references

/** @type {() => ["greedy_m" | "greedy_nominal_m" | "best_known_m", string, string][]} */
const levelKinds = () => [
  ["greedy_m", "greedy", "Greedy"],
  ["greedy_nominal_m", "nominal", `Greedy, ${planningModelTitle(NOMINAL)}`],
  ["best_known_m", "best-known", "Best known"],
];

/** The references that are known, in the unit that is shown. @param {WorldView} entry */
const levelsOf = (entry) =>
  levelKinds().flatMap(([field, kind, name]) => {
    const value = inUnit(entry[field], factorOf(entry));
    return value === null ? [] : [{ kind, name, value }];
  });

// ---- one chart per gait

/**
 * Names of entries: of one agent several, if the experiment practises for several numbers of steps.
 * @param {WorldView} entry
 * @param {Summary} summary
 */
const nameOf = ({ agent, plans_with, steps, role }, { config }) => [
  agentTitle(agent), plans_with && planningModelTitle(plans_with),
  role === "learner" && config.steps.length > 1 && count(steps, "step"),
].filter(Boolean).join(", ");

/** @param {{ gait: string, entries: WorldView[], summary: Summary }} props */
function Gait({ gait, entries, summary }) {
  const curves = entries.filter(({ curve }) => curve).map((entry) => toUnit(entry, summary));
  const levels = levelsOf(entries[0]);
  const marks = asMarks(levels);
  const ends = curves.map(({ name, ys, xs }) => `${name} ${shown(ys.at(-1))} after ${count(xs.at(-1) ?? 0, "step")}`);
  const lines = levels.map(({ name, value }) => `${name.toLowerCase()} ${shown(value)}`);
  const label = `${gaitTitle(gait)}: ${[...ends, ...lines].join(", ")}`;
  return html`
    <figure>
      <figcaption><b>${gaitTitle(gait)}</b><span class="dim num">${seedsOf(entries)}</span></figcaption>
      ${curves.length > 0 && html`
        <${Chart} name=${gaitTitle(gait)} label=${label} lines=${curves} marks=${marks}
          xs=${[...new Set(curves.flatMap(({ xs }) => xs))].sort((a, b) => a - b)}
          x=${stepsAxis(curves, summary.config, stepsOf(summary))} y=${distanceAxis([{ lines: curves, marks }])} />
      `}
    </figure>
  `;
}

/** @param {WorldView[]} entries */
function seedsOf(entries) {
  const numbers = entries.filter(({ role }) => role === "learner").map(({ n }) => n);
  if (!numbers.length) return "no learner yet";
  const [least, most] = [Math.min(...numbers), Math.max(...numbers)];
  return least === most ? count(most, "seed") : `${whole(least)} to ${count(most, "seed")}`;
}

/** @param {WorldView} entry @param {Summary} summary */
function toUnit(entry, summary) {
  const factor = factorOf(entry);
  /** @param {(number | null)[]} list */
  const all = (list) => list.map((value) => inUnit(value, factor));
  const { steps, iqm_m, low_m, high_m } = /** @type {ScoredCurve} */ (entry.curve);
  return {
    name: nameOf(entry, summary), color: agentOf(entry.agent).color, xs: steps, ys: all(iqm_m), low: all(low_m),
    high: all(high_m), dots: true,
  };
}

// ---- all worlds beside each other: the share of the best known walk, in the end

/** Of the best known walk; of greedy's where none is known. @param {WorldView} entry */
const shareIn = ({ of_best_known, of_greedy, best_known_m }) =>
  (best_known_m === null ? of_greedy : of_best_known)?.iqm ?? null;

/** @param {number[]} values */
const meanOf = (values) => (values.length ? values.reduce((sum, value) => sum + value, 0) / values.length : null);

/** @param {{ entries: WorldView[], worlds: string[], summary: Summary }} props */
function Overview({ entries, worlds, summary }) {
  const names = [...new Set(entries.map((entry) => nameOf(entry, summary)))];
  /** @param {string} name @param {string} world */
  const meanIn = (name, world) => meanOf(
    entries.filter((entry) => entry.world === world && nameOf(entry, summary) === name).map(shareIn)
      .filter((share) => share !== null),
  );
  const rows = names.map((name) => ({ name, shares: worlds.map((world) => meanIn(name, world)) }));
  const best = worlds.map((_, n) => largest(rows.map(({ shares }) => shares[n] ?? -Infinity), -Infinity));
  // What reads the same is as good.
  const isBest = (/** @type {number} */ share, /** @type {number} */ n) => percentage(share) === percentage(best[n]);
  /** @param {string} world */
  const ofGreedy = (world) => entries.some((entry) => entry.world === world && entry.best_known_m === null);
  const title = "All worlds: share of the best known distance";
  /** @param {{ shares: (number | null)[] }} row */
  const overall = ({ shares }) => meanOf(shares.filter((share) => share !== null)) ?? 0;
  rows.sort((a, b) => overall(b) - overall(a));
  return html`
    <section class="panel worlds" aria-labelledby="all-worlds">
      <h2 id="all-worlds">${title}</h2>
      <p class="dim overview-words">In the end, as a mean over the gaits; the farthest of each world is bold.</p>
      <div class="scroller" tabindex="0" role="region" aria-label="Table of all worlds">
        <table class="facts-table world-table">
          <caption class="sr-only">${title}</caption>
          <thead><tr>
            <th scope="col">Agent</th>
            ${worlds.map((world) => html`
              <th scope="col">${worldTitle(world)}${ofGreedy(world) ? ", of greedy" : ""}</th>
            `)}
          </tr></thead>
          <tbody>
            ${rows.map(({ name, shares }) => html`
              <tr key=${name}>
                <th scope="row">${name}</th>
                ${shares.map((share, n) => html`
                  <td class="num">${share === null ? "–" : isBest(share, n) ? html`<b>${percentage(share)}</b>`
                    : percentage(share)}</td>
                `)}
              </tr>
            `)}
          </tbody>
        </table>
      </div>
    </section>
  `;
}

// ---- what the words of the tables mean

/** @param {{ summary: Summary }} props */
const TableWords = ({ summary }) => html`
  <p class="dim table-note">
    Metres in 50 steps from rest. Mean: the area under the curve, divided by its steps. Steps to a share of a reference:
    ${" "}${UNTIL.toLowerCase()}.
    ${isRecovery(summary) && html`
      ${" "}Who looks ahead walks in that world from the start. Earned: the sum of the rewards of those steps of the
      practice itself, which explores; a reward is the way along
      ${summary.config.reward === "track" ? " the track" : " the robot’s own heading"}.
    `}
    ${summary.config.tolerance ? html`
      ${" "}Each seed draws the robot that everyone walks with: lengths, masses, servo gains, friction and mounting
      angles within ${percentage(summary.config.tolerance)} of its design.
    ` : ""}
  </p>
`;

// ---- one table per gait, the farthest first

/**
 * A value with its interval below it; a dash without one.
 * @param {MaybeInterval | null} interval
 * @param {(value: number) => string} words
 * @param {(value: number) => string} bareWords
 */
const valueOf = (interval, words, bareWords) => interval && interval.iqm !== null && html`
  ${words(interval.iqm)}${interval.low !== null && html`
    <br /><span class="dim">${bareWords(interval.low)} – ${bareWords(interval.high ?? NaN)}</span>
  `}
`;

/** @param {MaybeInterval | null} interval @param {WorldView} entry */
function distanceOf(interval, entry) {
  const factor = factorOf(entry);
  /** @param {number | null} value */
  const converted = (value) => inUnit(value, factor);
  if (!interval) return null;
  const [iqm, low, high] = [interval.iqm, interval.low, interval.high].map(converted);
  return valueOf({ iqm, low, high }, shown, bare);
}

/** @param {MaybeInterval | null} interval */
const shareOf = (interval) => valueOf(interval, percentage, (share) => percentage(share).replace(/[^\d\u2212]/g, ""));

/** @param {Until | null} until */
const untilOf = (until) => until && html`
  ${until.median_steps === null ? "not reached" : whole(until.median_steps)}
  <br /><span class="dim">reached by ${percentage(until.reached)}</span>
`;

/**
 * The value of a curve at one of its places, as an interval.
 * @param {ScoredCurve | null} curve
 * @param {number} place
 */
const atPlace = (curve, place) =>
  curve && { iqm: curve.iqm_m[place], low: curve.low_m[place], high: curve.high_m[place] };

/**
 * `isDistance`: whether the best known walk has its distance there.
 * @typedef {{
 *   title: string, words?: string, isDistance?: boolean, cell: (entry: WorldView) => ComponentChildren
 * }} Column
 */

/** @type {Column[]} */
const SHARES = [
  { title: "Of greedy", cell: ({ of_greedy }) => shareOf(of_greedy) },
  { title: "Of best known", cell: ({ of_best_known }) => shareOf(of_best_known) },
];

/**
 * Columns: title, explanation, and the cell of an entry.
 * @param {Summary} summary
 * @param {WorldView[]} entries
 * @returns {Column[]}
 */
function columnsOf(summary, entries) {
  const learner = entries.find(({ curve }) => curve);
  const share = (learner?.until_greedy ?? learner?.until_best_known)?.of;
  /** @type {Column[]} */
  const until = share ? [
    { title: `Steps to ${percentage(share)} of greedy`, words: UNTIL, cell: (entry) => untilOf(entry.until_greedy) },
    { title: `To ${percentage(share)} of best known`, words: UNTIL, cell: (entry) => untilOf(entry.until_best_known) },
  ] : [];
  /** @type {Column} */
  const mean = {
    title: "Mean", words: "Over the practice: the area under the curve divided by its steps",
    cell: (entry) => distanceOf(entry.mean_m, entry),
  };
  const steps = learner?.curve?.steps ?? [];
  /** @type {Column} */
  const distance = {
    title: isRecovery(summary) ? `After ${whole(steps.at(-1) ?? 0)}` : "Distance",
    words: "In 50 steps, at the last evaluation", isDistance: true, cell: (entry) => distanceOf(entry.distance, entry),
  };
  const afterwards = isRecovery(summary) ? steps.slice(0, -1).map(evaluationColumn) : [];
  const seeds = { title: "Seeds", cell: (/** @type {WorldView} */ { n }) => whole(n) };
  return [...afterwards, distance, ...SHARES, mean, ...earnedColumns(summary, steps), ...until, seeds];
}

/**
 * The distance at an evaluation after something has happened.
 * @param {number} step
 * @param {number} place
 * @returns {Column}
 */
const evaluationColumn = (step, place) => ({
  title: step === 0 ? "Right after" : `After ${whole(step)}`,
  words: step === 0 ? "Once it has happened" : "Steps after it happened",
  cell: (entry) => distanceOf(atPlace(entry.curve, place), entry),
});

/**
 * What the practice earned in each window of steps after something has happened; windows follow one another.
 * @param {Summary} summary
 * @param {number[]} steps at which windows begin
 * @returns {Column[]}
 */
function earnedColumns({ experiment }, steps) {
  const length = experimentKind(experiment)?.earning_steps;
  if (!length) return [];
  return steps.flatMap((step, place) => (step % length ? [] : [{
    title: `Earned in ${whole(step + 1)} – ${whole(step + length)}`,
    words: "In these steps of practice after it happened",
    cell: (entry) => distanceOf(atPlace(entry.earned, place), entry),
  }]));
}

const UNTIL = "Median over the seeds of the steps until an evaluation reaches it; below, the share of seeds that do";

/** @param {{ title: string, value: ComponentChildren }} props */
const Cell = ({ title, value }) => html`
  <td role="cell" data-label=${title} class=${`num ${value ? "" : "no-value"}`}>${value || "–"}</td>
`;

/** The best known walk as the first row: what is possible. @param {{ entry: WorldView, columns: Column[] }} props */
function BestKnown({ entry, columns }) {
  const { best_known_m, greedy_m } = entry;
  const distance = distanceOf({ iqm: best_known_m, low: null, high: null }, entry);
  const share = greedy_m && percentage(Number(best_known_m) / greedy_m);
  return html`
    <tr role="row" class="best-known">
      <th role="rowheader" scope="row">Best known</th>
      ${columns.map(({ title, isDistance }) => html`
        <${Cell} title=${title} value=${isDistance ? distance : title === "Of greedy" && share} />
      `)}
    </tr>
  `;
}

/** @param {{ gait: string, entries: WorldView[], summary: Summary }} props */
function Table({ gait, entries, summary }) {
  const columns = columnsOf(summary, entries).filter(({ cell }) => entries.some(cell));
  const sorted = [...entries].sort((a, b) => b.distance.iqm - a.distance.iqm);
  const title = `Agents in ${gaitTitle(gait)}`;
  return html`
    <h3>${gaitTitle(gait)}</h3>
    <div class="scroller" tabindex="0" role="region" aria-label=${title}>
      <table class="facts-table world-table stacking" role="table">
        <caption class="sr-only">${title}</caption>
        <thead role="rowgroup"><tr role="row">
          <th role="columnheader" scope="col">Agent</th>
          ${columns.map((column) => html`
            <th role="columnheader" scope="col" title=${column.words}>${column.title}</th>
          `)}
        </tr></thead>
        <tbody role="rowgroup">
          ${entries[0].best_known_m !== null && html`<${BestKnown} entry=${entries[0]} columns=${columns} />`}
          ${sorted.map((entry) => html`
            <tr role="row" key=${entry.key} style=${{ "--agent": agentOf(entry.agent).color }}>
              <th role="rowheader" scope="row"><i class="swatch"></i> ${nameOf(entry, summary)}</th>
              ${columns.map(({ title: column, cell }) => html`<${Cell} title=${column} value=${cell(entry)} />`)}
            </tr>
          `)}
        </tbody>
      </table>
    </div>
  `;
}
