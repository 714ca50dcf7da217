// The result of an experiment as data: which charts and tables it has, what its switches choose from, and what is said
// of them. All of it follows from the experiment's measure and axes.
import { placeOf, placesOf, unit, UNIT_NAMES } from "./distances.js";
import { experimentKind } from "./kinds.js";
import { blocksCurve, curveCharts, levelsOf, worldCurve } from "./result-curves.js";
import { paperTable, SETTINGS_TITLE, settingsTable } from "./result-tables.js";
import { isRecovery, overviewTable, UNTIL, worldTables } from "./result-worlds.js";
import { worldTitle } from "../../js/disturbances.js";
import { percentage, sentence } from "../../js/format.js";
import { agentOf, served } from "../../js/settings.js";

/** @import { CurveChart, Level } from "./result-curves.js" */
/** @import { Table } from "./result-tables.js" */
/** @import { Place, Summary, WorldView } from "../../js/types.js" */

/** One of those that the switches choose: a world and a place; null where the result is of all together. */
/** @typedef {{ world: string | null, place: Place | null }} Case */
/** @typedef {{ order: string }} View what else is chosen: the order of rows, "grid" or "best" */
/**
 * @typedef {object} Result
 * @property {string} title
 * @property {Case[]} cases
 * @property {string[]} [orders] in which rows can be shown
 * @property {(entry: Case) => string} about
 * @property {string[]} signs of strips, as `StripKey` has them
 * @property {string} [color] of their dots
 * @property {string[]} agents with a curve
 * @property {Level[]} levels of references
 * @property {(string | false | 0 | undefined)[]} notes
 * @property {(entry: Case, view: View) => { charts: CurveChart[], tables: Table[] }} contentOf
 */

const STRIP_SIGNS = ["seed", "typical", "greedy", "best-known", "published"];
const CURVE_WORDS = "Line: interquartile mean; band: its 95 % interval.";
const SEED_LINES = "Thin: each seed.";
const ONE_GO = "Dotted: as many steps in one go, in which ε falls once and not in each block.";

const TIME_OUT = "At time-out: under the paper clock, when the first lane has used its steps.";
/** @type {Record<string, string>} */
const UNIT_NOTES = {
  m: `Metres over 50 steps. ${TIME_OUT}`,
  h: `h is half the side of the foot grid. ${TIME_OUT}`,
  greedy: "Share of greedy’s total distance in the same place; the paper’s values as a share of its own greedy’s.",
};
const PAPERS = `The paper’s values are of one run. †: outside the central 95 % of the seeds here. Agents that look
  ahead throw no dice: one walk is enough.`;

/** The result of an experiment; null before there is any. @param {Summary} summary @returns {Result | null} */
export function resultOf(summary) {
  const kind = experimentKind(summary.experiment);
  if (!kind) return null;
  const title = `${kind.title}, with every seed`;
  if (kind.measure === "distance") return kind.is_published ? paperResult(summary, title) : settingsResult(summary);
  return kind.measure === "blocks" ? blocksResult(summary, title) : worldsResult(summary);
}

/**
 * Definition of the best known distance, and the cases that have one if some lack it.
 * @param {(number | null | undefined)[]} distances
 */
function bestKnownNote(distances) {
  const { best_known, best_known_where } = served().help;
  return `${best_known} ${distances.every((distance) => typeof distance === "number") ? "" : best_known_where}`;
}

/** @param {Parameters<typeof placesOf>[0]} entries @returns {Case[]} */
const inPlaces = (entries) => placesOf(entries).map((place) => ({ world: null, place }));

/** @param {Summary} summary @param {string} title @returns {Result} */
const paperResult = (summary, title) => ({
  title,
  cases: inPlaces(summary.settings),
  about: () => "",
  signs: STRIP_SIGNS,
  color: agentOf(summary.settings.find(({ role }) => role === "learner")?.agent ?? "").color,
  agents: [],
  levels: [],
  notes: [
    `${UNIT_NOTES[unit.value]} ${PAPERS}`, bestKnownNote(summary.settings.map(({ best_known_m }) => best_known_m)),
  ],
  contentOf: ({ place }) => ({ charts: [], tables: [paperTable(summary, place?.key ?? "")] }),
});

/** @param {Summary} summary @returns {Result} */
function settingsResult(summary) {
  const distances = summary.settings.map(({ best_known_m }) => best_known_m);
  const hasBest = distances.some((distance) => typeof distance === "number");
  const agents = new Set(summary.settings.filter(({ role }) => role === "learner").map(({ agent }) => agent));
  return {
    title: SETTINGS_TITLE,
    cases: [{ world: null, place: null }],
    orders: ["grid", "best"],
    about: () => "",
    signs: STRIP_SIGNS.filter((sign) => sign !== "published" && (hasBest || sign !== "best-known")),
    color: agents.size === 1 ? agentOf([...agents][0]).color : "var(--dim)",
    agents: [],
    levels: [],
    notes: [hasBest && bestKnownNote(distances)],
    contentOf: (_, { order }) => ({ charts: [], tables: [settingsTable(summary, order)] }),
  };
}

