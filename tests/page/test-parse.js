// Typed text, read as numbers, lists and choices, or refused with the reason.
import assert from "node:assert/strict";
import { readFileSync } from "node:fs";
import { test } from "node:test";
import {
  parseChoice, parseChoiceOrParts, parseChoices, parseName, parseNumber, parseNumbers, parseSetting, parseValues,
} from "../../static/js/parse.js";
import { settingsOf } from "../../static/js/settings.js";
import { options } from "../../static/js/store.js";
import { OPTIONS, setting } from "./options.js";

options.value = OPTIONS;

const { alpha: ALPHA, epsilon_start: EPSILON } = settingsOf(["learner"]);
const NUMBER = setting("Number", { default: 1 });
const OPTIONAL = setting("Optional", { default: null });
const STEPS = setting("Steps", { minimum: 1, maximum: 10_000_000, is_whole: true, default: 500 });
const SEED = setting("Seed", { minimum: 0, is_whole: true, default: 0 });
const CHOICE = setting("Choice", { is_number: false, choices: ["one", "two"], default: "one", valid: "one, or two" });
const SWITCH = setting("Switch", { is_number: false, is_boolean: true, default: false });
const TEXT = setting("Text", { is_number: false, default: "" });
const MIXED = setting("Mixed", { choices: ["max"], default: "max", valid: "max, or a number" });

/** @import { Parsed } from "../../static/js/parse.js" */
const mistake = (/** @type {Parsed<any>} */ parsed) => parsed.mistake ?? "";

test("a text is read as the declaration says", () => {
  const values = (/** @type {string[]} */ texts, /** @type {any} */ declared) =>
    texts.map((text) => parseSetting(text, declared).value);
  assert.deepEqual(values(["0.5", "", "x", "Infinity", "0x10", "1e400"], NUMBER),
    [0.5, undefined, undefined, undefined, undefined, undefined]);
  assert.deepEqual(values(["", "2"], OPTIONAL), [null, 2]);
  assert.deepEqual(values(["two", "three"], CHOICE), ["two", undefined]);
  assert.deepEqual(values(["true", "false", "no"], SWITCH), [true, false, undefined]);
  assert.deepEqual(values(["any words"], TEXT), ["any words"]);
  assert.deepEqual(values(["max", "2", "0,5", "min"], MIXED), ["max", 2, 0.5, undefined]);
  assert.match(mistake(parseSetting("min", MIXED)), /“min” is not valid: it must be max, or a number/);
});

test("numbers are read as the server reads them", () => {
  const limits = { minimum: null, maximum: null, excludes_minimum: false, excludes_maximum: false };
  for (const { text, is_whole, value } of
    JSON.parse(readFileSync(new URL("../cases/numbers.json", import.meta.url), "utf8"))) {
    assert.equal(parseNumber(text, limits, is_whole).value ?? null, value, text);
  }
});

test("a decimal comma, a typographic minus and grouped digits are read", () => {
  const values = (/** @type {string[]} */ ...texts) => texts.map((text) => parseNumber(text, NUMBER, false).value);
  assert.deepEqual(values("0,06", " 0.06 ", ",5", "\u22125", "-5", "1e-3"), [0.06, 0.06, 0.5, -5, -5, 0.001]);
  assert.deepEqual(values("12\u202f500", "12 500", "1 000 000,5"), [12_500, 12_500, 1_000_000.5]);
  assert.deepEqual(values("0.1 0.3", "1 00", "5-", "--5", "1.2.3"), Array(5).fill(undefined));
  assert.equal(mistake(parseNumber("\u22125", SEED, true)), "Must be at least 0");
});

test("a text with two meanings is refused, and both are named", () => {
  assert.match(mistake(parseNumber("1,000", STEPS, true)), /“1,000” can mean 1 or 1000/);
  assert.match(mistake(parseNumber("1.000", STEPS, true)), /can mean 1 or 1000/);
  assert.deepEqual(parseNumber("1,500", STEPS, true), { value: 1500 });
  assert.deepEqual(parseNumber("1.500", NUMBER, false), { value: 1.5 });
  assert.match(mistake(parseNumbers("0,1", EPSILON, false)), /“0; 1” or “0.1”/);
  assert.match(mistake(parseNumbers("1,500", STEPS, true)), /“1; 500” or “1500”/);
  assert.match(mistake(parseNumbers("250 500", STEPS, true)), /“250; 500” or “250500”/);
});

