// Views, errors of the API, titles, and the learner's next move.
import assert from "node:assert/strict";
import { beforeEach, test } from "node:test";
import { downloads, fileAddress, refusal } from "../../static/js/api.js";
import { viewOf } from "../../static/js/page.js";
import { options } from "../../static/js/store.js";
import { choicesOf, clockTitle, gaitTitle, observationTitle, simulatorTitle } from "../../static/js/titles.js";
import { bestMove, placeName } from "../../static/js/training.js";
import { OPTIONS } from "./options.js";

beforeEach(() => (options.value = OPTIONS));

test("the hash names the view", () => {
  assert.deepEqual(["", "#", "#runs", "#experiments?run=1", "#nothing"].map(viewOf),
    ["race", "race", "runs", "experiments", "race"]);
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

test("addresses of files are escaped part by part", () => {
  const run = { kind: /** @type {const} */ ("experiment"), id: "a b" };
  assert.equal(fileAddress(run, "figures/one two.png"),
    "http://page.test/api/v1/experiments/a%20b/files/figures/one%20two.png");
  assert.deepEqual(downloads({ ...run, kind: "race" }).map(([label]) => label), ["Recording"]);
  assert.equal(downloads({ ...run, kind: "training" }).length, 3);
});

test("names of the vocabulary, unless the server has a title", () => {
  assert.equal(observationTitle("commanded"), "commands remembered");
  assert.equal(simulatorTitle("mujoco"), "MuJoCo physics");
  assert.deepEqual(["paper", "wall", "free"].map(clockTitle), ["paper clock", "real clock", "no clock"]);
  assert.equal(gaitTitle("wave"), "The wave");
  assert.equal(gaitTitle("unknown"), "unknown");
  assert.deepEqual(choicesOf(OPTIONS.simulators, simulatorTitle),
    [["mujoco", "MuJoCo physics"], ["kinematic", "Ideal (no slip)"]]);
});

test("the best move is the one of the highest value", () => {
  assert.deepEqual(bestMove({ values_m: [[null, 0.1], [-0.2, 0.3]] }), { pair: 1, cell: 1, value: 0.3 });
  assert.equal(bestMove({ values_m: [[null, null]] }).pair, -1);
});

test("places are named on a small grid and measured on a fine one", () => {
  const named = { cell_names: ["home", "front left"], cells_m: /** @type {[number, number][]} */ ([[0, 0], [-1, 1]]) };
  assert.equal(placeName(named, 1), "front left");
  const fine = {
    cell_names: ["home", "a", "b", "c", "d", "e"],
    cells_m: /** @type {[number, number][]} */ ([[0, 0], [-0.02, 0.01], [0.02, 0], [0, -0.01], [0, 0], [0, 0]]),
  };
  assert.deepEqual([0, 1, 2, 3].map((cell) => placeName(fine, cell, " mm")),
    ["home", "20 mm left, 10 mm front", "20 mm right", "10 mm back"]);
});