/** @param {Summary} summary @param {string} title @returns {Result | null} */
function blocksResult(summary, title) {
  const curves = summary.curves.filter(({ steps }) => steps.length > 0);
  const learning = curves.map(blocksCurve);
  return curves.length ? {
    title,
    cases: inPlaces(curves),
    about: () => [
      `${sentence(UNIT_NAMES[unit.value])}, against steps of practice. ${CURVE_WORDS} ${SEED_LINES}`,
      learning.some(({ isInOneGo }) => isInOneGo) ? ONE_GO : "",
    ].join(" "),
    signs: [],
    agents: [...new Set(curves.map(({ agent }) => agent))],
    levels: oneOfEachKind(learning.flatMap(levelsOf)),
    notes: [bestKnownNote(curves.map(({ best_known_m }) => best_known_m))],
    contentOf: ({ place }) => ({
      charts: curveCharts(
        curves.filter((curve) => placeOf(curve) === place?.key).map(blocksCurve), summary.config, "steps of practice"),
      tables: [],
    }),
  } : null;
}

/** @param {Level[]} levels */
const oneOfEachKind = (levels) => [...new Map(levels.map((level) => [level.kind, level])).values()];

// ---- worlds: along the practice, or after something has happened

/** The question that an experiment asks, by what it varies. @param {Summary} summary */
function questionOf(summary) {
  if (isRecovery(summary)) return "Recovery by agent and disturbance";
  const { robots = [], worlds = [] } = summary.config;
  return `Distances by agent and ${robots.length > 1 ? "body" : worlds.length > 1 ? "world" : "gait"}`;
}

/** @param {WorldView[]} entries @returns {Case[]} */
const inWorlds = (entries) => [...new Set(entries.map(({ world }) => String(world)))].flatMap((world) =>
  placesOf(entries.filter((entry) => entry.world === world)).map((place) => ({ world, place })));

/** @param {Summary} summary @returns {Result | null} */
function worldsResult(summary) {
  const entries = summary.worlds ?? [];
  const steps = isRecovery(summary) ? "steps after it happened" : "steps of practice";
  return entries.length ? {
    title: questionOf(summary),
    cases: inWorlds(entries),
    about: ({ world }) => `${worldTitle(world ?? "")}: ${UNIT_NAMES[unit.value]}, against ${steps}. ${CURVE_WORDS}`,
    signs: [],
    agents: [...new Set(entries.filter(({ curve }) => curve).map(({ agent }) => agent))],
    levels: oneOfEachKind(entries.flatMap(levelsOf)),
    notes: [worldsNote(summary), bestKnownNote(entries.map(({ best_known_m }) => best_known_m))],
    contentOf: ({ world, place }) => {
      const here = entries.filter((entry) => entry.world === world && placeOf(entry) === place?.key);
      const gaits = [...new Set(here.map(({ gait }) => gait))];
      return {
        charts: curveCharts(here.flatMap((entry) => worldCurve(entry, summary)), summary.config, steps),
        tables: gaits.flatMap((gait) => worldTables(summary, here.filter((entry) => entry.gait === gait))),
      };
    },
  } : null;
}

/** What the words of the tables mean. @param {Summary} summary */
const worldsNote = (summary) => [
  "Metres in 50 steps from rest. Mean: the area under the curve, divided by its steps.",
  `Steps to a share of a reference: ${UNTIL.toLowerCase()}.`,
  isRecovery(summary) && "Who looks ahead walks in that world from the start. Earned: the sum of the rewards of " +
    "those steps of the practice itself, which explores; a reward is the way along " +
    `${summary.config.reward === "track" ? "the track" : "the robot’s own heading"}.`,
  summary.config.tolerance && "Each seed draws the robot that everyone walks with: lengths, masses, servo gains, " +
    `friction and mounting angles within ${percentage(summary.config.tolerance)} of its design.`,
].filter(Boolean).join(" ");

/**
 * All worlds beside each other, in a place; null where there is only one.
 * @param {Summary} summary
 * @param {Place | null} place
 * @returns {Table | null}
 */
export function overviewOf(summary, place) {
  const entries = (summary.worlds ?? []).filter((entry) => placeOf(entry) === place?.key);
  const worlds = [...new Set((summary.worlds ?? []).map(({ world }) => String(world)))];
  return worlds.length > 1 ? overviewTable(summary, entries, worlds) : null;
}
