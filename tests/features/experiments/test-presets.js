// The presets of experiments: what each begins with and shows, and which one a link looks like.
import assert from "node:assert/strict";
import { beforeEach, test } from "node:test";
import {
  chosenExperiment, enter, mistakes, openExperimentForm, requestBody, setField, setFormOf, trials, values,
} from "../../../static/features/experiments/form.js";
import {
  chooseAgent, choosePreset, chooseSwept, chosenPreset, forgetPreset, isMoreSet, presets, suggestedValues, sweepable,
  sweptField,
} from "../../../static/features/experiments/presets.js";
import {
  configInWords, findingIn, outcomeOf, stateInWords, verdictsInWords,
} from "../../../static/features/experiments/words.js";
import { page } from "../../../static/js/page-state.js";
import { options } from "../../../static/js/store.js";
import { installOnly } from "../../page/features.js";
import { makeRun, OPTIONS, setting } from "../../page/options.js";

/** @import { Summary } from "../../../static/js/types.js" */

/** @param {string} query */
function open(query) {
  forgetPreset();
  page.experiment.value = new URLSearchParams(query);
  openExperimentForm();
}

await installOnly("experiments");

beforeEach(() => {
  options.value = OPTIONS;
  open("");
});

test("the presets are the own ones, and the experiments of the server as they are", () => {
  assert.deepEqual(presets().map(({ name }) => name),
    ["setting", "learners", "worlds", "table1", "figure4", "league", "recovery", "empty"]);
  options.value = { ...OPTIONS, experiments: OPTIONS.experiments.slice(0, 1) };
  assert.deepEqual(presets().map(({ name }) => name), ["table1"]);
});

test("each preset can be started as it begins, and shows all that it set", () => {
  for (const { name, experiment } of presets()) {
    choosePreset(name);
    assert.equal(chosenPreset().name, name);
    assert.deepEqual([chosenExperiment.value.name, mistakes.value], [experiment, {}], name);
    assert.equal(isMoreSet(), name === "empty", name);
    assert.ok(trials.value > 0, name);
  }
});

test("a setting is swept in one gait of the quick simulator", () => {
  choosePreset("setting");
  assert.deepEqual(requestBody(), {
    experiment: "sweep", simulator: "kinematic", gaits: ["tripod"], settings: { alpha: [0.1, 0.3, 0.5, 0.7, 0.9] },
  });
  assert.equal(sweptField(), "alpha");
});

test("every setting of the chosen agent can be swept, and those of every practice", () => {
  choosePreset("setting");
  assert.deepEqual(sweepable(), ["alpha", "gamma", "epsilon_start", "epsilon_end", "steps"]);
  chooseSwept("steps");
  assert.deepEqual([values.value.alpha, values.value.steps], [[0.3], [125, 250, 500, 1000, 2000]]);
  enter("steps", "500");
  assert.equal(sweptField(), "steps", "also with its default alone");
  chooseSwept("alpha");
  chooseAgent("tracer");
  assert.deepEqual([sweptField(), values.value.agents], ["alpha", ["tracer"]]);
  chooseSwept("kind");
  assert.deepEqual(values.value.kind, ["replacing", "adding"]);
  chooseAgent("learner");
  assert.deepEqual([sweptField(), isMoreSet()], ["alpha", false]);
});

test("what another preset shows too is kept, the rest begins anew", () => {
  choosePreset("setting");
  setField("seeds", 7);
  setField("agents", ["tracer"]);
  choosePreset("learners");
  assert.deepEqual(requestBody().settings, undefined);
  assert.deepEqual([values.value.seeds, values.value.agents], [7, ["tracer"]]);
  choosePreset("table1");
  assert.deepEqual(requestBody(), { experiment: "table1", seeds: 7 });
});

test("the empty preset begins anew, and leads to any other with what was set since", () => {
  choosePreset("setting");
  setField("seeds", 7);
  choosePreset("empty", true);
  assert.deepEqual(requestBody(), { experiment: "sweep" });
  setField("seeds", 9);
  setField("gaits", ["wave"]);
  choosePreset("league", isMoreSet());
  assert.deepEqual(requestBody(), { experiment: "league", seeds: 9, gaits: ["wave"] });
});

