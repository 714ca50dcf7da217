// The training in view: its learning curve, and the learner's next move.
import assert from "node:assert/strict";
import { beforeEach, test } from "node:test";
import { applyEvent, options, scene } from "../../static/js/store.js";
import { bestMove, curve, cellName, practisedSteps } from "../../static/js/training.js";
import { makeRun, OPTIONS } from "./options.js";

const STAGE = { run_id: null, next_run_id: null, playing: true, speed: 1, clock: "paper" };

beforeEach(() => (options.value = OPTIONS));

test("the learning curve joins the trainings that continue each other, up to the step on stage", () => {
  const first = makeRun({ progress: { done: 100, total: 100 }, greedy_distance_m: 0.5 });
  const second = makeRun({
    state: "running", progress: { done: 40, total: 100 },
    config: { ...first.config, steps: 100, continue_from: first.id },
  });
  applyEvent("snapshot", { runs: [first, second], stage: { ...STAGE, run_id: second.id }, scene: null });
  const evaluate = (/** @type {string} */ run_id, /** @type {number} */ step) =>
    applyEvent("evaluation", { run_id, step, distance_m: step / 1000, epsilon: 1 });
  evaluate(first.id, 50);
  evaluate(second.id, 20);
  evaluate(second.id, 40);
  const lanes = [{ step: 30, steps_made: 29 }];
  scene.value = /** @type {any} */ ({ run_id: second.id, kind: "training", phase: "practice", lanes });
  assert.deepEqual(curve.value?.points.map(({ step }) => step), [0, 50, 120]);
  assert.deepEqual([curve.value?.blocks, curve.value?.to, curve.value?.greedy_m], [[100], 200, 0.5]);
  assert.equal(practisedSteps(second), 140);
});

test("the best known distance is that of the world as it is now, and in the end that of the result", () => {
  const running = makeRun({ state: "running" });
  const show = (/** @type {object} */ run) =>
    applyEvent("snapshot", { runs: [run], stage: { ...STAGE, run_id: running.id }, scene: null });
  const announce = (/** @type {number | null} */ best_known_m) =>
    applyEvent("reference", { run_id: running.id, greedy_distance_m: 0.5, best_known_m });
  show(running);
  assert.equal(curve.value?.best_known_m, null);
  announce(0.51);
  assert.equal(curve.value?.best_known_m, 0.51);
  announce(null);
  assert.equal(curve.value?.best_known_m, null);
  show({ ...running, state: "finished", result: { distance_m: 0.4, greedy_distance_m: 0.5, best_known_m: 0.53 } });
  assert.equal(curve.value?.best_known_m, 0.53);
});

test("the best move is the one of the highest value", () => {
  assert.deepEqual(bestMove({ values_m: [[null, 0.1], [-0.2, 0.3]] }), { pair: 1, cell: 1, value: 0.3 });
  assert.equal(bestMove({ values_m: [[null, null]] }).pair, -1);
});

test("places are named on a small grid and measured on a fine one", () => {
  const named = { cell_names: ["home", "front left"], cells_m: /** @type {[number, number][]} */ ([[0, 0], [-1, 1]]) };
  assert.equal(cellName(named, 1), "front left");
  const fine = {
    cell_names: ["home", "a", "b", "c", "d", "e"],
    cells_m: /** @type {[number, number][]} */ ([[0, 0], [-0.02, 0.01], [0.02, 0], [0, -0.01], [0, 0], [0, 0]]),
  };
  assert.deepEqual([0, 1, 2, 3].map((cell) => cellName(fine, cell, " mm")),
    ["home", "20 mm left, 10 mm front", "20 mm right", "10 mm back"]);
});
