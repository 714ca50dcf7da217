// Tables of a result as data: columns, and rows of cells. Rows and columns come of the axes, agents and measure of the
// experiment.
import { gaitsOf, greedyIn, placeOf } from "./distances.js";
import { experimentKind } from "./kinds.js";
import { bestKnownCell, endOfStrips, fixedCell, NONE, shareCell, stripCell } from "./result-cells.js";
import { decision, metres, percentage, sentence, whole } from "../../js/format.js";
import { agentOf, served } from "../../js/settings.js";
import { largest } from "../../js/scale.js";
import {
  agentTitle, fieldsInWords, fieldTitle, gaitTitle, observationTitle, robotTitle, variedFields,
} from "../../js/titles.js";

/** @import { Cell, Distance } from "./result-cells.js" */
/** @import { PooledView, Setting, Summary } from "../../js/types.js" */

/** @typedef {{ title: string, words?: string, isStrip?: boolean }} Column `words`: its explanation */
/** @typedef {{ key: string, title: string, note?: string, color?: string, isDim?: boolean, cells: Cell[] }} Row */
/**
 * @typedef {object} Table
 * @property {string} caption
 * @property {string} [title] over it
 * @property {string[]} heads of the names of rows; the first is that of groups, where there are two
 * @property {Column[]} columns
 * @property {{ title?: string, note?: string, rows: Row[] }[]} groups
 */
/** A column with the cell of an entry. @typedef {Column & { cell: (entry: any) => Cell }} EntryColumn */

/** @type {[Distance, string][]} */
const DISTANCES = [["finished", "At time-out"], ["total", "Total"]];
const WALKS = { title: "Share that walks", words: "Get at least half as far as greedy" };

/** The columns in which an entry has something. @param {EntryColumn[]} columns @param {unknown[]} entries */
const filled = (columns, entries) => columns.filter(({ cell }) => entries.some((entry) => cell(entry).text));

/** @param {EntryColumn[]} columns @param {unknown} entry */
const cellsOf = (columns, entry) => columns.map(({ cell }) => cell(entry));

// ---- settings: as the paper prints them, or one in each row

/**
 * The distances in one place in the paper's layout: a row for each gait and distance, a column for each agent.
 * @param {Summary} summary
 * @param {string} place
 * @returns {Table}
 */
export function paperTable({ settings, experiment }, place) {
  const gaits = gaitsOf(settings, place);
  const { paper_gaits: papers = {}, references = [] } = experimentKind(experiment) ?? {};
  const high = endOfStrips(gaits.flatMap(({ learners, references: { greedy = null } }) =>
    [...learners, ...(greedy ? [greedy] : [])].map((setting) => ({ setting, greedy }))));
  return {
    caption: "Distance at time-out and total distance of each gait and agent, beside the paper’s",
    heads: ["Gait", "Distance"],
    columns: [
      ...gaits[0].learners.map(({ agent, steps }) =>
        ({ title: `${agentTitle(agent)}, ${whole(steps)} steps`, isStrip: true })),
      ...references.map((agent) => ({ title: agentTitle(agent) })),
      { title: "Best known", words: served().help.best_known },
    ],
    groups: gaits.map(({ gait, learners, references: { greedy = null, ...others } }) => ({
      title: gaitTitle(gait),
      note: papers[gait] && `(${papers[gait]})`,
      rows: DISTANCES.map(([distance, title]) => ({
        key: distance,
        title,
        cells: [
          ...learners.map((setting) => stripCell({ setting, distance, greedy, high })),
          ...references.map((agent) =>
            fixedCell({ setting: agent === "greedy" ? greedy : others[agent] ?? null, distance, greedy })),
          bestKnownCell({ setting: learners[0] ?? greedy, distance, greedy }),
        ],
      })),
    })),
  };
}

export const SETTINGS_TITLE = "Every setting, with every seed";

/** Without greedy, which is a line in every row, unless there is nothing else. @param {Setting[]} settings */
function comparedSettings(settings) {
  const compared = settings.filter(({ role, agent }) => role === "learner" || agent !== "greedy");
  return compared.length ? compared : settings;
}

