// Numbers, times and lists as people read them.
import assert from "node:assert/strict";
import { test } from "node:test";
import * as format from "../../static/js/format.js";

const MINUTE_MS = 60_000;

test("metres are rounded to the centimetre, with a true minus and a space that does not break", () => {
  assert.equal(format.metres(0.30000001), "0.30\u00a0m");
  assert.equal(format.metres(-0.126), "\u22120.13\u00a0m");
  assert.equal(format.metres(-0.001), "0.00\u00a0m");
  assert.equal(format.metres(null), "–");
  assert.equal(format.metres(NaN), "–");
});

test("steps and values are rounded to a tenth of a millimetre, and never less than nothing by rounding", () => {
  assert.deepEqual([0.01515, -0.0123, -0.00004, 0].map(format.tenths), ["15.2", "\u221212.3", "0.0", "0.0"]);
  assert.equal(format.inMillimetres(0.0244), "24.4\u00a0mm");
});

test("digits are grouped by a thin space from 10 000 on", () => {
  assert.equal(format.whole(9999), "9999");
  assert.equal(format.whole(10_000), "10\u202f000");
  assert.equal(format.whole(1_234_567.4), "1\u202f234\u202f567");
  assert.equal(format.whole(undefined), "–");
});

test("numbers in a text are grouped alike", () => {
  assert.equal(format.withGroupedDigits("after 1,000 and 12,500 steps, not 1,00 or 0.1,000"),
    "after 1000 and 12\u202f500 steps, not 1,00 or 0.1,000");
});

test("a count has its noun in singular or plural", () => {
  assert.equal(format.count(1, "step"), "1 step");
  assert.equal(format.count(0, "step"), "0 steps");
  assert.equal(format.count(12_500, "trial"), "12\u202f500 trials");
});

test("decisions are told in milliseconds up to a second", () => {
  assert.deepEqual([0.0004, 0.0124, 0.9996, 1.44].map(format.decision), ["<1 ms", "12 ms", "1000 ms", "1.4 s"]);
  assert.equal(format.decision(null), "–");
});

test("durations use the largest unit that says enough", () => {
  assert.deepEqual([0.2, 4, 89, 90, 3900, 5400].map(format.duration),
    ["under 1 s", "4 s", "89 s", "2 min", "65 min", "1 h 30 min"]);
});

test("positions on the time bar have two digits for seconds", () => {
  assert.deepEqual([-1, 5, 65.9].map(format.clockTime), ["0:00", "0:05", "1:05"]);
  // The scoreboard sums up what the server rounds to the millisecond for the time bar.
  assert.equal(format.clockTime(15.9999999), format.clockTime(16));
});

test("shares, factors and millimetres", () => {
  assert.equal(format.percentage(0.416), "42 %");
  assert.deepEqual([2, 0.25, 7.77].map(format.times), ["×2", "×0.25", "×7.8"]);
  assert.deepEqual([0.0524, -0.003].map(format.millimetres), ["52", "\u22123"]);
});

test("moments are relative for an hour", () => {
  const now = Date.parse("2030-05-05T12:00:00Z");
  assert.equal(format.ago(new Date(now - 59_000).toISOString(), now), "just now");
  assert.equal(format.ago(new Date(now - 2.5 * MINUTE_MS).toISOString(), now), "2 min ago");
  assert.doesNotMatch(format.ago(new Date(now - 61 * MINUTE_MS).toISOString(), now), /ago|just/);
});

test("lists are joined as in a sentence", () => {
  assert.deepEqual([[], ["a"], ["a", "b"], ["a", "b", "c"]].map(format.listed), ["", "a", "a and b", "a, b and c"]);
  assert.equal(format.sentence("feet measured"), "Feet measured");
  assert.equal(format.sentence("α 0.5"), "α 0.5", "a capital alpha is another symbol");
});

test("a room's code is in two groups", () => {
  assert.equal(format.codeInGroups("ABCDEFGH"), "ABCD\u00a0EFGH");
});
