// Settings from their declarations: kinds of control, sliders, names, limits, and which come first.
import assert from "node:assert/strict";
import { beforeEach, test } from "node:test";
import {
  agentOf, beginningOf, fieldBeside, fullTitle, furtherSettings, kindOf, laneTitle, limitsOf, mainSettings, mistakeIn,
  quantityOf, rangeOf, ratesInWords, settingOf, settingsOf, shortTitle, sliderOf, withinRanges,
} from "../../static/js/settings.js";
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
  assert.deepEqual([shortTitle(start), fullTitle(start)], ["Initial ε", "Initial exploration ε"]);
  assert.deepEqual([quantityOf(start), quantityOf(alpha)], ["Exploration", "Learning rate"]);
  assert.equal(shortTitle(setting("Grid side", { unit: "m" })), "Grid side (m)");
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
  const settings = settingsOf(["tracer", "learner"]);
  assert.deepEqual(Object.keys(settings), ["alpha", "trace", "kind", "gamma", "epsilon_start", "epsilon_end"]);
  assert.equal(settings.alpha.default, 0.1);
});

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
  assert.equal(mistakeIn(NaN, limits(null, null), true), "Enter a whole number");
});

test("a limit that is not valid itself is refused", () => {
  const alpha = limits(0, 1, true, false);
  assert.equal(mistakeIn(0, alpha, false), "Must be over 0 and at most 1");
  assert.equal(mistakeIn(1, alpha, false), null);
  assert.equal(mistakeIn(1, limits(0, 1, false, true), false), "Must be from 0 to under 1");
});

test("a lane is named by its agent and its settings", () => {
  options.value = OPTIONS;
  assert.equal(laneTitle({ agent: "greedy" }), "Greedy");
  assert.equal(laneTitle({ agent: "planner", settings: { depth: 2 }, keep_learning: false }), "Planner, depth\u00a02");
  assert.equal(laneTitle({ agent: "learner", settings: { alpha: 0.3, gamma: 0.5 } }), "Learner, γ\u00a00.5");
  assert.equal(laneTitle({ agent: "learner", keep_learning: true }), "Learner, keeps learning");
  assert.equal(laneTitle({ agent: "tracer", keep_learning: false }), "Tracer, frozen");
});

test("an angle is within the reach of its joint", () => {
  const fields = OPTIONS.disturbances.find(({ name }) => name === "stuck")?.fields ?? {};
  const values = { joint: "coxa", angle_rad: 1.5 };
  const { minimum, maximum } = fieldBeside(fields.angle_rad, values);
  assert.deepEqual([minimum, maximum], [-1.2, 1.2]);
  assert.deepEqual(withinRanges(fields, values), { joint: "coxa", angle_rad: 1.2 });
  assert.deepEqual(withinRanges(fields, { joint: "femur", angle_rad: 1.5 }), { joint: "femur", angle_rad: 1.5 });
});
