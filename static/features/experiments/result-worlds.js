// Tables of a result in worlds as data: what agents reach along their practice, or after something has happened, and
// all worlds beside one another.
import { experimentKind } from "./kinds.js";
import { atEvaluation, distanceCell, NONE, shareCell, untilCell } from "./result-cells.js";
import { nameOf } from "./result-curves.js";
import { worldTitle } from "../../js/disturbances.js";
import { percentage, whole } from "../../js/format.js";
import { largest } from "../../js/scale.js";
import { agentOf } from "../../js/settings.js";
import { gaitTitle } from "../../js/titles.js";

/** @import { Cell } from "./result-cells.js" */
/** @import { Column, Table } from "./result-tables.js" */
/** @import { Summary, WorldView } from "../../js/types.js" */

/**
 * `best`: its cell in the row of the best known walk.
 * @typedef {Column & { cell: (entry: WorldView) => Cell, best?: Cell }} WorldColumn
 */

/** @param {Summary} summary */
export const isRecovery = ({ experiment }) => experimentKind(experiment)?.measure === "recovery";

export const UNTIL =
  "Median over the seeds of the steps until an evaluation reaches it; below, the share of seeds that do";

/**
 * The agents of a gait, the farthest first: their distances, and what their practice brought, in a table of its own
 * where it earned rewards.
 * @param {Summary} summary
 * @param {WorldView[]} entries of one gait in one place and world
 * @returns {Table[]}
 */
export function worldTables(summary, entries) {
  const title = gaitTitle(entries[0].gait);
  const sorted = [...entries].sort((a, b) => b.distance.iqm - a.distance.iqm);
  const [distances, practice] = [distanceColumns(summary, entries), practiceColumns(summary, entries)];
  /** @type {WorldColumn} */
  const seeds = { title: "Seeds", cell: ({ n }) => ({ text: whole(n) }) };
  const agents = { caption: `Agents in ${title}`, title };
  return (isRecovery(summary) ? [
    { ...agents, columns: [...distances, seeds] },
    { caption: `Practice in ${title}`, title: `${title}: the practice`, columns: practice },
  ] : [{ ...agents, columns: [...distances, ...practice, seeds] }]).map(({ columns, ...table }) => {
    const filled = columns.filter(({ cell }) => entries.some((entry) => cell(entry).text));
    const rows = sorted.filter((entry) => filled.some(({ cell }) => cell(entry).text)).map((entry) => ({
      key: entry.key, title: nameOf(entry, summary), color: agentOf(entry.agent).color,
      cells: filled.map(({ cell }) => cell(entry)),
    }));
    const best = filled.map(({ best: cell = NONE }) => cell);
    const reach = best.some(({ text }) => text) ? [{ key: "best", title: "Best known", isDim: true, cells: best }] : [];
    return { ...table, heads: ["Agent"], columns: filled, groups: [{ rows: [...reach, ...rows] }] };
  }).filter(({ columns }) => columns.length);
}

/** @param {Summary} summary @param {WorldView[]} entries @returns {WorldColumn[]} */
function distanceColumns(summary, entries) {
  const [{ best_known_m, greedy_m }] = entries;
  const steps = entries.find(({ curve }) => curve)?.curve?.steps ?? [];
  const evaluations = isRecovery(summary) ? steps.slice(0, -1) : [];
  return [
    ...evaluations.map((step, evaluation) => ({
      title: step === 0 ? "Right after" : `After ${whole(step)}`,
      words: step === 0 ? "Once it has happened" : "Steps after it happened",
      cell: (/** @type {WorldView} */ entry) => distanceCell(atEvaluation(entry.curve, evaluation), entry),
    })),
    {
      title: isRecovery(summary) ? `After ${whole(steps.at(-1) ?? 0)}` : "Distance",
      words: "In 50 steps, at the last evaluation", cell: (entry) => distanceCell(entry.distance, entry),
      best: distanceCell({ iqm: best_known_m }, entries[0]),
    },
    {
      title: "Of greedy", cell: ({ of_greedy }) => shareCell(of_greedy ?? undefined),
      best: best_known_m && greedy_m ? { text: percentage(best_known_m / greedy_m) } : NONE,
    },
    { title: "Of best known", cell: ({ of_best_known }) => shareCell(of_best_known ?? undefined) },
  ];
}