/**
 * A row for each setting, in the order of the grid or the farthest first.
 * @param {Summary} summary
 * @param {string} order "grid" or "best"
 * @returns {Table}
 */
export function settingsTable({ settings, parameters }, order) {
  const greedyOf = greedyIn(settings);
  const compared = comparedSettings(settings);
  const fields = variedFields(compared, ["gait", "observation", "robot", "agent", ...parameters]);
  const named = fields.length ? fields : ["gait"];
  const high = endOfStrips(compared.map((setting) => ({ setting, greedy: greedyOf(setting) })));
  const agents = new Set(compared.map(({ agent }) => agent));
  const color = agents.size > 1 ? "var(--dim)" : undefined;
  const hasBest = compared.some(({ best_known_m }) => typeof best_known_m === "number");
  /** @param {Setting} setting */
  const distance = ({ total }) => total?.iqm_m ?? -1;
  const sorted = order === "best" ? [...compared].sort((a, b) => distance(b) - distance(a)) : compared;
  /** @type {EntryColumn[]} */
  const columns = [
    {
      title: "Total distance in 50 steps, a dot for each seed", isStrip: true,
      cell: (setting) => stripCell({ setting, distance: "total", greedy: greedyOf(setting), high, color }),
    },
    { ...WALKS, cell: ({ walkers }) => shareCell(walkers) },
    ...(hasBest ? [{
      title: "Best known", words: served().help.best_known,
      cell: (/** @type {Setting} */ setting) =>
        bestKnownCell({ setting, distance: "total", greedy: greedyOf(setting) }),
    }] : []),
  ];
  return {
    caption: "Total distance of each setting",
    heads: [named.map(fieldTitle).join(", ")],
    columns,
    groups: [{
      rows: sorted.map((setting) => ({
        key: setting.key, title: fieldsInWords(setting, named), cells: cellsOf(columns, setting),
      })),
    }],
  };
}

// ---- all gaits together: how near learners come to greedy, how many walk, how often they beat it at time-out

const POOLED_MARKS = [{ value: 1, kind: "greedy" }, { value: 0.5, kind: "half" }];
/** @type {Record<string, string>} */
const POOLED_VERDICTS = { yes: "more often than not", no: "less often than not", "not established": "not established" };

/**
 * Each learner over its gaits, as shares of greedy's distance; null where that says nothing more than the settings.
 * @param {Summary} summary
 * @returns {Table | null}
 */
export function pooledTable(summary) {
  const pooled = (summary.pooled ?? []).filter(({ relative }) => relative);
  if (!pooled.length || (pooled.length === 1 && pooled[0].gaits.length === 1)) return null;
  const points = new Map(pooled.map((entry) => [entry, pooledPoints(summary, entry)]));
  const high = 1.03 * largest([...points.values()].flat(), 1);
  const varied = variedFields(pooled, ["agent", "observation", "robot", ...summary.parameters]);
  /** @type {EntryColumn[]} */
  const columns = filled([
    {
      title: "Share of greedy’s distance, a dot for each seed", isStrip: true,
      cell: (entry) => pooledStrip(entry, points.get(entry) ?? [], high),
    },
    {
      title: "Of best known", words: "Of the best known distance, where there is one",
      cell: ({ of_best_known }) => shareCell(of_best_known),
    },
    { ...WALKS, cell: ({ walkers }) => shareCell(walkers) },
    {
      title: "Reach greedy", words: "Get at least 95 % as far",
      cell: ({ reaches_greedy }) => shareCell(reaches_greedy),
    },
    {
      title: "Beats it at time-out", words: "Under the paper clock",
      cell: ({ beats_greedy: beats }) =>
        (beats ? { text: percentage(beats.share), note: POOLED_VERDICTS[beats.verdict] } : NONE),
    },
    { title: "Seeds", cell: ({ n }) => ({ text: whole(n) }) },
  ], pooled);
  const title = pooled.some(({ gaits }) => gaits.length > 1) ? "All gaits together" : "All seeds together";
  const rows = pooled.map((entry, n) =>
    ({ key: String(n), title: pooledName(entry, varied), cells: cellsOf(columns, entry) }));
  return { title, caption: `${title}: share of greedy’s distance`, heads: ["Setting"], columns, groups: [{ rows }] };
}

