// The form, its address, and the requests that it makes.
import assert from "node:assert/strict";
import { beforeEach, test } from "node:test";
import {
  chooseLearner, form, fromQuery, link, mistakes, overrides, raceBody, readAddress, setField, setFields, setMistake,
  toQuery, trainingBody, whatIfBody,
} from "../../static/js/form.js";
import { options } from "../../static/js/store.js";
import { visit } from "./browser.js";
import { OPTIONS } from "./options.js";

visit("/?alpha=0.5");
const firstLink = link();

test("until the server's defaults are known the page's link is its address", () => {
  assert.equal(firstLink, "http://page.test/?alpha=0.5");
});

beforeEach(() => {
  visit("/");
  options.value = OPTIONS;
  overrides.value = {};
  mistakes.value = {};
});

test("the form begins with the server's defaults and nothing else", () => {
  const { training } = OPTIONS.defaults;
  assert.deepEqual(form.value, { ...training, race_steps: 50, lanes: ["learner", "greedy"], name: "" });
});

test("the address follows the form, and is clean again when the form is", () => {
  setField("alpha", 0.7);
  assert.match(location.search, /alpha=0.7/);
  setField("alpha", OPTIONS.defaults.training.alpha);
  assert.equal(location.search, "");
});

test("a form read from its own query is the same form", () => {
  const changes = {
    agent: "tracer", trace: 0.5, kind: "adding", gait: "wave", pace: 2, lanes: ["greedy"], name: "A & B",
  };
  setFields(changes);
  const [before, query] = [form.value, toQuery()];
  overrides.value = {};
  overrides.value = fromQuery(query);
  assert.deepEqual(form.value, before);
  assert.deepEqual({ ...before, ...changes }, before);
  setField("pace", "max");
  assert.ok(!("pace" in fromQuery(toQuery())));
});

test("values of an address that cannot be read are skipped", () => {
  visit("/?alpha=seven&steps=&gamma=0.5&pace=fast&unknown=1&agent=greedy&trace=0.5");
  readAddress();
  assert.equal(form.value.gamma, 0.5);
  assert.equal(form.value.alpha, 0.3);
  assert.equal(form.value.steps, 500);
  assert.equal(form.value.pace, "max");
  assert.equal(form.value.agent, "learner");
  assert.ok(!("unknown" in form.value) && !("trace" in form.value));
});

test("a link to a single setting sets it alone", () => {
  visit("/?alpha=0.5");
  readAddress();
  assert.deepEqual(overrides.value, { alpha: 0.5 });
});

test("another learner brings its own settings and defaults, and keeps what a person set", () => {
  setField("gamma", 0.5);
  chooseLearner("tracer");
  assert.deepEqual([form.value.alpha, form.value.trace, form.value.kind], [0.1, 0.9, "replacing"]);
  assert.ok(!("gamma" in form.value));
  setField("alpha", 0.6);
  chooseLearner("learner");
  assert.deepEqual([form.value.alpha, form.value.gamma], [0.6, 0.5]);
});

test("a value that the chosen learner cannot read is its default", () => {
  setFields({ agent: "tracer", kind: 3, trace: "often" });
  assert.deepEqual([form.value.kind, form.value.trace], ["replacing", 0.9]);
});

test("the chosen learner takes the lane of the one before it, unless it has its own", () => {
  chooseLearner("tracer");
  assert.deepEqual(form.value.lanes, ["tracer", "greedy"]);
  setField("lanes", ["tracer", "planner"]);
  chooseLearner("learner");
  assert.deepEqual(form.value.lanes, ["learner", "planner"]);
  setField("lanes", ["learner", "tracer"]);
  chooseLearner("tracer");
  assert.deepEqual(form.value.lanes, ["learner", "tracer"]);
});

test("a mistake is kept until it is corrected", () => {
  setMistake("alpha", "Enter a number");
  assert.deepEqual(mistakes.value, { alpha: "Enter a number" });
  setMistake("alpha", null);
  assert.deepEqual(mistakes.value, {});
});

test("a training that continues another has no seed", () => {
  setField("name", "  mine ");
  const fresh = trainingBody();
  assert.equal(fresh.name, "mine");
  assert.equal(fresh.seed, 0);
  setField("name", "");
  const continued = trainingBody("run-1");
  assert.equal(continued.continue_from, "run-1");
  assert.ok(!("seed" in continued) && !("name" in continued));
});

test("a training has the settings of its learner and no others", () => {
  setField("gamma", 0.5);
  assert.deepEqual(trainingBody(), {
    agent: "learner", gait: "tripod", robot: "stiff", simulator: "mujoco", divisions: 2, grid_side_m: 0.04, steps: 500,
    seed: 0, observation: "measured", alpha: 0.3, gamma: 0.5, epsilon_start: 1, epsilon_end: 0, steps_per_episode: 50,
    evaluate_every: 50, pace: "max",
  });
  chooseLearner("tracer");
  const { alpha, trace, kind, ...rest } = trainingBody();
  assert.deepEqual([alpha, trace, kind], [0.1, 0.9, "replacing"]);
  assert.ok(!("gamma" in rest) && !("lanes" in rest) && !("race_steps" in rest));
});

const lanesOf = (/** @type {Parameters<typeof raceBody>[0]} */ how = {}) =>
  /** @type {{ agent: string, training_id?: string, training?: Record<string, unknown> }[]} */ (raceBody(how).lanes);

test("in a race learners practise, continue or use a table", () => {
  const [practising, greedy] = lanesOf();
  assert.equal(practising.training?.steps, 500);
  assert.deepEqual(greedy, { agent: "greedy" });
  assert.equal(lanesOf({ continued: { learner: "run-1" } })[0].training?.continue_from, "run-1");
  assert.deepEqual(lanesOf({ tables: { learner: "run-1" } })[0], { agent: "learner", training_id: "run-1" });
  assert.equal(raceBody().steps, 50);
});

test("each learner of a race practises with its own settings, and a link has them all", () => {
  setFields({ lanes: ["learner", "tracer"], trace: 0.5, gamma: 0.8 });
  const practices = () => lanesOf().map(({ training }) => training);
  const [learner, tracer] = practices();
  assert.deepEqual([learner?.alpha, learner?.gamma, learner?.trace], [0.3, 0.8, undefined]);
  assert.deepEqual([tracer?.alpha, tracer?.gamma, tracer?.trace], [0.1, undefined, 0.5]);
  overrides.value = fromQuery(toQuery());
  assert.deepEqual(practices(), [learner, tracer]);
});

test("a what-if does not depend on seed, pace, name and simulator", () => {
  const before = whatIfBody();
  setFields({ seed: 9, pace: 8, name: "x", simulator: "kinematic", race_steps: 7 });
  assert.deepEqual(whatIfBody(), before);
  setField("alpha", 0.9);
  assert.notDeepEqual(whatIfBody(), before);
});
