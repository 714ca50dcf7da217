// The list of runs as a notebook: which runs belong together, what they are called there, and what came of them.
import assert from "node:assert/strict";
import { beforeEach, test } from "node:test";
import { shortTime } from "../../static/js/format.js";
import { COLUMNS, shownColumns, toggleColumn } from "../../static/js/run-columns.js";
import { change, page, read, write } from "../../static/js/page-state.js";
import { byValue, groupRuns } from "../../static/js/run-groups.js";
import { grouping, listedRuns, runGroups, setGrouping } from "../../static/js/run-list.js";
import { factsOf, namesAmong, outcomeInWords, shareOf, withResult } from "../../static/js/run-words.js";
import { applyEvent, connection, options } from "../../static/js/store.js";
import { makeRun, OPTIONS } from "./options.js";

/** @import { Run } from "../../static/js/types.js" */

const STAGE = { run_id: null, next_run_id: null, playing: true, speed: 1, clock: "paper" };
const { config } = makeRun({});

/** @type {(changes?: { settings?: object, [field: string]: unknown }, more?: object) => Run} */
const trained = ({ settings = {}, ...changes } = {}, more = {}) => makeRun({
  name: "Learner, 500 steps", is_named: false,
  config: { ...config, ...changes, settings: { ...config.settings, ...settings } }, ...more,
});
const LANES = [{ agent: "learner", training_id: null }, { agent: "greedy" }];
/** @type {(changes?: object, more?: object) => Run} */
const raced = (changes = {}, more = {}) => makeRun({
  kind: "race", name: "Race: Learner, Greedy", is_named: false,
  config: { gait: config.gait, robot: config.robot, simulator: config.simulator, divisions: config.divisions,
    grid_side_m: config.grid_side_m, disturbances: [], tolerance: 0, steps: 50, seed: 0, lanes: LANES, ...changes },
  ...more,
});

/** The runs are given from the oldest on. @param {Run[]} runs @param {string} [by] */
function grouped(runs, by = "sweep") {
  applyEvent("snapshot", { runs, stage: STAGE, scene: null, role: "operator" });
  const newestFirst = runs.toReversed();
  return groupRuns({ runs: newestFirst, by, everyRun: newestFirst });
}
/** @param {ReturnType<typeof groupRuns>} groups */
const inShort = (groups) => groups.map(({ title, rows }) => [title, ...rows.map(({ name }) => name)]);

beforeEach(() => {
  options.value = OPTIONS;
  connection.value = "live";
  change({ grouping: null, columns: null, list: new URLSearchParams(), selected: [] });
});

test("trainings that differ in one setting are a sweep, the newest first; the others stand on their own", () => {
  const alpha = [0.5, 0.1, 0.3].map((value) => trained({ settings: { alpha: value } }));
  const other = trained({ gait: "wave", steps: 20, seed: 4 });
  const groups = grouped([...alpha, other]);
  assert.deepEqual(inShort(groups), [
    ["On its own", "Learner, 500 steps"], ["Sweep of α", "α\u00a00.3", "α\u00a00.1", "α\u00a00.5"],
  ]);
  assert.deepEqual(groups[1].facts, ["Learner", "500 steps", "The tripod", "seed\u00a00"]);
  assert.deepEqual(groups[0].rows[0].facts, ["20 steps", "The wave", "seed\u00a04"]);
  const byName = groupRuns({ runs: [alpha[1], alpha[2], alpha[0]], by: "sweep", everyRun: alpha });
  assert.deepEqual(inShort(byName)[0].slice(1), ["α\u00a00.1", "α\u00a00.3", "α\u00a00.5"], "as the list is ordered");
});

test("a name that a person gave stays, and what differs stands beside it", () => {
  const [first, other] = [trained(), trained({ seed: 7 }, { name: "Anna’s", is_named: true })];
  const [group] = grouped([first, other]);
  assert.equal(group.title, "Seeds");
  assert.deepEqual(group.rows.map(({ name, facts }) => [name, ...facts]), [["Anna’s", "Seed\u00a07"], ["Seed\u00a00"]]);
});

