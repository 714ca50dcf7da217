// Charts over a common axis: zoom, keys, what is read, what fits, and the numbers as CSV.
import assert from "node:assert/strict";
import { beforeEach, test } from "node:test";
import {
  csvOf, fileNameOf, indexAfter, intervalAt, movedTo, nearestIndex, pinned, scaledAround, tableOf, thinnedPath, valueAt,
  valuesIn, within, zoomFactorOf, zoomOf, zoomTo,
} from "../../static/js/chart.js";

/** @import { Line, Range } from "../../static/js/chart.js" */

/** @type {Range} */
const WHOLE = [0, 100];

/** @param {Partial<Line>} [more] @returns {Line} */
const line = (more) => ({ name: "Sarsa", color: "#000", xs: [0, 10, 20], ys: [0, 0.3, 0.2], ...more });

beforeEach(() => zoomTo("race", null, WHOLE));

test("charts over the same axis show the same part, others all of theirs", () => {
  zoomTo("race", [60, 20], WHOLE);
  assert.deepEqual(zoomOf("race"), [20, 60]);
  assert.equal(zoomOf("practice"), null);
});

test("a part that is not less than the whole axis is no zoom", () => {
  for (const range of /** @type {Range[]} */ ([[0, 100], [-50, 150]])) {
    zoomTo("race", range, WHOLE);
    assert.equal(zoomOf("race"), null, String(range));
  }
});

test("a part stays on the axis, and is never empty", () => {
  assert.deepEqual(within([-20, 20], WHOLE), [0, 40]);
  assert.deepEqual(within([90, 130], WHOLE), [60, 100]);
  const [from, to] = within([50, 50], WHOLE);
  assert.ok(to > from && from <= 50 && to >= 50);
});

test("zooming keeps the position under the crosshair where it is", () => {
  assert.deepEqual(scaledAround([0, 100], 25, 2), [12.5, 62.5]);
  assert.deepEqual(scaledAround([12.5, 62.5], 25, 0.5), [0, 100]);
});

test("two fingers keep what is under them", () => {
  const [from, to] = pinned([40, 60], [0.25, 0.75]);
  assert.deepEqual([from, to], [30, 70]);
  assert.deepEqual(pinned([60, 40], [0.75, 0.25]), [30, 70]);
});

test("a zoomed chart follows a crosshair that leaves it", () => {
  assert.deepEqual(movedTo([20, 40], 30), [20, 40]);
  assert.deepEqual(movedTo([20, 40], 50), [30, 50]);
  assert.deepEqual(movedTo([20, 40], 10), [10, 30]);
});

test("keys move between the first and the last value, and zoom", () => {
  assert.deepEqual(["ArrowLeft", "ArrowRight", "PageUp", "Home", "End"].map((key) => indexAfter(key, 0, 25)),
    [0, 1, 10, 0, 25]);
  assert.equal(indexAfter("a", 0, 25), null);
  assert.deepEqual(["+", "-", "0", "r"].map(zoomFactorOf), [2, 0.5, 0, null]);
});

test("the crosshair stops at the nearest value", () => {
  assert.deepEqual([-5, 4, 6, 14.9, 99].map((x) => nearestIndex([0, 10, 20], x)), [0, 0, 1, 1, 2]);
  assert.equal(nearestIndex([], 3), -1);
});

test("a line has values at its points, and between them only where it is a path", () => {
  assert.deepEqual([0, 10, 15].map((x) => valueAt(line(), x)), [0, 0.3, null]);
  assert.equal(valueAt(line({ at: (x) => x / 100 }), 15), 0.15);
  const banded = line({ low: [0, 0.2, null], high: [0.1, 0.4, null] });
  assert.deepEqual([10, 20, 15].map((x) => intervalAt(banded, x)), [[0.2, 0.4], null, null]);
});

test("values fit the part that is shown, with the lines that reach it", () => {
  const ended = line({ xs: [0, 5], ys: [0, 9] });
  const [low, high] = valuesIn([line(), ended], [12, 18], [0, 1]);
  assert.ok(low < 0.2 && low > 0.15 && high > 0.3 && high < 0.35, `${low} ${high}`);
  assert.deepEqual(valuesIn([ended], [12, 18], [0, 1]), [0, 1]);
  const [flat, top] = valuesIn([line({ ys: [0.2, 0.2, 0.2] })], [0, 20], [0, 1]);
  assert.ok(flat < 0.2 && top > 0.2);
});

test("a long line is drawn with fewer points, and keeps its peaks", () => {
  /** @type {[number, number][]} */
  const points = Array.from({ length: 10_000 }, (_, n) => [n / 100, n === 5003 ? -50 : n % 2]);
  const thin = thinnedPath(points, 100);
  assert.ok(thin.length <= 404, String(thin.length));
  assert.ok(thin.some(([, y]) => y === -50));
  assert.deepEqual([thin[0], thin.at(-1)], [points[0], points.at(-1)]);
  assert.ok(thin.every(([x], n) => n === 0 || x >= thin[n - 1][0]));
  assert.equal(thinnedPath(points.slice(0, 300), 100).length, 300);
});

test("the numbers have a column for each line, its interval and each named level, with units", () => {
  const banded = line({ name: "Dyna-Q", low: [0, 0.2, 0.1], high: [0, 0.4, 0.3] });
  const marks = [{ y: 0.5, name: "Greedy" }, { y: 0.45, text: "finish line" }, { x: 3, text: "time-out" }];
  const { columns, rows } = tableOf({
    lines: [line(), banded], marks, xs: [0, 10, 11], titles: { x: "Steps", y: "m" },
  });
  assert.deepEqual(columns,
    ["Steps", "Sarsa (m)", "Dyna-Q (m)", "95 % from (m)", "95 % to (m)", "Greedy (m)"]);
  // At 11 no line has a value.
  assert.deepEqual(rows, [[0, 0, 0, 0, 0, 0.5], [10, 0.3, 0.3, 0.2, 0.4, 0.5]]);
});

test("CSV is quoted where it must be, and no name is a formula", () => {
  const csv = csvOf({ columns: ["Race time, s", '=1+1"'], rows: [[0.5, null], [1, -0.25]] });
  assert.equal(csv, '"Race time, s","\'=1+1"""\r\n0.5,\r\n1,-0.25\r\n');
});

test("files are named after the chart", () => {
  assert.equal(fileNameOf("the learning curve"), "the-learning-curve");
  assert.equal(fileNameOf("Left-right, opposite"), "left-right-opposite");
  assert.equal(fileNameOf("α"), "chart");
});
