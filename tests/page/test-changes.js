// Changes of live settings while a training runs: which values hold, and what is said of them.
import assert from "node:assert/strict";
import { beforeEach, test } from "node:test";
import { copySettings, secondaryActions } from "../../static/js/actions.js";
import { changesInWords, configAtEnd, curve, presentRates, rateChanges } from "../../static/js/training.js";
import { form, setFields } from "../../static/js/form.js";
import { page } from "../../static/js/page-state.js";
import { applyEvent, options, rates, runs, scene } from "../../static/js/store.js";
import { makeRun, OPTIONS } from "./options.js";

const STAGE = { run_id: null, next_run_id: null, playing: true, ended: false, speed: 1, clock: "paper" };
const CHANGES = [{ step: 136, settings: { alpha: 0.5 } }, { step: 200, settings: { epsilon: 0.25 }, pace: 8 }];

const makeChanged = (changes = {}) => makeRun({ changes: CHANGES, progress: { done: 500, total: 500 }, ...changes });

beforeEach(() => {
  options.value = OPTIONS;
  page.form.value = new URLSearchParams();
  applyEvent("snapshot", { runs: [], stage: STAGE, scene: null });
});

test("a page that opens later knows the changes, and events supersede them", () => {
  const run = makeChanged({ state: "running" });
  applyEvent("snapshot", { runs: [run], stage: STAGE, scene: null });
  assert.deepEqual(presentRates(run), { alpha: 0.5, epsilon: 0.25, pace: 8 });
  applyEvent("rates", { run_id: run.id, step: 300, settings: { alpha: 0.7 } });
  assert.deepEqual(presentRates(run), { alpha: 0.7, epsilon: 0.25, pace: 8 });
  // The snapshot after a lost connection is newer than the events before it.
  const changes = [{ step: 350, settings: { alpha: 0.2 } }];
  applyEvent("snapshot", { runs: [{ ...run, changes }], stage: STAGE, scene: null });
  assert.deepEqual(presentRates(runs.value.get(run.id) ?? run), { alpha: 0.2 });
  assert.deepEqual(rates.value, {});
});

test("the changes of a run are told with their steps, without the pace", () => {
  const run = makeChanged();
  assert.deepEqual(changesInWords("learner", rateChanges(run)),
    ["α\u00a00.5 from step 136", "ε\u00a00.25 from step 200"]);
  const often = makeRun({ changes: [...CHANGES, { step: 400, settings: { alpha: 0.1 } }] });
  assert.equal(changesInWords("learner", rateChanges(often))[0], "α\u00a00.1 from step 400 (2 changes)");
});

test("a slider that is dragged makes one change", () => {
  const run = makeRun({ changes: [130, 132, 136].map((step) => ({ step, settings: { alpha: step / 1000 } })) });
  assert.deepEqual(rateChanges(run), [{ name: "alpha", value: 0.136, step: 136 }]);
});

test("the curve marks changes at their steps of all practice, once they are on stage", () => {
  const first = makeChanged();
  const second = makeRun({
    state: "running", progress: { done: 300, total: 500 },
    changes: [{ step: 10, settings: { gamma: 0.5 } }, { step: 250, settings: { gamma: 0.6 } }],
    config: { ...first.config, continue_from: first.id },
  });
  applyEvent("snapshot", { runs: [first, second], stage: { ...STAGE, run_id: second.id }, scene: null });
  const lanes = [{ step: 100, steps_made: 99 }];
  scene.value = /** @type {any} */ ({ run_id: second.id, kind: "training", phase: "practice", lanes });
  assert.deepEqual(curve.value?.changes.map(({ name, step }) => [name, step]),
    [["alpha", 136], ["epsilon", 200], ["gamma", 510]]);
});

test("the settings of a run are copied as they hold at its end", () => {
  const run = makeChanged();
  const { settings: { alpha, gamma, epsilon_start, epsilon_end }, pace } = configAtEnd(run);
  assert.deepEqual([alpha, gamma, epsilon_start, epsilon_end, pace], [0.5, 0.9, 0.25, 0.25, 8]);
  copySettings(run);
  assert.deepEqual([form.value.alpha, form.value.epsilon_end, form.value.pace], [0.5, 0.25, 8]);

  page.form.value = new URLSearchParams();
  applyEvent("run", run);
  copySettings(makeRun({ kind: "race", config: { steps: 50, lanes: [{ agent: "learner", training_id: run.id }] } }));
  assert.equal(form.value.alpha, 0.5);
});

test("the settings of lanes are copied", () => {
  const lanes = [
    { agent: "planner", settings: { depth: 2 } },
    { agent: "learner", training_id: null, keep_learning: true, settings: { gamma: 0.5 } },
  ];
  copySettings(makeRun({ kind: "race", config: { steps: 50, lanes } }));
  assert.deepEqual(form.value.lanes, ["planner", "learner"]);
  const { gamma, "planner.depth": depth, "learner.keep_learning": keepLearning } = form.value;
  assert.deepEqual([depth, keepLearning, gamma], [2, true, 0.5]);
});

test("how the lanes of a race read their state is copied", () => {
  const lanes = [
    { agent: "greedy", observation: "commanded" },
    { agent: "tracer", training_id: null, keep_learning: true, observation: "commanded" },
  ];
  copySettings(makeRun({ kind: "race", config: { steps: 50, lanes } }));
  assert.deepEqual([form.value["greedy.observation"], form.value.observation], ["commanded", "commanded"]);
});

test("what a search knows by default is not copied as if it had been asked for", () => {
  const knownAfterCopy = (/** @type {object} */ lane) => {
    const lanes = [{ agent: "greedy", ...lane }];
    copySettings(makeRun({ kind: "race", config: { steps: 50, lanes } }));
    return form.value["greedy.plans_with"];
  };
  assert.equal(knownAfterCopy({ plans_with: "nominal", plans_with_by_default: false }), "nominal");
  assert.equal(knownAfterCopy({ plans_with: "world", plans_with_by_default: true }), null);
});

test("a race without practice is offered if all of its learners keep learning", () => {
  const labels = () => secondaryActions.value.map(({ label }) => label);
  setFields({ lanes: ["tracer", "learner"] });
  assert.ok(!labels().includes("Race without practice"));
  setFields({ "learner.keep_learning": true });
  assert.ok(labels().includes("Race without practice"));
});

test("what happens by a run's config is copied, and replaces what the form had", () => {
  const { config } = makeRun({});
  const disturbances = [{ kind: "limp", at_step: 25, legs: [1, 4] }, { kind: "slope", at_step: 0, degrees: 8 }];
  page.form.value = new URLSearchParams("world=limp-pair&disturb=limp:legs%3D2");
  copySettings(makeRun({ config: { ...config, disturbances } }));
  assert.deepEqual([form.value.world, form.value.disturb], ["flat", ["limp:legs=1,4:at=25", "slope:degrees=8"]]);
  copySettings(makeRun({}));
  assert.deepEqual(form.value.disturb, []);
});

test("what happened while it ran is no setting", () => {
  const disturbance = { kind: "limp", at_step: 5, legs: [1] };
  const run = makeRun({ changes: [{ step: 5, disturbance }, { step: 6, settings: { alpha: 0.5 } }] });
  assert.deepEqual(rateChanges(run).map(({ name }) => name), ["alpha"]);
  assert.ok(!("disturbance" in configAtEnd(run)));
});
