// Settings from their declarations: kinds of control, sliders, names, and which come first.
import assert from "node:assert/strict";
import { beforeEach, test } from "node:test";
import {
  agentOf, beginningOf, furtherSettings, mainSettings, ratesInWords, settingsOf,
} from "../../static/js/agents.js";
import { parseValues } from "../../static/js/limits.js";
import { fullTitle, kindOf, shortTitle, sliderOf, valueOf } from "../../static/js/settings.js";
import { options } from "../../static/js/store.js";
import { OPTIONS, setting } from "./options.js";

beforeEach(() => (options.value = OPTIONS));

const NUMBER = setting("Number", { default: 1 });
const CHOICE = setting("Choice", { is_number: false, choices: ["one", "two"], default: "one" });
const SWITCH = setting("Switch", { is_number: false, is_boolean: true, default: false });
const TEXT = setting("Text", { is_number: false, default: "" });
const MIXED = setting("Mixed", { choices: ["max"], default: "max" });

test("a declaration decides on the kind of control", () => {
  const kinds = [NUMBER, CHOICE, SWITCH, TEXT, MIXED].map(kindOf);
  assert.deepEqual(kinds, ["number", "choice", "switch", "text", "text"]);
});

test("a text is read as the declaration says", () => {
  assert.deepEqual(["0.5", "", "x", "Infinity"].map((text) => valueOf(text, NUMBER)),
    [0.5, undefined, undefined, undefined]);
  assert.deepEqual(["two", "three"].map((text) => valueOf(text, CHOICE)), ["two", undefined]);
  assert.deepEqual(["true", "false", "no"].map((text) => valueOf(text, SWITCH)), [true, false, undefined]);
  assert.equal(valueOf("any words", TEXT), "any words");
  assert.deepEqual(["max", "2", "min"].map((text) => valueOf(text, MIXED)), ["max", 2, undefined]);
});

test("lists are read the same way, each value once", () => {
  assert.deepEqual(parseValues("one, two", CHOICE), { value: ["one", "two"] });
  assert.deepEqual(parseValues("true,false", SWITCH), { value: [true, false] });
  assert.match(parseValues("one, three", CHOICE).mistake ?? "", /^Each must be/);
  assert.match(parseValues("one, one", CHOICE).mistake ?? "", /once/);
  assert.match(parseValues("2", settingsOf(["learner"]).alpha).mistake ?? "", /at most 1/);
});

test("a slider has the ends that are valid", () => {
  const { alpha, gamma } = settingsOf(["learner"]);
  assert.deepEqual(sliderOf(alpha), { min: 0.01, max: 1, step: 0.01 });
  assert.deepEqual(sliderOf(gamma), { min: 0, max: 0.99, step: 0.01 });
  assert.deepEqual(sliderOf(setting("Depth", { minimum: 1, maximum: 8, is_whole: true })), { min: 1, max: 8, step: 1 });
  assert.equal(sliderOf(setting("Size", { minimum: 1 })), null);
});

test("names are made of title, symbol and unit", () => {
  const { alpha, epsilon_start: start } = settingsOf(["learner"]);
  assert.deepEqual([shortTitle(alpha), fullTitle(alpha)], ["α", "Learning rate α"]);
  assert.equal(shortTitle(start), "ε, first episode");
  assert.equal(shortTitle(setting("Foot grid, side", { unit: "m" })), "Foot grid, side (m)");
});

test("what acts on a running training comes first, with what it replaces", () => {
  const main = mainSettings("learner").map(({ name, live, end }) => [name, live, end]);
  assert.deepEqual(main,
    [["alpha", "alpha", null], ["gamma", "gamma", null], ["epsilon_start", "epsilon", "epsilon_end"]]);
  assert.deepEqual(furtherSettings("learner").map(([name]) => name), ["epsilon_end"]);
  assert.deepEqual(mainSettings("tracer").map(({ name }) => name), ["alpha", "trace"]);
  assert.deepEqual(furtherSettings("tracer").map(([name]) => name), ["kind"]);
  assert.deepEqual(mainSettings("removed"), []);
});

test("without live settings the first that is declared comes first", () => {
  const still = { ...agentOf("tracer"), live_settings: {} };
  options.value = { ...OPTIONS, agents: [still] };
  assert.deepEqual(mainSettings("tracer").map(({ name, live }) => [name, live]), [["alpha", null]]);
});

test("a live setting that no setting begins has the value of the first of its symbol", () => {
  assert.equal(beginningOf("learner", "epsilon", { epsilon_start: 0.7, alpha: 0.2 }), 0.7);
  assert.equal(beginningOf("learner", "alpha", { epsilon_start: 0.7, alpha: 0.2 }), 0.2);
});

test("a run is described by its live settings", () => {
  assert.deepEqual(ratesInWords("tracer", { alpha: 0.1, trace: 0.9, kind: "adding" }), ["α\u00a00.1", "λ\u00a00.9"]);
  assert.deepEqual(ratesInWords("removed", { alpha: 0.1 }), []);
});

test("settings of several agents are those of the first, then the others'", () => {
  const found = settingsOf(["tracer", "learner"]);
  assert.deepEqual(Object.keys(found), ["alpha", "trace", "kind", "gamma", "epsilon_start", "epsilon_end"]);
  assert.equal(found.alpha.default, 0.1);
});