test("a whole number that the page cannot keep exactly is refused", () => {
  assert.deepEqual(parseNumber("9007199254740991", SEED, true), { value: 9_007_199_254_740_991 });
  assert.match(mistake(parseNumber("9007199254740993", SEED, true)), /^Must be at most 9\u202f007/);
});

test("lists are separated by commas, semicolons or spaces", () => {
  const spellings = ["0.1,0.3", "0.1, 0.3", "0.1 0.3", "0.1; 0.3", "0.1;0.3", "0,1; 0,3", "0,1 0,3", " 0.1\t0.3 "];
  for (const text of spellings) {
    assert.deepEqual(parseNumbers(text, ALPHA, false), { value: [0.1, 0.3] }, text);
  }
  assert.deepEqual(parseNumbers("0,5", ALPHA, false), { value: [0.5] });
  assert.deepEqual(parseNumbers("0; 1", EPSILON, false), { value: [0, 1] });
  assert.deepEqual(parseNumbers("500 1000", STEPS, true), { value: [500, 1000] });
  assert.deepEqual(parseNumbers("250, 500", STEPS, true), { value: [250, 500] });
  assert.deepEqual(parseNumbers("12\u202f500, 500", STEPS, true), { value: [12_500, 500] });
});

test("a list of which an entry is not valid is refused whole", () => {
  for (const text of ["foo", "0.1, oops", "0.1,,0.2", "0.1,", "", "0.1; 0.3;", "0.1, 0.3; 0.5"]) {
    assert.match(mistake(parseNumbers(text, ALPHA, false)), /separated by commas.*each over 0 and at most 1/, text);
  }
  assert.match(mistake(parseNumbers("1.5", STEPS, true)), /whole/);
  assert.match(mistake(parseNumbers("0.5, 2", EPSILON, false)), /from 0 to 1/);
  assert.match(mistake(parseNumbers("1, 1.0", EPSILON, false)), /once/);
});

test("lists of words are read the same way, each once", () => {
  assert.deepEqual(parseValues("one, two", CHOICE), { value: ["one", "two"] });
  assert.deepEqual(parseValues("one two", CHOICE), { value: ["one", "two"] });
  assert.deepEqual(parseValues("true,false", SWITCH), { value: [true, false] });
  assert.match(mistake(parseValues("one, three", CHOICE)), /^Each must be one, or two/);
  assert.match(mistake(parseValues("one, one", CHOICE)), /once/);
  assert.match(mistake(parseValues("2", ALPHA)), /at most 1/);
});

test("choices are names that are offered, or parts as JSON", () => {
  const names = ["a", "b"];
  const limits = { minimum: 1, maximum: 2, excludes_minimum: false, excludes_maximum: false };
  assert.deepEqual(parseChoice("a", names), { value: "a" });
  assert.match(mistake(parseChoice("nonsense", names)), /“nonsense” is not offered/);
  assert.ok(mistake(parseChoice("x".repeat(500), names)).length < 100);
  assert.deepEqual(parseChoiceOrParts('{"preset":"a","part":2}', names), { value: { preset: "a", part: 2 } });
  assert.match(mistake(parseChoiceOrParts('{"preset":', names)), /cannot be read/);
  assert.deepEqual(parseChoices("a, b", names, limits), { value: ["a", "b"] });
  assert.match(mistake(parseChoices("", names, limits)), /Choose from 1 to 2 of these/);
  assert.match(mistake(parseChoices("a,c", names, limits)), /“c” is not offered/);
  assert.match(mistake(parseName("x".repeat(3), { ...limits, maximum: 2 })), /at most 2 characters; this has 3/);
});