/** @param {PooledView} entry @param {number[]} points @param {number} high @returns {Cell} */
function pooledStrip({ relative, agent }, points, high) {
  const { text, note } = shareCell(relative ?? undefined);
  const typical = relative ?? { iqm: NaN, low: null, high: null };
  const label = `${points.length} seeds, typically ${text} of greedy’s distance`;
  const strip = { label, points, high, typical, marks: POOLED_MARKS, color: agentOf(agent).color, axis: percentage };
  return { text, note, isBold: true, strip };
}

/**
 * Every seed of the gaits that were pooled, as shares of greedy's distance.
 * @param {Summary} summary
 * @param {PooledView} entry
 */
function pooledPoints({ settings, parameters }, entry) {
  const greedyOf = greedyIn(settings);
  /** @param {Setting} setting */
  const isPooled = (setting) =>
    setting.role === "learner" && placeOf(setting) === placeOf(entry) &&
    ["agent", ...parameters].every((field) => setting[field] === entry[field]);
  return settings.filter(isPooled).flatMap((setting) => {
    const greedy_m = greedyOf(setting)?.total?.mean_m;
    return greedy_m ? (setting.total?.points_m ?? []).map((total_m) => total_m / greedy_m) : [];
  });
}

/** Fields that have words of their own in the name of a row. */
const NAMED_APART = ["agent", "observation", "robot", "steps"];

/**
 * The fields in which a row differs from the others.
 * @param {PooledView} entry
 * @param {string[]} varied
 */
function pooledName(entry, varied) {
  /** @param {string} field */
  const differs = (field) => varied.includes(field);
  const parameters = varied.filter((field) => !NAMED_APART.includes(field));
  const names = [
    differs("agent") && agentTitle(entry.agent),
    entry.blocks === 1 && differs("steps") && `${whole(entry.steps)} steps`,
    (!parameters.length || differs("observation")) && observationTitle(entry.observation),
    differs("robot") && robotTitle(entry.robot).toLowerCase(),
    fieldsInWords(entry, parameters),
  ];
  return sentence(names.filter(Boolean).join(", "));
}

// ---- learners against each other, and races under the real clock

/** @type {Record<string, string>} */
const VERSUS_VERDICTS = { yes: "better", no: "worse", "not established": "not established" };

/** The chance that a seed of one learner gets further than one of another. @param {Summary} summary @returns {Table} */
export const versusTable = ({ versus }) => ({
  caption: "Chance that a seed of the first gets further than a seed of the second",
  heads: ["Place"],
  columns: ["First", "Second", "Chance", "The first is"].map((title) => ({ title })),
  groups: [{
    rows: versus.map((pair, n) => ({
      key: String(n),
      title: gaitTitle(pair.gait),
      note: `${placeInWords(pair)}, ${whole(pair.steps)} steps`,
      cells: [
        { text: agentTitle(pair.a) }, { text: agentTitle(pair.b) },
        shareCell({ share: pair.probability, low: pair.low, high: pair.high }),
        { text: VERSUS_VERDICTS[pair.verdict] ?? pair.verdict },
      ],
    })),
  }],
});

/** A race in each place, in which decisions cost the time that they took. @param {Summary} summary @returns {Table} */
export const timedTable = ({ timed }) => ({
  caption: "Distance at time-out under the real clock",
  heads: ["Place"],
  columns: (timed[0]?.lanes ?? []).map(({ agent }) => ({ title: agentTitle(agent) })),
  groups: [{
    rows: timed.map((race, n) => ({
      key: String(n),
      title: gaitTitle(race.gait),
      note: placeInWords(race),
      cells: race.lanes.map(({ finished_distance_m, decision_s, rank }) => ({
        text: metres(finished_distance_m), isBold: rank === 1, badge: rank === 1 ? "first" : "",
        note: `${decision(decision_s / served().defaults.race.steps)} a decision`,
      })),
    })),
  }],
});

/** @param {{ observation: string, robot: string }} place */
const placeInWords = ({ observation, robot }) =>
  `${observationTitle(observation)}, ${robotTitle(robot).toLowerCase()}`;
