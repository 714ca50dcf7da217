// Runs that are compared: which, what differs, and which trained runs can race each other.
import assert from "node:assert/strict";
import { beforeEach, test } from "node:test";
import {
  compared, comparedCurves, comparedIds, comparedResults, comparedSettings, leaveOut, leftOut, MAX_COMPARED,
} from "../../static/js/compare.js";
import { addressOf, page, read, write } from "../../static/js/page-state.js";
import { applyEvent, options } from "../../static/js/store.js";
import { conditionsOfRace, obstacle, raceThem } from "../../static/js/table-race.js";
import { makeRun, OPTIONS } from "./options.js";

const STAGE = { run_id: null, next_run_id: null, playing: true, speed: 1, clock: "paper" };
const { config } = makeRun({});
/** @type {(changes: object, more?: object) => ReturnType<typeof makeRun>} */
const trained = (changes, more = {}) => makeRun({ config: { ...config, ...changes }, state: "finished", ...more });

/** @param {{ id: string }[]} runs */
function compare(...runs) {
  const existing = runs.filter((run) => "kind" in run);
  applyEvent("snapshot", { runs: existing, stage: STAGE, scene: null, role: "operator" });
  page.compared.value = runs.map(({ id }) => id);
}

beforeEach(() => {
  options.value = OPTIONS;
  page.compared.value = [];
});

test("the address names the runs, each once, as many as can be told apart", () => {
  read({ search: "", hash: "#compare?runs=b, a,b,,c" });
  assert.deepEqual(comparedIds.value, ["b", "a", "c"]);
  assert.equal(write(), "#compare?runs=b,a,c");
  assert.equal(addressOf({ view: "compare", compared: ["a", "b c"] }), "#compare?runs=a,b+c");
  leaveOut("a");
  assert.deepEqual(comparedIds.value, ["b", "c"]);
  read({ search: "", hash: `#compare?runs=${"abcdefghijk".split("").join(",")}` });
  assert.deepEqual([comparedIds.value.length, leftOut.value], [MAX_COMPARED, 3]);
});

test("a run that is gone, cannot be read or is an experiment says so, and the others are compared", () => {
  const [run, experiment] = [trained({}), makeRun({ kind: "experiment" })];
  const damaged = { id: "bad", kind: "training", name: null, created_at: null, damaged: "its config is lost" };
  compare(run, experiment, damaged, { id: "gone" }, { id: "late" });
  applyEvent("run-deleted", { id: "gone" });
  const problems = compared.value.map(({ problem }) => problem?.split(":")[0] ?? null);
  assert.deepEqual(problems, [
    null, "It is an experiment, which has its own report", "It cannot be read", "There is no such run", null,
  ]);
  assert.deepEqual(compared.value.map(({ letter }) => letter), ["A", "B", "C", "D", "E"]);
  assert.equal(compared.value[4].run, null, "it is still requested");
});

test("settings that differ are marked; what a run does not have is no difference", () => {
  const race = makeRun({
    kind: "race",
    config: { gait: config.gait, robot: config.robot, simulator: config.simulator, divisions: config.divisions,
      grid_side_m: config.grid_side_m, seed: config.seed, steps: 25, lanes: [{ agent: "greedy" }] },
  });
  const disturbed = { disturbances: [{ kind: "limp", at_step: 25, legs: [1, 4] }] };
  compare(trained({ settings: { alpha: 0.3 } }), trained({ settings: { alpha: 0.5 }, ...disturbed }), race);
  const rows = Object.fromEntries(comparedSettings.value.map((row) => [row.name, row]));
  assert.deepEqual(rows.alpha.cells, ["0.3", "0.5", null]);
  assert.deepEqual(["alpha", "world", "kind"].map((name) => rows[name].differs), [true, true, true]);
  assert.deepEqual(["gait", "steps", "race_steps"].map((name) => rows[name].differs), [false, false, false]);
  assert.deepEqual(rows.race_steps.cells, [null, null, "25"]);
  assert.equal(rows.world.cells[0], "nothing");
  assert.equal(rows.changes, undefined, "nothing was changed in any");
});

