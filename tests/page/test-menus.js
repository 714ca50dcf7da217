// Keys in a menu: to which item each moves.
import assert from "node:assert/strict";
import { test } from "node:test";
import { nextItem } from "../../static/js/components/menu.js";

const TITLES = ["Copy a link", "Present", "Lessons", " Panel"];

test("arrows move round the ends, Home and End to them", () => {
  const moved = (/** @type {string} */ key) => [-1, 0, 3].map((at) => nextItem(TITLES, key, at));
  assert.deepEqual(moved("ArrowDown"), [0, 1, 0]);
  assert.deepEqual(moved("ArrowUp"), [3, 3, 2]);
  assert.deepEqual([moved("Home"), moved("End")], [[0, 0, 0], [3, 3, 3]]);
});

test("a letter moves to the next item that begins with it, and stays where none does", () => {
  assert.deepEqual([nextItem(TITLES, "p", 0), nextItem(TITLES, "P", 1), nextItem(TITLES, "p", 3)], [1, 3, 1]);
  assert.equal(nextItem(TITLES, "x", 2), 2);
  assert.deepEqual([" ", "Enter", "Tab", "Escape"].map((key) => nextItem(TITLES, key, 2)), [null, null, null, null]);
});
