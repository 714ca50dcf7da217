// Settings as the server declares them, and typed numbers against their limits.
import assert from "node:assert/strict";
import { beforeEach, test } from "node:test";
import { limitsOf, mistakeIn, parseNumbers, rangeOf, settingOf } from "../../static/js/limits.js";
import { options } from "../../static/js/store.js";
import { OPTIONS } from "./options.js";

beforeEach(() => (options.value = OPTIONS));

/**
 * @param {number | null} minimum
 * @param {number | null} maximum
 */
const limits = (minimum, maximum, excludesMinimum = false, excludesMaximum = false) =>
  ({ minimum, maximum, excludes_minimum: excludesMinimum, excludes_maximum: excludesMaximum });

test("limits are the server's, and none before it has answered", () => {
  assert.equal(rangeOf(limitsOf("alpha")), "over 0 and at most 1");
  assert.deepEqual(limitsOf("seeds"), limits(1, null));
  assert.deepEqual(limitsOf("unknown"), limits(null, null));
  options.value = null;
  assert.deepEqual(limitsOf("alpha"), limits(null, null));
});

test("declarations name settings and say which are whole numbers", () => {
  assert.equal(settingOf("alpha").title, "Learning rate");
  assert.ok(settingOf("steps").is_whole);
});

test("ranges in words", () => {
  assert.equal(rangeOf(limits(1, 10_000)), "from 1 to 10\u202f000");
  assert.equal(rangeOf(limits(0, 1, true, false)), "over 0 and at most 1");
  assert.equal(rangeOf(limits(0, 1, false, true)), "from 0 to under 1");
  assert.equal(rangeOf(limits(0.005, null)), "at least 0.005");
  assert.equal(rangeOf(limits(0, null, true)), "over 0");
  assert.equal(rangeOf(limits(null, 8)), "at most 8");
  assert.equal(rangeOf(limits(null, 8, false, true)), "under 8");
  assert.equal(rangeOf(limits(null, null)), "");
});

test("a number is refused with the reason", () => {
  assert.equal(mistakeIn(0.5, limits(0, 1), false), null);
  assert.equal(mistakeIn(1, limits(0, 1), true), null);
  assert.equal(mistakeIn(7, limits(0, 1), false), "Must be from 0 to 1");
  assert.equal(mistakeIn(NaN, limits(0, null), false), "Enter a number, at least 0");
  assert.equal(mistakeIn(1.5, limits(1, 10), true), "Enter a whole number, from 1 to 10");
  assert.equal(mistakeIn(NaN, limits(null, null), false), "Enter a number");
});

test("a limit that is not valid itself is refused", () => {
  const alpha = limits(0, 1, true, false);
  assert.equal(mistakeIn(0, alpha, false), "Must be over 0 and at most 1");
  assert.equal(mistakeIn(1, alpha, false), null);
  assert.equal(mistakeIn(1, limits(0, 1, false, true), false), "Must be from 0 to under 1");
});

test("lists of numbers are separated by commas, each valid and there once", () => {
  assert.deepEqual(parseNumbers("0.1, 0.3,0.6", limits(0, 1), false), { value: [0.1, 0.3, 0.6] });
  assert.match(parseNumbers("0.1, oops", limits(0, 1), false).mistake ?? "", /separated by commas/);
  assert.match(parseNumbers("0.1,,0.2", limits(0, 1), false).mistake ?? "", /separated by commas/);
  assert.match(parseNumbers("1.5", limits(1, 10), true).mistake ?? "", /whole/);
  assert.match(parseNumbers("0.5, 2", limits(0, 1), false).mistake ?? "", /from 0 to 1/);
  assert.match(parseNumbers("1, 1.0", limits(0, 1), false).mistake ?? "", /once/);
});
