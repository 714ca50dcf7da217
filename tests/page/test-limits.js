// Typed numbers against the server's limits.
import assert from "node:assert/strict";
import { beforeEach, test } from "node:test";
import { limitsOf, mistakeIn, parseNumbers, rangeOf } from "../../static/js/limits.js";
import { options } from "../../static/js/store.js";
import { OPTIONS } from "./options.js";

beforeEach(() => (options.value = OPTIONS));

test("limits are the server's, and none before it has answered", () => {
  assert.deepEqual(limitsOf("alpha"), [0, 1]);
  assert.deepEqual(limitsOf("unknown"), [null, null]);
  options.value = null;
  assert.deepEqual(limitsOf("alpha"), [null, null]);
});

test("ranges in words", () => {
  assert.equal(rangeOf([1, 10_000]), "from 1 to 10\u202f000");
  assert.equal(rangeOf([0.005, null]), "at least 0.005");
  assert.equal(rangeOf([null, 8]), "at most 8");
  assert.equal(rangeOf([null, null]), "");
});

test("a number is refused with the reason", () => {
  assert.equal(mistakeIn(0.5, [0, 1], false), null);
  assert.equal(mistakeIn(1, [0, 1], true), null);
  assert.equal(mistakeIn(7, [0, 1], false), "Must be from 0 to 1");
  assert.equal(mistakeIn(NaN, [0, null], false), "Enter a number, at least 0");
  assert.equal(mistakeIn(1.5, [1, 10], true), "Enter a whole number, from 1 to 10");
  assert.equal(mistakeIn(NaN, [null, null], false), "Enter a number");
});

test("lists of numbers are separated by commas, each valid and there once", () => {
  assert.deepEqual(parseNumbers("0.1, 0.3,0.6", [0, 1], false), { value: [0.1, 0.3, 0.6] });
  assert.match(parseNumbers("0.1, oops", [0, 1], false).mistake ?? "", /separated by commas/);
  assert.match(parseNumbers("0.1,,0.2", [0, 1], false).mistake ?? "", /separated by commas/);
  assert.match(parseNumbers("1.5", [1, 10], true).mistake ?? "", /whole/);
  assert.match(parseNumbers("0.5, 2", [0, 1], false).mistake ?? "", /from 0 to 1/);
  assert.match(parseNumbers("1, 1.0", [0, 1], false).mistake ?? "", /once/);
});
