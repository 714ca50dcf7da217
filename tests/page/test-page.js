// Views, errors of the API, and titles.
import assert from "node:assert/strict";
import { beforeEach, test } from "node:test";
import { signal } from "@preact/signals";
import { refusal } from "../../static/js/api.js";
import { followQuery, goIfStillHere, place, viewOf } from "../../static/js/page.js";
import { options } from "../../static/js/store.js";
import { choicesOf, clockTitle, gaitTitle, observationTitle, simulatorTitle } from "../../static/js/titles.js";
import { visit } from "./browser.js";
import { OPTIONS } from "./options.js";

beforeEach(() => (options.value = OPTIONS));

test("the hash names the view", () => {
  assert.deepEqual(["", "#", "#runs", "#experiments?run=1", "#nothing"].map(viewOf),
    ["race", "race", "runs", "experiments", "race"]);
});

test("an action goes to its view only from the one in which it was begun", () => {
  place.value = "runs";
  const go = goIfStillHere();
  place.value = "experiments";
  go("#late");
  assert.notEqual(location.hash, "#late");
  goIfStillHere()("#there");
  assert.equal(location.hash, "#there");
});

test("a problem document becomes a message and the fields that it is about", () => {
  const refused = refusal(422, {
    title: "Invalid", detail: "alpha must be above 0",
    errors: [{ field: "alpha" }, { loc: ["body", "steps"] }, { pointer: "/lanes/0/agent" }],
  });
  assert.deepEqual([refused.message, refused.status, refused.fields],
    ["alpha must be above 0", 422, ["alpha", "steps", "agent"]]);
  assert.equal(refusal(502, {}).message, "The server answered 502.");
});

test("names of the vocabulary, unless the server has a title", () => {
  assert.equal(observationTitle("commanded"), "commands remembered");
  assert.equal(observationTitle("planned"), "feet as planned");
  assert.equal(simulatorTitle("mujoco"), "MuJoCo physics");
  assert.deepEqual(["paper", "wall", "free"].map(clockTitle), ["paper clock", "real clock", "no clock"]);
  assert.equal(gaitTitle("wave"), "The wave");
  assert.equal(gaitTitle("unknown"), "unknown");
  assert.deepEqual(choicesOf(OPTIONS.simulators, simulatorTitle),
    [["mujoco", "MuJoCo physics"], ["kinematic", "Ideal (no slip)"]]);
});

test("a view that was just left does not write its query over the new address", () => {
  const search = signal("");
  place.value = "runs";
  visit("/#runs");
  followQuery("runs", () => {}, () => search.value);
  search.value = "search=ben";
  assert.equal(location.hash, "#runs?search=ben");
  visit("/#"); // the event that tells of it comes later
  search.value = "search=anna";
  assert.equal(location.hash, "");
});
