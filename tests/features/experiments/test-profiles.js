// Performance profiles of two settings as lines of a chart.
import assert from "node:assert/strict";
import { test } from "node:test";
import { comparable, firstPair, profileChart, profileLine } from "../../../static/features/experiments/profiles.js";

/** @type {(key: string, points_m: number[], more?: object) => any} */
const setting = (key, points_m, more = {}) =>
  ({ key, role: "learner", agent: "q-learning", total: { points_m }, is_deterministic: false, ...more });
/** @type {any} */
const SUMMARY = {
  settings: [],
  share_limits: [{ seeds: 4, low: [0, 0.05, 0.15, 0.3, 0.51], high: [0.49, 0.7, 0.85, 0.95, 1] }],
};
const LOOK = { name: "Q", from: 0, to: 1, isSecond: false, color: "red" };

test("a profile falls by a step at each seed's distance, and its band with it", () => {
  const line = profileLine(setting("a", [0.3, 0.1, 0.3, 0.2]), SUMMARY, LOOK);
  assert.deepEqual(line.xs, [0, 0.1, 0.1, 0.2, 0.2, 0.3, 0.3, 1]);
  assert.deepEqual(line.ys, [1, 1, 0.75, 0.75, 0.5, 0.5, 0, 0]);
  assert.deepEqual(line.low, [0.51, 0.51, 0.3, 0.3, 0.15, 0.15, 0, 0]);
  assert.deepEqual(line.high, [1, 1, 0.95, 0.95, 0.85, 0.85, 0.49, 0.49]);
  assert.equal(line.at?.(0.2), 0.75);
  assert.equal(line.at?.(0.31), 0);
});

test("what has no spread has no band: one walk for all seeds, or a summary of an earlier version", () => {
  const greedy = setting("greedy", [0.5], { is_deterministic: true });
  assert.equal(profileLine(greedy, SUMMARY, LOOK).low, undefined);
  assert.equal(profileLine(setting("a", [0.1, 0.2]), /** @type {any} */ ({ settings: [] }), LOOK).low, undefined);
});

test("two lines of one agent differ in their dashes and colours", () => {
  const { lines, x, y } = profileChart([setting("a", [-0.1, 0.2]), setting("b", [0.4])], ["A", "B"], SUMMARY);
  assert.notDeepEqual(lines[0].dash, lines[1].dash);
  assert.notEqual(lines[0].color, lines[1].color);
  assert.equal(x.min, -0.1);
  assert.equal(x.unit, "distance in 50 steps, m");
  assert.equal(y.max, 1);
});

test("at first two learners are compared; a single one with what it is measured against", () => {
  const greedy = setting("greedy", [0.5], { role: "reference" });
  assert.deepEqual(firstPair([greedy, setting("a", [1]), setting("b", [1])]), ["a", "b"]);
  assert.deepEqual(firstPair([greedy, setting("a", [1])]), ["a", "greedy"]);
  const summary = /** @type {any} */ ({ settings: [greedy, { ...setting("c", []), total: null }] });
  assert.deepEqual(comparable(summary), [greedy]);
});
