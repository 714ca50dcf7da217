// The form, its address, and the requests that it makes.
import assert from "node:assert/strict";
import { beforeEach, test } from "node:test";
import {
  applyDefaults, form, fromQuery, link, mistakes, raceBody, readAddress, setField, setMistake, toQuery,
  trainingBody, whatIfBody,
} from "../../static/js/form.js";
import { visit } from "./browser.js";
import { OPTIONS } from "./options.js";

visit("/?alpha=0.5");
const firstLink = link();

test("until the server's defaults are known the page's link is its address", () => {
  assert.equal(firstLink, "http://page.test/?alpha=0.5");
});

beforeEach(() => {
  visit("/");
  applyDefaults(OPTIONS);
  mistakes.value = {};
});

test("the form begins with the server's defaults and nothing else", () => {
  const { agent: _, ...training } = OPTIONS.defaults.training;
  assert.deepEqual(form.value, { ...training, race_steps: 50, lanes: ["learner", "greedy"], name: "" });
});

test("the address follows the form, and is clean again when the form is", () => {
  setField("alpha", 0.7);
  assert.match(location.search, /alpha=0.7/);
  setField("alpha", OPTIONS.defaults.training.alpha);
  assert.equal(location.search, "");
});

test("a form read from its own query is the same form", () => {
  const changed = {
    ...form.value, gait: "wave", alpha: 0.15, pace: /** @type {const} */ ("max"), lanes: ["greedy"], name: "A & B",
  };
  assert.deepEqual({ ...form.value, ...fromQuery(toQuery(changed)) }, changed);
  assert.equal(fromQuery(toQuery({ ...changed, pace: 2 })).pace, 2);
});

test("values of an address that cannot be read are skipped", () => {
  visit("/?alpha=seven&steps=&gamma=0.5&pace=fast&unknown=1");
  readAddress();
  assert.equal(form.value.gamma, 0.5);
  assert.equal(form.value.alpha, 0.3);
  assert.equal(form.value.steps, 500);
  assert.equal(form.value.pace, "max");
  assert.ok(!("unknown" in form.value));
});

test("a mistake is kept until it is corrected", () => {
  setMistake("alpha", "Enter a number");
  assert.deepEqual(mistakes.value, { alpha: "Enter a number" });
  setMistake("alpha", null);
  assert.deepEqual(mistakes.value, {});
});

test("a training that continues another has no seed", () => {
  const fresh = trainingBody({ ...form.value, name: "  mine " });
  assert.equal(fresh.name, "mine");
  assert.equal(fresh.seed, 0);
  const continued = trainingBody(form.value, "run-1");
  assert.equal(continued.continue_from, "run-1");
  assert.ok(!("seed" in continued) && !("name" in continued));
});

test("in a race learners practise, continue or use a table", () => {
  const learns = (/** @type {string} */ agent) => agent === "learner";
  const lanes = (/** @type {Parameters<typeof raceBody>[2]} */ how = {}) => raceBody(form.value, learns, how).lanes;
  const [practising, greedy] = lanes();
  assert.equal(practising.training?.steps, 500);
  assert.deepEqual(greedy, { agent: "greedy" });
  assert.equal(lanes({ continueFrom: "run-1" })[0].training?.continue_from, "run-1");
  assert.deepEqual(lanes({ table: "run-1" })[0], { agent: "learner", training_id: "run-1" });
  assert.equal(raceBody(form.value, learns).steps, 50);
});

test("a what-if does not depend on seed, pace, name and simulator", () => {
  const other = { ...form.value, seed: 9, pace: 8, name: "x", simulator: "kinematic", race_steps: 7 };
  assert.deepEqual(whatIfBody(other), whatIfBody(form.value));
  assert.notDeepEqual(whatIfBody({ ...form.value, alpha: 0.9 }), whatIfBody(form.value));
});