test("a setting by default is no difference between learners that have other defaults", () => {
  const tracer = { agent: "tracer", settings: { alpha: 0.1, trace: 0.9, kind: "replacing" } };
  const [run, other] = [trained(), makeRun({ name: "Tracer", is_named: false, config: { ...config, ...tracer } })];
  assert.deepEqual(inShort(grouped([run, other])), [["Learners", "Tracer", "Learner"]]);
  const odd = { ...tracer, settings: { ...tracer.settings, trace: 0.5 } };
  const groups = grouped([run, makeRun({ name: "Odd", config: { ...config, ...odd } })]);
  assert.deepEqual(inShort(groups), [["On their own", "Odd", "Learner, 500 steps"]]);
});

test("a grid of two settings is one group; a run in several sweeps is in the largest", () => {
  const grid = [0.1, 0.3].flatMap((alpha) => [0, 1].map((seed) => trained({ seed, settings: { alpha } })));
  assert.deepEqual(inShort(grouped(grid)), [[
    "Sweep of α and seed",
    "α\u00a00.3, seed\u00a01", "α\u00a00.3, seed\u00a00", "α\u00a00.1, seed\u00a01", "α\u00a00.1, seed\u00a00",
  ]]);
  const cross = [0.1, 0.3, 0.5].map((alpha) => trained({ settings: { alpha } }));
  const groups = grouped([...cross, trained({ steps: 900 })]);
  assert.deepEqual(groups.map(({ title, rows }) => [title, rows.length]), [["On its own", 1], ["Sweep of α", 3]]);
});

test("races are compared with what their learner practised and where they were", () => {
  const limping = { disturbances: OPTIONS.worlds[1].disturbances };
  const practice = [trained({ seed: 1 }, { id: "a" }), trained({ seed: 1, ...limping }, { id: "b" })];
  const lanes = (/** @type {string} */ id) => ({ lanes: [{ agent: "learner", training_id: id }, { agent: "greedy" }] });
  const groups = grouped([...practice, raced(lanes("a")), raced({ ...lanes("b"), ...limping })]);
  assert.deepEqual(inShort(groups)[0], ["Races by world", "Two limp legs", "Flat ground"]);
});

test("by race, a race stands with its branches and the trainings whose tables it used", () => {
  const training = trained({}, { id: "t1" });
  const lanes = [{ agent: "learner", training_id: "t1" }];
  const race = raced({ lanes }, { id: "r1", name: "Final", is_named: true });
  const branch = raced({ lanes, branch_from: { race_id: "r1", step: 3 } }, { id: "r2", name: "Final, from step 4" });
  const lone = trained({ steps: 20 }, { name: "Alone" });
  const groups = grouped([training, race, branch, lone], "race");
  assert.deepEqual(inShort(groups), [
    ["On its own", "Alone"], ["Final", "Final, from step 4", "The race", "Learner, 500 steps"],
  ]);
  assert.deepEqual(inShort(groupRuns({ runs: [training], by: "race", everyRun: [race, training] })),
    [["Final", "Learner, 500 steps"]], "though its race is not listed");
});

test("by day, and without groups; damaged runs are in all of them", () => {
  const now = Date.parse("2030-01-02T12:00:00");
  const [old, fresh] = ["2030-01-01T11:00:00", "2030-01-02T11:00:00"].map((created_at) => trained({}, { created_at }));
  const damaged = /** @type {any} */ ({ id: "bad", kind: null, name: null, created_at: null, damaged: "lost" });
  const runs = [fresh, old, damaged];
  const groups = (/** @type {string} */ by) => groupRuns({ runs, by, everyRun: [fresh, old], now });
  assert.deepEqual(groups("day").map(({ title }) => title), ["Today", "Yesterday", "At an unknown time"]);
  assert.deepEqual(groups("none").map(({ title }) => title), [""]);
  const ids = runs.map(({ id }) => id).toSorted();
  for (const by of ["sweep", "race", "day", "none"]) {
    assert.deepEqual(groups(by).flatMap(({ rows }) => rows.map(({ run }) => run.id)).toSorted(), ids);
  }
  assert.match(shortTime("2030-01-02T09:05:00", now), /^09:05$/);
  assert.doesNotMatch(shortTime("2029-11-24T09:05:00", now), /:/);
});