/** @param {Summary} summary @param {WorldView[]} entries @returns {WorldColumn[]} */
function practiceColumns({ experiment }, entries) {
  const learner = entries.find(({ curve }) => curve);
  const length = experimentKind(experiment)?.earning_steps ?? Infinity;
  const share = percentage((learner?.until_greedy ?? learner?.until_best_known)?.of ?? NaN);
  // Windows follow one another.
  const windows = (learner?.earned?.steps ?? []).map((step, evaluation) => ({ step, evaluation }))
    .filter(({ step }) => step % length === 0);
  return [
    {
      title: "Mean", words: "Over the practice: the area under the curve divided by its steps",
      cell: (entry) => distanceCell(entry.mean_m, entry),
    },
    ...windows.map(({ step, evaluation }) => ({
      title: `Earned in ${whole(step + 1)} – ${whole(step + length)}`,
      words: "In these steps of practice after it happened",
      cell: (/** @type {WorldView} */ entry) => distanceCell(atEvaluation(entry.earned, evaluation), entry),
    })),
    { title: `Steps to ${share} of greedy`, words: UNTIL, cell: ({ until_greedy }) => untilCell(until_greedy) },
    { title: `To ${share} of best known`, words: UNTIL, cell: ({ until_best_known }) => untilCell(until_best_known) },
  ];
}

// ---- all worlds beside each other: the share of the best known walk, in the end

/** Of the best known walk; of greedy's where none is known. @param {WorldView} entry */
const shareIn = ({ of_best_known, of_greedy, best_known_m }) =>
  (best_known_m === null ? of_greedy : of_best_known)?.iqm ?? null;

/** @param {(number | null)[]} values */
function meanOf(values) {
  const numbers = values.filter((value) => value !== null);
  return numbers.length ? numbers.reduce((sum, value) => sum + value, 0) / numbers.length : null;
}

export const OVERVIEW_TITLE = "All worlds: share of the best known distance";

/**
 * A row for each agent, a column for each world.
 * @param {Summary} summary
 * @param {WorldView[]} entries of all worlds in one place
 * @param {string[]} worlds
 * @returns {Table}
 */
export function overviewTable(summary, entries, worlds) {
  const names = [...new Set(entries.map((entry) => nameOf(entry, summary)))];
  /** @param {string} name @param {string} world */
  const meanIn = (name, world) => meanOf(
    entries.filter((entry) => entry.world === world && nameOf(entry, summary) === name).map(shareIn));
  const rows = names.map((name) => ({ name, shares: worlds.map((world) => meanIn(name, world)) }));
  const best = worlds.map((_, n) => largest(rows.map(({ shares }) => shares[n] ?? -Infinity), -Infinity));
  rows.sort((a, b) => (meanOf(b.shares) ?? 0) - (meanOf(a.shares) ?? 0));
  /** @param {string} world */
  const isOfGreedy = (world) => entries.some((entry) => entry.world === world && entry.best_known_m === null);
  return {
    caption: OVERVIEW_TITLE,
    heads: ["Agent"],
    columns: worlds.map((world) => ({ title: `${worldTitle(world)}${isOfGreedy(world) ? ", of greedy" : ""}` })),
    groups: [{
      rows: rows.map(({ name, shares }) => ({
        key: name, title: name,
        // What reads the same is as good.
        cells: shares.map((share, n) => (share === null ? NONE
          : { text: percentage(share), isBold: percentage(share) === percentage(best[n]) })),
      })),
    }],
  };
}
