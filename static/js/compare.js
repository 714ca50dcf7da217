// Runs that are compared: which, each one's letter, colour and dashes, their curves, settings and results.
import { computed } from "@preact/signals";
import { changesInWords, curveOf, followCurves, rateChanges } from "./training.js";
import { disturbancesOf, inTime, joinedBySteps } from "./disturbances.js";
import { count, duration, listed, metres, percentage, sentence, whole } from "./format.js";
import { page } from "./page-state.js";
import { formRobot } from "./robots.js";
import { greedyOf, namesAmong, NO_SUCH_RUN } from "./run-words.js";
import { distanceOf, followRuns } from "./runs.js";
import { isActive, isWalk } from "./selectors.js";
import { agentOf, choiceTitle, fullTitle, laneTitle, settingsOf } from "./settings.js";
import { damagedRuns, isGone, runs, served } from "./store.js";
import { agentTitle, gaitTitle, observationTitle, robotTitle, simulatorTitle } from "./titles.js";

/** @import { Signal } from "@preact/signals" */
/** @import { LaneResult, Run } from "./types.js" */

/** With more, their lines cannot be told apart. */
export const MAX_COMPARED = 8;
const LETTERS = "ABCDEFGH";
/** Of runs, which may all have the same agent: Okabe and Ito's colours, and dashes for who cannot tell them apart. */
export const COLOURS = ["#0072B2", "#D55E00", "#009E73", "#CC79A7", "#E69F00", "#56B4E9", "#8A6D3B", "#7F7F7F"];
const DASHES = [[], [8, 4], [2, 3], [10, 3, 2, 3], [5, 3], [12, 3, 2, 3, 2, 3], [1, 2], [14, 5]];

// ---- which runs: `#compare?runs=a,b,c`

/** Ids of the runs that are compared, in their order. */
export const comparedIds = computed(() => page.compared.value.slice(0, MAX_COMPARED));

/** Number of runs that a link names beyond those that can be compared. */
export const leftOut = computed(() => page.compared.value.length - comparedIds.value.length);

/** @param {string} id */
export const leaveOut = (id) => (page.compared.value = comparedIds.value.filter((other) => other !== id));

/** Keep the runs and their curves, while the view is open. */
export function followCompared() {
  followRuns(computed(() => (page.view.value === "compare" ? comparedIds.value : [])));
  followCurves(computed(() => (page.view.value === "compare" ? comparedTrainings.value : [])));
}

/**
 * A run of the comparison; `problem` says why it cannot be compared. Without either it is still requested.
 * @typedef {object} Compared
 * @property {string} id
 * @property {string} letter
 * @property {string} color
 * @property {number[]} dash
 * @property {string} title
 * @property {Run | null} run
 * @property {string | null} problem
 */

/** Names of the runs that are known, by what they differ in. @type {Signal<Map<string, string>>} */
const names = computed(() => {
  const comparedRuns = comparedIds.value.flatMap((id) => runs.value.get(id) ?? []);
  const all = namesAmong(comparedRuns);
  return new Map(comparedRuns.map(({ id }, n) => [id, all[n]]));
});

/** @type {Signal<Compared[]>} */
export const compared = computed(() =>
  comparedIds.value.map((id, number) => {
    const run = runs.value.get(id) ?? null;
    const problem = problemOf(id, run);
    return {
      id, letter: LETTERS[number], color: COLOURS[number], dash: DASHES[number], problem,
      title: names.value.get(id) ?? id, run: problem ? null : run,
    };
  }),
);

/** @type {(id: string, run: Run | null) => string | null} */
function problemOf(id, run) {
  if (run && !isWalk(run)) return `It is an ${run.kind}, which has its own report: choose trainings and races.`;
  if (run) return null;
  const damaged = damagedRuns.value.get(id);
  if (damaged) return `It cannot be read: ${damaged.damaged}`;
  if (isGone(id)) return NO_SUCH_RUN;
  return null;
}

/** @typedef {Compared & { run: Run }} Comparable */

/** Those that can be compared. */
export const comparable = computed(() =>
  /** @type {Comparable[]} */ (compared.value.filter((entry) => entry.run !== null)));