test("the choice of groups is in the link, and the browser keeps it", () => {
  applyEvent("snapshot", { runs: [trained(), trained({ seed: 1 })], stage: STAGE, scene: null, role: "operator" });
  assert.equal(grouping.value, "sweep");
  assert.deepEqual(runGroups.value.map(({ title }) => title), ["Seeds"]);
  setGrouping("none");
  change({ view: "runs" });
  assert.equal(write(), "#runs?group=none");
  assert.equal(listedRuns.value.length, 2);
  change({ grouping: null });
  assert.equal(grouping.value, "none");
  read({ search: "", hash: "#runs?group=day&columns=seed,nothing&selected=a,b&open=a" });
  assert.deepEqual([grouping.value, page.selected.value, page.opened.value], ["day", ["a", "b"], "a"]);
  assert.deepEqual(shownColumns.value, ["seed"]);
  toggleColumn("distance");
  assert.deepEqual(page.columns.value, ["seed", "distance"]);
  ["seed", "distance"].forEach(toggleColumn);
  assert.match(write(), /columns=&|columns&/, "no column is a choice, too");
  change({ columns: null });
  assert.deepEqual(shownColumns.value, [], "as it was kept");
  ["distance", "created"].forEach(toggleColumn);
  setGrouping("sweep");
  change({ view: "race" });
});

test("what came of a run is told beside its name", () => {
  const result = { distance_m: 0.25, greedy_distance_m: 0.5 };
  const run = trained({}, { result, greedy_distance_m: 0.5 });
  assert.equal(withResult("α 0.3", run), "α 0.3 → 0.25\u00a0m");
  assert.deepEqual([outcomeInWords(run), shareOf(run)], ["", "50 %"]);
  assert.equal(outcomeInWords(trained({}, { result: { distance_m: 0.01 } })), "marching on the spot");
  assert.equal(outcomeInWords(trained({}, { result: { distance_m: -0.2, fell_at_step: 11 } })),
    "walks backwards, fell at step 12");
  assert.equal(outcomeInWords(trained({}, { state: "running", progress: { done: 50, total: 200 } })), "25 %");
  assert.equal(outcomeInWords(trained({}, { state: "stopped", progress: { done: 50, total: 200 } })), "after 50 steps");
  const lane = (/** @type {string} */ agent, /** @type {number} */ rank, /** @type {number} */ finished_distance_m) =>
    ({ agent, steps: 50, clocks: { paper: { rank, finished_distance_m } } });
  const race = raced({}, { result: { lanes: [lane("learner", 2, 0.3), lane("greedy", 1, 0.33)] } });
  assert.equal(outcomeInWords(race), "Greedy 3\u00a0cm before Learner");
  assert.equal(withResult("Final", race), "Final → Greedy 0.33\u00a0m");
  assert.equal(COLUMNS.distance.value(race), "0.33\u00a0m");
});

test("names among others are short, and none twice", () => {
  applyEvent("snapshot", { runs: [], stage: STAGE, scene: null, role: "operator" });
  const [first, two, again] = [0.3, 0.5, 0.5].map((alpha) => trained({ settings: { alpha } }));
  assert.deepEqual(namesAmong([first, two, again]), ["α\u00a00.3", "α\u00a00.5", "α\u00a00.5 (2)"]);
  assert.deepEqual(namesAmong([first, raced()]), ["Learner, 500 steps", "Race: Learner, Greedy"]);
  assert.deepEqual(namesAmong([two, again]), ["Learner, 500 steps", "Learner, 500 steps (2)"]);
  assert.deepEqual(factsOf(trained({ disturbances: [{ kind: "slope", at_step: 9, degrees: 8 }] })).at(-1),
    "Slope 8° from step 10");
});

test("a sweep is compared by its values, all else as it was selected", () => {
  applyEvent("snapshot", { runs: [], stage: STAGE, scene: null, role: "operator" });
  const [high, low, middle] = [0.5, 0.1, 0.3].map((alpha) => trained({ settings: { alpha } }));
  assert.deepEqual(byValue([high, low, middle]), [low, middle, high]);
  assert.deepEqual(byValue([high, raced(), low]).length, 3);
  const [wave, tripod] = [trained({ gait: "wave" }), trained()];
  assert.deepEqual(byValue([wave, tripod]), [wave, tripod]);
  const both = trained({ steps: 20, settings: { alpha: 0.1 } });
  assert.deepEqual(byValue([high, both]), [high, both], "in two settings, which is no sweep");
  const damaged = /** @type {any} */ ({ id: "bad", kind: null, name: null, created_at: null, damaged: "lost" });
  assert.deepEqual(byValue([high, damaged, low]), [high, damaged, low]);
});
