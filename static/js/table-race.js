// A race of trained runs against each other: each lane with the table of one.
import { adopt, attempt } from "./actions.js";
import { startRace } from "./api.js";
import { count, listed } from "./format.js";
import { changeIfStillHere } from "./page-state.js";
import { formRobot, isSame, numberOfLegs } from "./robots.js";
import { hasTable } from "./selectors.js";
import { limitsOf } from "./settings.js";
import { served } from "./store.js";
import { gaitTitle, robotTitle, simulatorTitle } from "./titles.js";

/** @import { DamagedRun, Run } from "./types.js" */

/** @param {Run | DamagedRun} run */
const titleOf = (run) => run.name || run.id;

/**
 * Settings that the tables of a race must share: [name, the value, it in words].
 * @type {[string, (run: Run) => unknown, (run: Run) => string][]}
 */
const SHARED = [
  ["gait", ({ config }) => config.gait, ({ config }) => gaitTitle(config.gait)],
  ["number of legs", ({ config }) => numberOfLegs(config.robot), ({ config }) => String(numberOfLegs(config.robot))],
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
 * Why runs cannot race each other with their tables, in a sentence; null if they can.
 * @param {(Run | DamagedRun)[]} runs
 */
export function obstacle(runs) {
  const strangers = runs.filter((run) => run.kind !== "training" || "damaged" in run);
  if (strangers.length) {
    return `Only trainings race with their tables: leave out ${listed(strangers.map(titleOf))}.`;
  }
  const trainings = /** @type {Run[]} */ (runs);
  const untrained = trainings.filter((run) => !hasTable(run));
  if (untrained.length) {
    const [first] = untrained;
    return `${titleOf(first)} is ${first.state}: a training races once it is finished or stopped.`;
  }
  const most = limitsOf("lanes").maximum ?? Infinity;
  if (runs.length < 2) return "Select at least two trainings.";
  if (runs.length > most) return `A race has up to ${most} lanes: choose fewer than ${count(runs.length, "training")}.`;
  const differences = differing(SHARED, trainings).map(([name, , words]) => {
    const values = [...new Set(trainings.map(words))];
    return `${name} (${listed(values.length > 1 ? values : ["custom ones"])})`;
  });
  if (differences.length === 0) return null;
  return `They cannot race each other, as they differ in ${listed(differences)}: `
    + "a Q-table fits only one gait, leg count and foot grid.";
}

/**
 * Of which run the race has what not all share: "on the robot of A"; null if they share it.
 * @param {Run[]} trainings
 */
export function conditionsOfRace(trainings) {
  const names = differing(FROM_FIRST, trainings).map(([name, , words]) => `${name} (${words(trainings[0])})`);
  return names.length ? `All race with the ${listed(names)} of ${titleOf(trainings[0])}.` : null;
}

/** @param {Run[]} trainings */
function bodyOf(trainings) {
  const { gait, robot, simulator, divisions, grid_side_m } = trainings[0].config;
  const { steps } = served().defaults.race;
  const [, most] = served().limits.name;
  return {
    gait, robot: formRobot(robot), simulator, divisions, grid_side_m, steps,
    name: `Race of ${listed(trainings.map(titleOf))}`.slice(0, most ?? undefined),
    lanes: trainings.map(({ id, config: { agent } }) => ({ agent, training_id: id })),
  };
}

/** Start the race, and show it. @param {Run[]} trainings */
export const raceThem = (trainings) =>
  attempt("table race", async () => {
    const go = changeIfStillHere();
    if (await adopt(() => startRace(bodyOf(trainings)))) go({ view: "race" });
  });
