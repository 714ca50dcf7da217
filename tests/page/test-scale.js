// Positions on an axis, ticks, thinning, and points that make room for each other.
import assert from "node:assert/strict";
import { test } from "node:test";
import {
  fittingLabels, largest, percent, shareOf, swarm, thinned, ticks, valueColours,
} from "../../static/js/scale.js";

test("positions stay on the axis, also where it has no length", () => {
  assert.deepEqual([-1, 0, 1, 3, 9].map((value) => shareOf(value, 0, 4)), [0, 0, 0.25, 0.75, 1]);
  assert.equal(shareOf(5, 5, 5), 0);
  assert.equal(percent(1 / 3), "33.33%");
});

test("ticks are round and end at or before the end of the axis", () => {
  assert.deepEqual(ticks(2000, 4), [0, 500, 1000, 1500, 2000]);
  assert.deepEqual(ticks(0.9, 4).map((tick) => tick.toFixed(2)), ["0.00", "0.25", "0.50", "0.75"]);
  assert.deepEqual(ticks(0), [0]);
  for (const high of [0.013, 0.7, 3, 99, 1e6]) assert.ok(ticks(high).length >= 2 && ticks(high).length <= 6);
});

test("a thinned list keeps its order, its ends and at most so many", () => {
  const list = Array.from({ length: 1001 }, (_, n) => n);
  assert.deepEqual(thinned(list, 5), [0, 250, 500, 750, 1000]);
  assert.equal(thinned(list, 2000), list);
});

test("the largest value of a list that is longer than a call's arguments", () => {
  assert.equal(largest(new Array(500_000).fill(0.5)), 0.5);
  assert.equal(largest([-3, -2], -Infinity), -2);
  assert.equal(largest([], 1), 1);
});

test("dots at one place lie alternately on both sides", () => {
  assert.deepEqual(swarm([0.5, 0.5, 0.5, 0.5, 0.9]).map((row) => row + 0), [0, 1, -1, 2, 0]);
});

test("values are dark to light, with text that can be read on them", () => {
  assert.deepEqual(valueColours(0, 0, 1), { background: "rgb(68 1 84)", color: "#fff" });
  assert.deepEqual(valueColours(7, 0, 1), { background: "rgb(253 231 37)", color: "#000" });
  assert.equal(valueColours(3, 3, 3).background, "rgb(68 1 84)");
});

test("the text of every value has the contrast that WCAG asks for", () => {
  for (let value = 0; value <= 1; value += 0.001) {
    const { background, color } = valueColours(value, 0, 1);
    const [r, g, b] = (background.match(/\d+/g) ?? []).map(Number);
    const luminance = 0.2126 * linear(r) + 0.7152 * linear(g) + 0.0722 * linear(b);
    const contrast = color === "#fff" ? 1.05 / (luminance + 0.05) : (luminance + 0.05) / 0.05;
    assert.ok(contrast >= 4.5, `${contrast} on ${background}`);
  }
});

/** A channel of sRGB, 0 to 255, as WCAG makes it linear. @param {number} channel */
const linear = (channel) => (channel <= 10 ? channel / 255 / 12.92 : ((channel / 255 + 0.055) / 1.055) ** 2.4);

test("ticks of a part of an axis are round too", () => {
  assert.deepEqual(ticks(55, 4, 27), [30, 40, 50]);
  assert.deepEqual(ticks(0.2, 4, -0.2).map((tick) => Number(tick.toFixed(2))), [-0.2, -0.1, 0, 0.1, 0.2]);
});

test("labels of an axis stay between its ends, and give way to those before them in the list", () => {
  const label = (/** @type {number} */ at, size = 40) => ({ at, size });
  const fitting = (/** @type {ReturnType<typeof label>[]} */ labels, width = 200) =>
    fittingLabels(labels, 100, width, 6).map(({ at, left }) => [at, left]);
  assert.deepEqual(fitting([label(100), label(0), label(50)]), [[100, 160], [0, 0], [50, 80]]);
  // The last label is wide, and so is the one before it.
  assert.deepEqual(fitting([label(100, 90), label(50), label(0)]), [[100, 110], [0, 0]]);
  assert.deepEqual(fitting([label(30), label(29), label(60)]), [[30, 40], [60, 100]]);
  assert.deepEqual(fitting([label(0)], 20), []);
});
