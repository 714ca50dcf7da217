// Errors of the API, and titles.
import assert from "node:assert/strict";
import { beforeEach, test } from "node:test";
import { refusal } from "../../static/js/api.js";
import { options } from "../../static/js/store.js";
import { choicesOf, clockTitle, gaitTitle, observationTitle, simulatorTitle } from "../../static/js/titles.js";
import { OPTIONS } from "./options.js";

beforeEach(() => (options.value = OPTIONS));

test("a problem document becomes a message and the fields that it is about", () => {
  const refused = refusal(422, {
    title: "Invalid", detail: "alpha must be above 0",
    errors: [{ field: "alpha" }, { loc: ["body", "steps"] }, { pointer: "/lanes/0/agent" }, { field: "gaits.0" }],
  });
  assert.deepEqual([refused.message, refused.status, refused.fields],
    ["alpha must be above 0", 422, ["alpha", "steps", "agent", "gaits"]]);
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
