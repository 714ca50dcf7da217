// Runs that are compared: which, what differs, where policies part, and which trained runs can race each other.
import assert from "node:assert/strict";
import { afterEach, beforeEach, mock, test } from "node:test";
import { signal } from "@preact/signals";
import {
  compared, comparedCurves, comparedIds, comparedResults, comparedSettings, leaveOut, leftOut, MAX_COMPARED,
} from "../../static/js/compare.js";
import { askAgain, differencesOf, followTables, haveSameStates, tableOf } from "../../static/js/compare-policies.js";
import { addressOf, page, read, write } from "../../static/js/page-state.js";
import { applyEvent, connection, options } from "../../static/js/store.js";
import { conditionsOfRace, obstacle, raceThem } from "../../static/js/table-race.js";
import { makeRun, OPTIONS } from "./options.js";

const STAGE = { run_id: null, next_run_id: null, playing: true, speed: 1, clock: "paper" };
const { config } = makeRun({});
/** @type {(changes: object, more?: object) => ReturnType<typeof makeRun>} */
const trained = (changes, more = {}) => makeRun({ config: { ...config, ...changes }, state: "finished", ...more });

/** @param {{ id: string }[]} runs */
function compare(...runs) {
  const known = runs.filter((run) => "kind" in run);
  applyEvent("snapshot", { runs: known, stage: STAGE, scene: null, role: "operator" });
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
  const told = compared.value.map(({ problem }) => problem?.split(":")[0] ?? null);
  assert.deepEqual(told, [
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

const GRID = { pairs: [[1, 4]], cells_m: /** @type {[number, number][]} */ ([[0, 0], [0, 1], [1, 0]]) };

/** A table of one pair on three cells: the best cell of each state, and whether the state was tried. */
const tableWith = (/** @type {number[]} */ best, /** @type {number[]} */ tries) => ({
  ...GRID, cell_names: ["home", "front", "back"], states: 3,
  values: best.map((cell) => [0, 1, 2].map((one) => (one === cell ? 0.05 : 0))),
  visits: tries.map((times) => [times, 0, 0]),
  best: best.map((cell) => /** @type {[number, number]} */ ([0, cell])),
});

test("policies differ where both have practised and their best moves are others", () => {
  const [one, other] = [tableWith([1, 2, 0], [3, 9, 0]), tableWith([2, 0, 1], [5, 4, 7])];
  const { different, compared: states, known } = differencesOf(one, other);
  assert.equal(states, 3);
  assert.deepEqual(known, { both: 2, one: 0, other: 1 });
  assert.deepEqual(different.map(({ index }) => index), [1, 0], "the most visited first");
  assert.deepEqual(different[0].bests.map(({ move, value, visits }) => [move, value, visits]), [
    [[0, 2], 0.05, 9], [[0, 0], 0.05, 4],
  ]);
  assert.equal(haveSameStates(one, other), true);
  assert.equal(haveSameStates(one, { ...other, pairs: [[2, 5]] }), false);
});

// ---- loading tables

/** Requests for tables: [training, step, first state]. @type {(string | null)[][]} */
let asked = [];
/** Steps that the server knows of. */
let newestStep = 0;
/** Status with which the server refuses; 0 where it does not. */
let refusedWith = 0;

/** Answers with two of three states at once. @param {URL} address */
function answerTo({ pathname, searchParams }) {
  const [step, first] = ["step", "first"].map((name) => searchParams.get(name));
  asked.push([pathname.split("/").at(-2) ?? "", step, first]);
  if (refusedWith) return new Response(JSON.stringify({ detail: "No." }), { status: refusedWith });
  const { values, visits, best, ...whole } = tableWith([1, 2, 0], [newestStep, 0, 0]);
  const part = [Number(first), Number(first) + 2];
  return new Response(JSON.stringify({
    ...whole, step: Number(step ?? newestStep), first: Number(first),
    values: values.slice(...part), visits: visits.slice(...part), best: best.slice(...part),
  }));
}

/** Let answers come, then let time pass. @param {number} ms */
async function pass(ms) {
  for (let turn = 0; turn < 5; turn += 1) {
    await new Promise((resolve) => {
      setImmediate(resolve);
    });
  }
  mock.timers.tick(ms);
}

/** Follow the table of a training that has done 10 steps. */
function followOne() {
  mock.timers.enable({ apis: ["setTimeout"] });
  globalThis.fetch = (address) => Promise.resolve(answerTo(new URL(String(address))));
  connection.value = "live";
  [asked, newestStep] = [[], 10];
  const run = signal(trained({}, { state: "running", progress: { done: 10, total: 100 } }));
  const stop = followTables(() => [run.value]);
  const proceed = (/** @type {number} */ done) => {
    newestStep = done;
    run.value = { ...run.value, progress: { ...run.value.progress, done } };
  };
  return { run, stop, proceed };
}

afterEach(() => mock.timers.reset());

test("the table of a training that runs is loaded now and then, all parts of one moment", async () => {
  const { run, stop, proceed } = followOne();
  assert.equal(tableOf(run.value), null);
  for (const done of [20, 30, 40]) proceed(done);
  await pass(2900);
  assert.deepEqual(asked.map(([, step, first]) => [step, first]), [[null, "0"], ["10", "2"]]);
  const { table } = tableOf(run.value) ?? {};
  assert.deepEqual(table?.visits.map(([times]) => times), [10, 0, 0]);
  await pass(200);
  assert.equal(tableOf(run.value)?.table, table, "the one before is shown until the next is whole");
  await pass(0);
  assert.equal(tableOf(run.value)?.table?.visits[0][0], 40);
  for (let n = 0; n < 5; n += 1) await pass(5000);
  assert.equal(asked.length, 4, "it has not changed since");
  stop();
});

test("a table that is refused for good is asked for once, another again", async () => {
  refusedWith = 409;
  const { run, stop, proceed } = followOne();
  for (const done of [20, 30]) {
    await pass(5000);
    proceed(done);
  }
  assert.deepEqual([asked.length, tableOf(run.value)?.problem], [1, "No."]);
  refusedWith = 503;
  askAgain();
  for (let n = 0; n < 3; n += 1) await pass(5000);
  assert.deepEqual([asked.length, tableOf(run.value)?.problem], [5, "No."]);
  refusedWith = 0;
  await pass(5000);
  await pass(5000);
  assert.equal(tableOf(run.value)?.table?.values.length, 3);
  stop();
});

test("trained runs race if gait and grid are the same, and else it says what differs", () => {
  const [one, other] = [trained({}, { name: "One" }), trained({ settings: { alpha: 0.9 } }, { name: "Other" })];
  assert.equal(obstacle([one, other]), null);
  assert.equal(conditionsOfRace([one, other]), null);
  const finer = trained({ divisions: 4 }, { name: "Finer" });
  const words = obstacle([one, finer]) ?? "";
  assert.match(words, /^They cannot race each other, as they differ in divisions of the foot grid \(2 and 4\): /);
  const running = trained({}, { name: "Young", state: "running" });
  assert.equal(obstacle([one, running]), "Young is running: a training races once it is finished or stopped.");
  const experiment = makeRun({ kind: "experiment", name: "All" });
  assert.equal(obstacle([one, experiment]), "Only trainings and races have robots that can race: leave out All.");
  assert.equal(obstacle([one]), "Select at least two runs with different robots.");
  const many = Array.from({ length: 20 }, () => trained({}));
  assert.match(obstacle(many) ?? "", /^A race has up to \d+ lanes, and these are 20 lanes: choose fewer\.$/);
  const ideal = trained({ simulator: config.simulator === "mujoco" ? "kinematic" : "mujoco" });
  assert.match(conditionsOfRace([one, ideal]) ?? "", /^All race with the simulator \(.*\) of One\.$/);
});

test("a race brings all its lanes, each as it was started, and a training only once", async () => {
  const [one, other] = [trained({}), trained({ settings: { alpha: 0.9 } })];
  const lane = { observation: "measured", keep_learning: false, plans_with: "world", settings: {} };
  const race = makeRun({
    kind: "race", name: "Race: Learner, Planner", is_named: false, state: "finished",
    config: { ...config, steps: 25, lanes: [
      { ...lane, agent: "learner", training_id: one.id, plans_with: null },
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
  applyEvent("snapshot", { runs: [one, other, race], stage: STAGE, scene: null, role: "operator" });
  await raceThem([race, one, other]);
  assert.deepEqual(sent.lanes, [
    { agent: "learner", training_id: one.id, observation: "measured", keep_learning: false },
    { agent: "planner", settings: { depth: 2 }, observation: "measured", keep_learning: false },
    { agent: "learner", training_id: other.id },
  ]);
  await raceThem([one, other]);
  assert.equal(sent.name, "Race of Learner: α\u00a00.3 and α\u00a00.9".slice(0, 20));
});
