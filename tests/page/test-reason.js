// Why the leader is ahead, from recorded figures only.
import assert from "node:assert/strict";
import { test } from "node:test";
import { reasonOf, stepsUntil } from "../../static/js/reason.js";

/** Two steps of 1 s and 10 mm each, without thinking. */
const QUICK = /** @type {any} */ ({ points: [[0, 0], [1, 0.01], [2, 0.02]], thinking: [], futures: [0, 0] });
/** Two steps of 30 mm, of which each is thought of for as long as it takes. */
const SLOW = /** @type {any} */ ({
  points: [[0, 0], [1, 0], [2, 0.03], [3, 0.03], [4, 0.06]], thinking: [[0, 1], [2, 3]], futures: [12, 12],
});
const ROWS = [{ lane: 1, title: "Slow" }, { lane: 0, title: "Quick" }, { lane: 2, title: "Third" }];

test("steps count once they have ended, with the distance that they made", () => {
  assert.deepEqual(stepsUntil(QUICK, 1.9), { steps: 1, distance_m: 0.01 });
  assert.deepEqual(stepsUntil(SLOW, 1.5), { steps: 0, distance_m: 0 });
  assert.deepEqual(stepsUntil(SLOW, 3.5), { steps: 1, distance_m: 0.03 });
  assert.deepEqual(stepsUntil(SLOW, 4), { steps: 2, distance_m: 0.06 });
});

test("the first two are told by steps and millimetres a step", () => {
  const told = ["Slow: 0.03\u00a0m, 1 step of 30.0\u00a0mm", "Quick: 0.02\u00a0m, 2 steps of 10.0\u00a0mm"];
  assert.deepEqual(reasonOf(ROWS, [QUICK, SLOW], 2), told);
  assert.deepEqual(reasonOf(ROWS.slice(1, 2), [QUICK], 2), told.slice(1));
});

test("nothing is told without figures", () => {
  assert.deepEqual(reasonOf(ROWS, [QUICK, SLOW], 0.5), []);
  assert.deepEqual(reasonOf(ROWS, [], 2), []);
  assert.equal(stepsUntil({ ...QUICK, points: [[0, 0], [2, 0.02]] }, 2), null);
});