test("results have the farthest marked, and the share of greedy's distance", () => {
  const times = { started_at: "2030-01-01T00:00:00.000Z", ended_at: "2030-01-01T00:00:42.000Z" };
  const result = { distance_m: 0.4, greedy_distance_m: 0.5, best_known_m: 0.6, fell_at_step: 11 };
  const other = { ...result, distance_m: 0.2, fell_at_step: null };
  compare(trained({}, { result, ...times }), trained({}, { result: other }));
  const rows = Object.fromEntries(comparedResults.value.map((row) => [row.name, row]));
  assert.deepEqual(rows.distance.best, [0]);
  assert.deepEqual(rows.share.cells, ["80 %", "40 %"]);
  assert.deepEqual(rows.falls.cells, ["step 12", null]);
  assert.deepEqual(rows["wall-time"].cells, ["42 s", null]);
  assert.equal(rows["best-known"].cells[0], "0.60\u00a0m");
});

test("curves are of trainings that have been evaluated; of others it says why there is none", () => {
  const [run, fresh] = [trained({}), trained({}, { state: "running" })];
  const race = makeRun({ kind: "race", config: { ...config, lanes: [] } });
  compare(run, fresh, race);
  applyEvent("evaluation", { run_id: run.id, step: 50, distance_m: 0.2, epsilon: 0.5 });
  const { shown, without } = comparedCurves.value;
  assert.deepEqual(shown.map(({ one, curve }) => [one.letter, curve.points.length]), [["A", 2]]);
  assert.deepEqual(without, [
    "C has no learning curve: a race does not practise.", "B has no evaluation yet.",
  ]);
});

test("trained runs race if gait and grid are the same, and else it says what differs", () => {
  const [first, other] = [trained({}, { name: "One" }), trained({ settings: { alpha: 0.9 } }, { name: "Other" })];
  assert.equal(obstacle([first, other]), null);
  assert.equal(conditionsOfRace([first, other]), null);
  const finer = trained({ divisions: 4 }, { name: "Finer" });
  const words = obstacle([first, finer]) ?? "";
  assert.match(words, /^They cannot race each other, as they differ in divisions of the foot grid \(2 and 4\): /);
  const running = trained({}, { name: "Young", state: "running" });
  assert.equal(obstacle([first, running]), "Young is running: a training races once it is finished or stopped.");
  const experiment = makeRun({ kind: "experiment", name: "All" });
  assert.equal(obstacle([first, experiment]), "Only trainings and races have robots that can race: leave out All.");
  assert.equal(obstacle([first]), "Select at least two runs with different robots.");
  const many = Array.from({ length: 20 }, () => trained({}));
  assert.match(obstacle(many) ?? "", /^A race has up to \d+ lanes, and these are 20 lanes: choose fewer\.$/);
  const ideal = trained({ simulator: config.simulator === "mujoco" ? "kinematic" : "mujoco" });
  assert.match(conditionsOfRace([first, ideal]) ?? "", /^All race with the simulator \(.*\) of One\.$/);
});

test("a race brings all its lanes, each as it was started, and a training only once", async () => {
  const [first, other] = [trained({}), trained({ settings: { alpha: 0.9 } })];
  const lane = { observation: "measured", keep_learning: false, plans_with: "world", settings: {} };
  const race = makeRun({
    kind: "race", name: "Race: Learner, Planner", is_named: false, state: "finished",
    config: { ...config, steps: 25, lanes: [
      { ...lane, agent: "learner", training_id: first.id, plans_with: null },
      { ...lane, agent: "planner", settings: { depth: 2 }, plans_with_by_default: true },
    ] },
  });
  assert.equal(obstacle([race, other]), null);
  assert.equal(obstacle([{ ...race, state: "running" }, other]),
    "Race: Learner, Planner is running: its robots race once it has ended.");
  /** @type {any} */
  let sent = null;
  globalThis.fetch = /** @type {any} */ ((/** @type {URL} */ _address, /** @type {RequestInit} */ { body }) => {
    sent = JSON.parse(String(body));
    return Promise.resolve(new Response(JSON.stringify(makeRun({ kind: "race", config: { lanes: [] } }))));
  });
  applyEvent("snapshot", { runs: [first, other, race], stage: STAGE, scene: null, role: "operator" });
  await raceThem([race, first, other]);
  assert.deepEqual(sent.lanes, [
    { agent: "learner", training_id: first.id, observation: "measured", keep_learning: false },
    { agent: "planner", settings: { depth: 2 }, observation: "measured", keep_learning: false },
    { agent: "learner", training_id: other.id },
  ]);
  await raceThem([first, other]);
  assert.equal(sent.name, "Race of Learner: α\u00a00.3 and α\u00a00.9".slice(0, 20));
});