/** @param {Comparable} comparable */
const runOf = ({ run }) => run;
const comparedTrainings = computed(() => comparable.value.map(runOf).filter(({ kind }) => kind === "training"));

// ---- their learning curves

/** The curves of trainings that have been evaluated, and why each other run has none, in a sentence. */
export const comparedCurves = computed(() => {
  const trainings = comparable.value.filter(({ run }) => run.kind === "training");
  const curves = trainings.map((training) => ({ one: training, curve: curveOf(training.run) }));
  const shown = curves.filter(({ curve }) => curve.points.length > 1);
  const races = comparable.value.filter(({ run }) => run.kind === "race");
  const unmeasured = curves.filter(({ curve }) => curve.points.length < 2).map(({ one: curve }) => curve);
  const letters = (/** @type {Compared[]} */ ones) => listed(ones.map(({ letter }) => letter));
  const none = (/** @type {Compared[]} */ ones, /** @type {string} */ words) =>
    (ones.length ? [`${letters(ones)} ${ones.length === 1 ? "has" : "have"} no ${words}.`] : []);
  return {
    shown,
    without: [...none(races, "learning curve: a race does not practise"), ...none(unmeasured, "evaluation yet")],
  };
});

// ---- tables with a column for each run: settings and results

/**
 * A row of such a table; a cell is null where a run has nothing of it.
 * @typedef {{ name: string, title: string, cells: (string | null)[], differs: boolean, best: number[] }} Row
 */

/** Whether values differ; a missing one does not. @type {(cells: (string | null)[]) => boolean} */
const differ = (cells) => new Set(cells.filter((cell) => cell !== null)).size > 1;

/** @type {(name: string, title: string, cells: (string | null)[], best?: number[]) => Row} */
const row = (name, title, cells, best = []) => ({ name, title, cells, differs: differ(cells), best });

/** Fields of configs that are told in words of their own. @type {[string, string, (run: Run) => string | null][]} */
const SETTINGS = [
  ["kind", "Kind", ({ kind }) => sentence(kind)],
  ["agent", "Learner", ({ config }) => (config.agent ? agentTitle(config.agent) : null)],
  ["lanes", "Lanes", ({ kind, config }) => (kind === "race" ? config.lanes.map(laneTitle).join("; ") : null)],
  ["gait", "Gait", ({ config }) => gaitInWords(config.gait)],
  ["robot", "Robot", ({ config }) => robotTitle(formRobot(config.robot))],
  ["simulator", "Simulator", ({ config }) => sentence(simulatorTitle(config.simulator))],
  ["observation", "Observation", ({ config: { observation } }) =>
    (observation ? sentence(observationTitle(observation)) : null)],
];

/** @param {import("./types.js").GaitConfig} gait */
const gaitInWords = (gait) => (typeof gait === "string" ? gaitTitle(gait) : `Custom: ${JSON.stringify(gait)}`);

/** Fields that are told as they are declared, and the kinds that have them. @type {[string, string][]} */
const PLAIN = [
  ["divisions", ""], ["grid_side_m", ""], ["reward", ""], ["seed", ""], ["steps", "training"],
  ["steps_per_episode", "training"], ["evaluate_every", "training"], ["race_steps", "race"],
];

const NOTHING = "nothing";

/** Rows after the settings. @type {[string, string, (run: Run) => string | null][]} */
const DISTURBANCES = [
  ["continue_from", "Continues", ({ kind, config: { continue_from: id } }) => {
    if (kind === "race") return null;
    return id ? runs.value.get(id)?.name ?? id : NOTHING;
  }],
  ["world", "Disturbances", (run) => joinedBySteps(disturbancesOf(run)).map(inTime).join("; ") || NOTHING],
  ["changes", "Changed while it ran", (run) =>
    (run.kind === "training" ? changesInWords(run.config.agent, rateChanges(run)).join(", ") || NOTHING : null)],
];

