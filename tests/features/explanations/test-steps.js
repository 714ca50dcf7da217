// One step at a time: which one is looked at, how answers are asked for, and how the table is read.
import assert from "node:assert/strict";
import { beforeEach, mock, test } from "node:test";
import {
  cellInWords, cellKind, chosenLane, chosenMoment, chooseStep, columnOf, comparedNumber, followMoment,
  followStage, lastStep, moment, moveOf, ruleNumber, stateCells, stateIndex, tableMoment, triedMoves,
  valueRange,
} from "../../../static/features/explanations/steps.js";
import { applyEvent, connection, options, scene } from "../../../static/js/store.js";
import { makeRun, OPTIONS } from "../../page/options.js";

/** @import { StateTable } from "../../../static/js/types.js" */

const STAGE = { run_id: null, next_run_id: null, playing: true, speed: 1, clock: "paper" };

beforeEach(() => {
  options.value = OPTIONS;
  chosenMoment.value = null;
  chosenLane.value = null;
});

/** Put a run on stage. @param {ReturnType<typeof makeRun>} run @param {object[]} lanes */
function show(run, lanes) {
  applyEvent("snapshot", { runs: [run], stage: { ...STAGE, run_id: run.id }, scene: null });
  scene.value = /** @type {any} */ ({ run_id: run.id, kind: run.kind, phase: "practice", lanes, action_values: null });
}

test("the step of the stage is looked at until another is chosen", () => {
  const run = makeRun({ progress: { done: 90, total: 100 } });
  show(run, [{ step: 31, steps: 100 }]);
  assert.deepEqual(moment.value, { run_id: run.id, lane: 0, step: 31 });
  assert.deepEqual(tableMoment.value, { training_id: run.id, step: 30 });
  assert.equal(lastStep.value, 90);
  chooseStep(95);
  assert.equal(moment.value?.step, 90);
  chooseStep(-3);
  assert.equal(moment.value?.step, 1);
  show(run, [{ step: 40, steps: 100 }]);
  assert.equal(moment.value?.step, 1);
  followStage();
  assert.equal(moment.value?.step, 40);
});

test("a training that has not begun has no table to ask for", () => {
  const run = makeRun({ state: "queued", progress: { done: 0, total: 100 } });
  show(run, [{ step: 0, steps: 100 }]);
  assert.equal(tableMoment.value, null);
  applyEvent("run", { ...run, state: "running", progress: { done: 3, total: 100 } });
  assert.deepEqual(tableMoment.value, { training_id: run.id, step: 0 });
});

test("another run on stage is followed from its own step", () => {
  show(makeRun({}), [{ step: 7, steps: 100 }]);
  chooseStep(3);
  const next = makeRun({ progress: { done: 20, total: 100 } });
  show(next, [{ step: 12, steps: 100 }]);
  assert.deepEqual(moment.value, { run_id: next.id, lane: 0, step: 12 });
});

test("a lane of a race shows the table of its training, if it has one", () => {
  const race = makeRun({
    kind: "race", config: { steps: 50, lanes: [{ agent: "learner", training_id: "t1" }, { agent: "greedy" }] },
  });
  show(race, [{ step: 5, steps: 50 }, { step: 9, steps: 50 }]);
  assert.deepEqual(tableMoment.value, { training_id: "t1", step: null });
  chosenLane.value = 1;
  assert.deepEqual([moment.value?.step, tableMoment.value], [9, null]);
  assert.equal(lastStep.value, 50);
});

// ---- asking

const settled = () => new Promise((resolve) => {
  setImmediate(resolve);
});

test("the table of a lane's training is asked for once, however far its race is", async () => {
  mock.timers.enable({ apis: ["setTimeout"] });
  /** @type {string[]} */
  const requests = [];
  globalThis.fetch = (address) => {
    requests.push(String(address));
    return Promise.resolve(new Response("{}"));
  };
  const lanes = [{ agent: "learner", training_id: "t1" }];
  const race = makeRun({ kind: "race", state: "running", config: { steps: 50, lanes } });
  show(race, [{ step: 0, steps: 50 }]);
  connection.value = "live";
  const stop = followMoment();
  for (const done of [1, 2]) {
    applyEvent("run", { ...race, progress: { done, total: 50 } });
    for (let turn = 0; turn < 3; turn += 1) await settled();
    mock.timers.tick(1000);
  }
  assert.equal(requests.length, 1);
  stop();
  mock.timers.reset();
});

// ---- the table

/** Two pairs on three cells: nine states of six moves. @type {StateTable} */
const TABLE = {
  pairs: [[1, 4], [2, 5]], cells_m: [[0, 0], [-1, 1], [1, 1]], cell_names: ["home", "front left", "front right"],
  step: 3, states: 9, first: 4,
  values: [[0.01, null, 0, -0.002, null, 0.5], [0, null, 0, 0, 0, null]],
  visits: [[2, null, 1, 1, null, 0], [0, null, 0, 0, 0, null]],
  best: [[0, 0], [0, 0]],
  landings: null,
};

test("states and columns are numbers of their cells", () => {
  assert.equal(stateIndex([1, 2], 3), 5);
  assert.deepEqual(stateCells(5, TABLE), [1, 2]);
  assert.deepEqual([columnOf([1, 2], TABLE), moveOf(5, TABLE)], [5, [1, 2]]);
});

test("what was never tried is not what is worth nothing", () => {
  assert.deepEqual([0, 1, 2, 5].map((column) => cellKind(TABLE, 0, column)), ["tried", "stays", "tried", "untried"]);
  assert.deepEqual(valueRange(TABLE), { low: -0.002, high: 0.01 });
  assert.deepEqual(triedMoves(TABLE), { tried: 3, all: 8 });
  const read = (/** @type {number} */ row, /** @type {number} */ column) => {
    const { state, move, worth, about } = cellInWords(TABLE, row, column);
    return [state, move, worth, about].join(" | ");
  };
  const where = "legs 1+4 front left, legs 2+5 front left";
  assert.equal(read(0, 0), `${where} | legs 1+4 to home | 10.0\u00a0mm, tried 2 times | the best move here`);
  assert.equal(
    read(0, 2), `${where} | legs 1+4 to front right | 0.0\u00a0mm, tried once | best here: legs 1+4 to home`);
  assert.match(read(0, 5), /never tried; taken for 500\.0\u00a0mm \| best here/);
  assert.match(read(1, 0), /never tried \| nothing tried here/);
  assert.match(read(0, 1), /no move: they stand there/);
});

test("an empty table has no range", () => {
  assert.deepEqual(valueRange({ ...TABLE, visits: TABLE.visits.map((row) => row.map(() => 0)) }), { low: 0, high: 0 });
});

// ---- numbers

test("numbers of a rule are short, and compared ones as long as they differ", () => {
  const numbers = [0.1, 3, -2.5, 0.012345678, 1.5e-9].map(ruleNumber);
  assert.deepEqual(numbers, ["0.1", "3", "−2.5", "0.0123457", "1.5 · 10⁻⁹"]);
  assert.equal(comparedNumber(0.0123, 0.0456), "0.012300\u202fm");
  assert.equal(comparedNumber(0.012300004, 0.0123), "0.012300004\u202fm");
});