test("a link opens the preset that it looks like, and all settings where that shows less", () => {
  for (const [query, name, isMore] of /** @type {[string, string, boolean][]} */ ([
    ["experiment=sweep&alpha=0.1,0.3", "setting", false],
    ["experiment=sweep&alpha=0.1,0.3&gaits=wave", "setting", false],
    ["experiment=sweep&alpha=0.1,0.3&gaits=ghost", "setting", true],
    ["experiment=sweep&alpha=0.1,0.3&gamma=0.5", "setting", true],
    ["experiment=sweep&agents=learner,tracer", "learners", false],
    ["experiment=sweep&agents=learner,tracer&trace=0.1,0.5", "learners", true],
    ["seeds=3", "table1", false],
    ["seed=3", "table1", true],
  ])) {
    open(query);
    assert.deepEqual([chosenPreset().name, isMoreSet()], [name, isMore], query);
  }
});

test("suggested values are among the valid ones, and have the default", () => {
  const of = (/** @type {object} */ changes) => suggestedValues(setting("Any", changes));
  assert.deepEqual(of({ default: 0.9, minimum: 0, maximum: 1, excludes_maximum: true }), [0.1, 0.3, 0.5, 0.7, 0.9]);
  assert.deepEqual(of({ default: 0, minimum: 0, maximum: 1 }), [0, 0.1, 0.3, 0.5, 0.7, 0.9]);
  assert.deepEqual(of({ default: 2, minimum: 2, maximum: 8, is_whole: true }), [2, 4, 8]);
  assert.deepEqual(of({ default: 0.04, minimum: 0.005, maximum: 10, unit: "m" }), [0.01, 0.02, 0.04, 0.08]);
  assert.deepEqual(of({ is_number: false, choices: ["none", "some"] }), ["none", "some"]);
  assert.deepEqual(of({}), []);
});

test("an experiment is repeated with its config, and what no form can say is told", () => {
  choosePreset("setting");
  setField("seed", 5);
  const body = requestBody();
  const config = { ...body, robots: [{ preset: "stiff" }], settings: { alpha: [0.1, 0.5], gamma: [0.9] } };
  open("");
  assert.deepEqual(setFormOf(/** @type {any} */ (config)), []);
  assert.deepEqual(requestBody(), { ...body, settings: { alpha: [0.1, 0.5] } });
  const withOwnRobot = { ...config, robots: [{ preset: "stiff", femur_m: 0.1 }], gaits: [{ pairs: [] }] };
  assert.deepEqual(setFormOf(/** @type {any} */ (withOwnRobot)), ["gaits", "robots"]);
});

test("a state says how far it is", () => {
  const run = makeRun({ kind: "experiment", state: "running", progress: { done: 42, total: 100 }, eta_s: 360 });
  assert.equal(stateInWords(run), "42 %, 6 min left");
  assert.equal(stateInWords({ ...run, eta_s: null }), "42 %");
  assert.equal(stateInWords({ ...run, state: "stopped" }), "stopped at 42 %");
  assert.equal(stateInWords({ ...run, state: "finished" }), "finished");
});

test("an experiment says in a line what is the same in all its trials", () => {
  const config = {
    experiment: "sweep", agents: ["learner"], steps: [500], gaits: ["tripod", "wave"], observations: ["measured"],
    robots: [{ preset: "stiff" }], seeds: 30, seed: 0, tolerance: 0, simulator: "kinematic",
  };
  assert.equal(configInWords(/** @type {any} */ (config)),
    "Learner · 500 steps of practice · all 2 gaits · feet measured · stiff robot · 30 seeds · ideal (no slip)");
});

test("a finding is the server’s sentence, else its verdicts, else nothing", () => {
  const summary = (/** @type {object} */ parts) => /** @type {Summary} */ (/** @type {unknown} */ (parts));
  const claims = ["holds", "does not hold", "does not hold", "not established"].map((verdict) => ({ verdict }));
  assert.equal(findingIn(summary({ finding: "α 0.1 leads.", claims })), "α 0.1 leads.");
  assert.equal(verdictsInWords(claims),
    "Of the paper’s 4 claims 1 holds, 2 do not hold and 1 is not established.");
  assert.equal(findingIn(summary({ finding: "", claims })), verdictsInWords(claims));
  assert.equal(findingIn(summary({ finding: "", claims: claims.slice(0, 1) })), "");
  assert.equal(findingIn(null), "");
});

test("a row tells the finding whether its report was opened or not", () => {
  const outcome = (/** @type {object} */ result) =>
    outcomeOf(makeRun({ kind: "experiment", result: /** @type {any} */ (result) }), null);
  assert.equal(outcome({ finding: "α 0.1 leads.", claims: [{ verdict: "holds" }] }), "α 0.1 leads.");
  assert.equal(outcome({ finding: "", claims: [{ verdict: "holds" }, { verdict: "depends" }] }),
    "Of the paper’s 2 claims 1 holds and 1 depends on the case.");
  assert.equal(outcomeOf(makeRun({ kind: "experiment", result: null }), null), "");
});