/** The settings of trainings and races side by side. @param {Run[]} all */
export function settingRows(all) {
  const agents = [...new Set(all.flatMap(({ config: { agent } }) => (agent ? [agent] : [])))];
  const agentRows = Object.entries(settingsOf(agents)).map(([name, setting]) =>
    row(name, fullTitle(setting), all.map(({ config }) =>
      valueInWords(setting, config.agent ? config.settings[name] : null))));
  const plain = PLAIN.map(([name, kind]) => {
    const setting = served().settings[name];
    const field = name === "race_steps" ? "steps" : name;
    const cells = all.map((run) => (["", run.kind].includes(kind) ? valueInWords(setting, run.config[field]) : null));
    return row(name, fullTitle(setting), cells);
  });
  const rowsOfSettings = (/** @type {typeof SETTINGS} */ list) =>
    list.map(([name, title, cell]) => row(name, title, all.map(cell)));
  return [...rowsOfSettings(SETTINGS), ...plain, ...agentRows, ...rowsOfSettings(DISTURBANCES)].filter(isTold);
}

/** The settings of the runs that are compared. */
export const comparedSettings = computed(() => settingRows(comparable.value.map(runOf)));

/** Whether any run has something of a row. @param {Row} row */
const isTold = ({ cells }) => cells.some((cell) => cell !== null && cell !== NOTHING);

/** @type {(setting: import("./types.js").SettingOption, value: any) => string | null} */
function valueInWords(setting, value) {
  if (value === null || value === undefined) return null;
  if (typeof value === "boolean") return value ? "yes" : "no";
  if (typeof value === "number") return setting.is_whole ? whole(value) : String(value);
  return setting.choices.length ? choiceTitle(setting, value) : String(value);
}

/** @param {Run} run */
const lanesOf = ({ result }) => result?.lanes ?? [];
/** @param {LaneResult} lane */
const atTimeOut = ({ clocks }) => clocks.paper.finished_distance_m;
/** @param {Run} run */
const bestKnownOf = (run) => run.result?.best_known_m ?? run.best_known_m ?? null;

/** @param {Run} run */
function wallTime({ started_at, ended_at }) {
  if (!started_at || !ended_at) return null;
  return duration((Date.parse(ended_at) - Date.parse(started_at)) / 1000);
}

/** @param {Run} run */
function falls(run) {
  const fell = (/** @type {number | null | undefined} */ step) =>
    (typeof step === "number" ? `step ${whole(step + 1)}` : "");
  if (run.kind === "training") return fell(run.result?.fell_at_step) || null;
  const fallen = lanesOf(run).filter(({ fell_at_step: step }) => typeof step === "number");
  return fallen.map((lane) => `${agentOf(lane.agent).title}: ${fell(lane.fell_at_step)}`).join("; ") || null;
}

/** @param {Run} run */
const lanesInWords = (run) =>
  lanesOf(run).map((lane) => `${agentOf(lane.agent).title} ${metres(atTimeOut(lane))}`).join("; ") || null;

/** @type {(value: number | null) => string | null} */
const metresOrNull = (value) => (value === null ? null : metres(value));

/** Results of the runs, side by side. */
export const comparedResults = computed(() => {
  const all = comparable.value.map(runOf);
  const distances = all.map(distanceOf);
  const most = Math.max(...distances.map((distance) => distance ?? -Infinity));
  // A race and a training have other numbers of steps.
  const isAlike = all.length > 1 && all.every(({ kind }) => kind === all[0].kind);
  const best = isAlike ? distances.flatMap((distance, n) => (distance !== null && distance === most ? [n] : [])) : [];
  const shares = all.map((run, n) => {
    const [distance, greedy] = [distances[n], greedyOf(run)];
    return distance !== null && greedy ? percentage(distance / greedy) : null;
  });
  const practised = (/** @type {Run} */ { kind, progress }) =>
    (kind === "training" ? count(progress.done, "step") : null);
  return [
    row("state", "State", all.map(({ state }) => sentence(state))),
    row("distance", "Distance", distances.map(metresOrNull), best),
    row("lanes", "Each lane at time-out", all.map(lanesInWords)),
    row("greedy", "Greedy’s distance", all.map((run) => metresOrNull(greedyOf(run)))),
    row("share", "Share of greedy’s", shares),
    row("best-known", "Best known", all.map((run) => metresOrNull(bestKnownOf(run)))),
    row("practice", "Practised", all.map(practised)),
    row("falls", "Fell at", all.map(falls)),
    row("wall-time", "Wall time", all.map((run) => (isActive(run) ? "still running" : wallTime(run)))),
  ].filter(isTold);
});
