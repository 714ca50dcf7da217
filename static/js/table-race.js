// A race of runs against each other: a lane for each training, with its table, and those of each race.
import { adopt, attempt } from "./actions.js";
import { startRace } from "./api.js";
import { count, listed } from "./format.js";
import { changeIfStillHere } from "./page-state.js";
import { disturbancesOf } from "./disturbances.js";
import { canonical, formRobot, isSame, numberOfLegs } from "./robots.js";
import { isNamed, namesAmong, titleOf } from "./run-words.js";
import { hasTable, isActive, isWalk } from "./selectors.js";
import { limitsOf } from "./settings.js";
import { served } from "./store.js";
import { agentTitle, gaitTitle, robotTitle, simulatorTitle } from "./titles.js";

/** @import { DamagedRun, LaneConfig, Run } from "./types.js" */

/** @type {(run: Run) => number} */
const legsOf = ({ config }) => numberOfLegs(config.robot, served().robots);

/**
 * Settings that the tables of a race must share: [name, the value, it in words].
 * @type {[string, (run: Run) => unknown, (run: Run) => string][]}
 */
const SHARED = [
  ["gait", ({ config }) => config.gait, ({ config }) => gaitTitle(config.gait)],
  ["number of legs", legsOf, (run) => String(legsOf(run))],
  ["divisions of the foot grid", ({ config }) => config.divisions, ({ config }) => String(config.divisions)],
  ["side of the foot grid", ({ config }) => config.grid_side_m, ({ config }) => `${config.grid_side_m} m`],
];

/** Values that the race takes from the first training, where others have another. @type {typeof SHARED} */
const FROM_FIRST = [
  ["robot", ({ config }) => formRobot(config.robot), ({ config }) => robotTitle(formRobot(config.robot))],
  ["simulator", ({ config }) => config.simulator, ({ config }) => simulatorTitle(config.simulator)],
];

/** Those of some properties in which runs differ. @type {(list: typeof SHARED, runs: Run[]) => typeof SHARED} */
const differing = (list, runs) => list.filter(([, value]) => runs.some((run) => !isSame(value(run), value(runs[0]))));

/**
 * A lane of a race as it was started: what its search knows by default depends on its race.
 * @param {LaneConfig} lane
 */
function asStarted({ agent, training_id = null, settings, observation, keep_learning, ...lane }) {
  const learned = training_id === null ? { settings } : { training_id };
  const model = lane.plans_with && !lane.plans_with_by_default ? { plans_with: lane.plans_with } : {};
  return { agent, ...learned, observation, keep_learning, ...model };
}

/** The lanes of a race of these runs, each once. @param {Run[]} runs */
function lanesOf(runs) {
  const all = runs.flatMap(({ id, kind, config }) => /** @type {Partial<LaneConfig>[]} */ (
    kind === "race" ? config.lanes.map(asStarted) : [{ agent: config.agent, training_id: id }]));
  // A training and a race that used its table have one lane together.
  const keyOf = (/** @type {Partial<LaneConfig>} */ lane) => lane.training_id ?? canonical(lane);
  return all.filter((lane, n) => all.findIndex((other) => keyOf(other) === keyOf(lane)) === n);
}

/**
 * Why runs cannot race each other, in a sentence; null if they can.
 * @param {(Run | DamagedRun)[]} runs
 */
export function obstacle(runs) {
  const strangers = runs.filter((run) => "damaged" in run || !isWalk(run));
  if (strangers.length) {
    return `Only trainings and races have robots that can race: leave out ${listed(strangers.map(titleOf))}.`;
  }
  const walks = /** @type {Run[]} */ (runs);
  const [untrained] = walks.filter((run) => (run.kind === "training" ? !hasTable(run) : isActive(run)));
  if (untrained) {
    const isTraining = untrained.kind === "training";
    const words = isTraining ? "a training races once it is finished or stopped" : "its robots race once it has ended";
    return `${titleOf(untrained)} is ${untrained.state}: ${words}.`;
  }
  const most = limitsOf("lanes").maximum ?? Infinity;
  const { length } = lanesOf(walks);
  if (runs.length < 2 || length < 2) return "Select at least two runs with different robots.";
  if (length > most) return `A race has up to ${most} lanes, and these are ${count(length, "lane")}: choose fewer.`;
  const differences = differing(SHARED, walks).map(([name, , words]) => {
    const values = [...new Set(walks.map(words))];
    return `${name} (${listed(values.length > 1 ? values : ["custom ones"])})`;
  });
  if (differences.length === 0) return null;
  return `They cannot race each other, as they differ in ${listed(differences)}: `
    + "a Q-table fits only one gait, leg count and foot grid.";
}

/**
 * What the race has that not all runs share: the robot of the first, flat ground; null if there is nothing.
 * @param {Run[]} runs
 */
export function conditionsOfRace(runs) {
  const names = differing(FROM_FIRST, runs).map(([name, , words]) => `${name} (${words(runs[0])})`);
  const ofFirst = names.length ? [`All race with the ${listed(names)} of ${titleOf(runs[0])}.`] : [];
  const ground = runs.some((run) => disturbancesOf(run).length) ? ["Nothing happens to the robots in this race."] : [];
  return [...ofFirst, ...ground].join(" ") || null;
}

/** @param {Run[]} runs */
function bodyOf(runs) {
  const { gait, robot, simulator, divisions, grid_side_m } = runs[0].config;
  const { steps } = served().defaults.race;
  const [, most] = served().limits.name;
  return {
    gait, robot: formRobot(robot), simulator, divisions, grid_side_m, steps,
    name: nameOf(runs).slice(0, most ?? undefined), lanes: lanesOf(runs),
  };
}

/** "Race of Anna's and Ben's", "Race of Q-learning: α 0.3 and α 0.5". @param {Run[]} runs */
function nameOf(runs) {
  const agents = new Set(runs.map(({ kind, config }) => (kind === "race" ? null : config.agent)));
  const [agent] = agents;
  const isOfOne = agents.size === 1 && agent && !runs.some(isNamed);
  return `Race of ${isOfOne ? `${agentTitle(agent)}: ` : ""}${listed(namesAmong(runs))}`;
}

/** Start the race, and show it. @param {Run[]} runs */
export const raceThem = (runs) =>
  attempt("table race", async () => {
    const go = changeIfStillHere();
    if (await adopt(() => startRace(bodyOf(runs)))) go({ view: "race" });
  });
