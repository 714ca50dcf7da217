// The form of experiments, its address, trial counts, units and places.
import assert from "node:assert/strict";
import { beforeEach, test } from "node:test";
import {
  bare, factorOf, gaitsOf, greedyIn, inUnit, placesOf, shown, unit,
} from "../../../static/features/experiments/distances.js";
import {
  agentSettings, chooseExperiment, chosenExperiment, enter, mistakes, openExperimentForm, requestBody, setField,
  takesField, trials, values, wrong,
} from "../../../static/features/experiments/form.js";
import experiments, { paceOf } from "../../../static/features/experiments/feature.js";
import { ignored, page } from "../../../static/js/page-state.js";
import { options } from "../../../static/js/store.js";
import { fieldTitle, inFormWords, robotTitle, variedFields } from "../../../static/js/titles.js";
import { installOnly } from "../../page/features.js";
import { makeRun, OPTIONS } from "../../page/options.js";

/** @import { Setting } from "../../../static/js/types.js" */

await installOnly("experiments");
/** @type {NonNullable<import("../../../static/js/types.js").Feature["kinds"]>} */
const { experiment: { describe } } = experiments.kinds ?? {};

const query = () => String(page.experiment.value);
/** @param {URLSearchParams} texts */
function readQuery(texts) {
  page.experiment.value = texts;
  openExperimentForm();
}

beforeEach(() => {
  options.value = OPTIONS;
  readQuery(new URLSearchParams());
  unit.value = "m";
});

test("the first experiment is chosen, with its own defaults", () => {
  assert.equal(chosenExperiment.value.name, "table1");
  assert.deepEqual(values.value.steps, [500, 1000]);
  assert.deepEqual(requestBody(), { experiment: "table1" });
  assert.equal(query(), "");
});

test("only what differs is sent and linked to", () => {
  chooseExperiment("sweep");
  setField("alpha", [0.1, 0.3]);
  setField("seeds", 30);
  assert.deepEqual(requestBody(), { experiment: "sweep", settings: { alpha: [0.1, 0.3] } });
  setField("alpha", [0.3]);
  assert.deepEqual(requestBody(), { experiment: "sweep" });
});

test("fields that the chosen experiment does not take are kept but not sent", () => {
  chooseExperiment("sweep");
  setField("alpha", [0.1]);
  chooseExperiment("table1");
  assert.deepEqual(requestBody(), { experiment: "table1" });
  chooseExperiment("sweep");
  assert.deepEqual(requestBody(), { experiment: "sweep", settings: { alpha: [0.1] } });
});

test("a link carries the form", () => {
  chooseExperiment("sweep");
  setField("alpha", [0.1, 0.3]);
  setField("gaits", ["wave"]);
  setField("name", "mine");
  const [sent, link] = [requestBody(), query()];
  readQuery(new URLSearchParams());
  assert.notDeepEqual(requestBody(), sent);
  readQuery(new URLSearchParams(link));
  assert.deepEqual(requestBody(), sent);
});

test("what was typed is read, or kept as it is and explained", () => {
  chooseExperiment("sweep");
  for (const text of ["0.1 0.3", "0,1; 0,3", "0.1,0.3"]) {
    enter("alpha", text);
    assert.deepEqual(values.value.alpha, [0.1, 0.3], text);
  }
  for (const text of ["foo", "0,1 x", "1.5", "0.1,"]) {
    enter("alpha", text);
    assert.deepEqual([values.value.alpha, wrong.value.alpha.text], [[0.1, 0.3], text]);
    assert.match(mistakes.value.alpha, /over 0 and at most 1/);
  }
  enter("seeds", "12");
  assert.equal(values.value.seeds, 12);
  enter("seeds", "1.5");
  assert.match(mistakes.value.seeds, /whole number/);
  enter("gaits", "");
  assert.match(mistakes.value.gaits, /at least 1/);
  assert.deepEqual(Object.keys(mistakes.value).sort(), ["alpha", "gaits", "seeds"]);
  chooseExperiment("table1");
  assert.deepEqual(Object.keys(mistakes.value).sort(), ["gaits", "seeds"]);
});

test("what is not valid in a link is kept as it is, and stays in the link", () => {
  const wanted = "experiment=unknown&seeds=many&gaits=wave,ghost&simulator=dream";
  readQuery(new URLSearchParams(`${wanted}&blocks=3`));
  assert.deepEqual(Object.keys(mistakes.value).sort(), ["experiment", "gaits", "seeds", "simulator"]);
  assert.deepEqual([...page.experiment.value].sort(), [...new URLSearchParams(wanted)].sort());
  assert.deepEqual(ignored.experiments.value, ["blocks=3"]);
  chooseExperiment("sweep");
  assert.ok(!("experiment" in mistakes.value));
  readQuery(new URLSearchParams("experiment=sweep&alhpa=0.5"));
  assert.deepEqual(ignored.experiments.value, ["alhpa=0.5"]);
});

test("a list of which a link could be read in another way is written with semicolons", () => {
  chooseExperiment("sweep");
  setField("epsilon_end", [0, 1]);
  assert.match(query(), /epsilon_end=0%3B1/);
  readQuery(new URLSearchParams(query()));
  assert.deepEqual(values.value.epsilon_end, [0, 1]);
  enter("epsilon_end", "0,1");
  readQuery(new URLSearchParams(query()));
  assert.equal(wrong.value.epsilon_end.text, "0,1");
});

test("values that other agents do not accept are explained", () => {
  chooseExperiment("sweep");
  setField("gamma", [0.5, 2]);
  assert.match(mistakes.value.gamma, /under 1/);
  setField("agents", ["tracer"]);
  assert.deepEqual(mistakes.value, {});
});

test("a name is kept with its spaces while it is typed, and sent without those at its ends", () => {
  enter("name", "my ");
  assert.equal(values.value.name, "my ");
  assert.equal(requestBody().name, "my");
  enter("name", " ");
  assert.ok(!("name" in requestBody()));
});

test("trials are counted before they are started", () => {
  // Two gaits, each with two references, two lengths of practice and a race that measures.
  setField("seeds", 3);
  assert.equal(trials.value, 2 * (2 + 2 * 3 + 1));
  // Practice in blocks, and once more in one go.
  chooseExperiment("figure4");
  assert.equal(trials.value, 2 * (1 + 2 * 3));
  chooseExperiment("sweep");
  setField("alpha", [0.1, 0.3, 0.6]);
  assert.equal(trials.value, 2 * (1 + 3 * 3));
  setField("agents", ["learner", "greedy", "planner"]);
  assert.equal(trials.value, 2 * (1 + 1 + 3 * 3));
});

test("worlds are chosen by name, or say what happens", () => {
  chooseExperiment("league");
  assert.deepEqual(values.value.worlds, ["flat", "limp-pair"]);
  for (const text of ["limp-pair, limp:legs=2,5+slope:degrees=4", "limp-pair;limp:legs=2,5+slope:degrees=4;"]) {
    enter("worlds", text);
    assert.deepEqual(values.value.worlds, ["limp-pair", "limp:legs=2,5+slope:degrees=4"]);
  }
  const [sent, link] = [requestBody(), query()];
  assert.deepEqual(sent.worlds, values.value.worlds);
  readQuery(new URLSearchParams());
  readQuery(new URLSearchParams(link));
  assert.deepEqual(requestBody(), sent);

  for (const [text, why] of /** @type {[string, RegExp][]} */ ([
    ["", /at least 1/], ["moon", /“moon” is no world/], ["flat,flat", /each world once/],
    ["slope:degrees=99", /Slope.*from 0 to 30/], ["slope:degrees=4:at=5", /leave out at and until/],
  ])) {
    enter("worlds", text);
    assert.match(mistakes.value.worlds, why, text);
  }
  readQuery(new URLSearchParams(query()));
  assert.equal(wrong.value.worlds.text, "slope:degrees=4:at=5");
  chooseExperiment("table1");
  assert.deepEqual(mistakes.value, {});
});

test("a simulator has its own defaults, and refuses the worlds that it does not know", () => {
  chooseExperiment("league");
  setField("simulator", "kinematic");
  assert.deepEqual([values.value.worlds, values.value.tolerance], [["flat"], 0]);
  assert.deepEqual(requestBody(), { experiment: "league", simulator: "kinematic" });
  enter("worlds", "limp-pair");
  assert.match(mistakes.value.worlds, /kinematic simulator knows no limp: choose mujoco/);
  setField("simulator", "mujoco");
  assert.deepEqual([mistakes.value, values.value.worlds], [{}, ["limp-pair"]]);
});

test("the reward along the track is asked for and told, and an experiment of the paper's has none", () => {
  chooseExperiment("league");
  enter("reward", "sideways");
  assert.ok(mistakes.value.reward);
  enter("reward", "track");
  assert.deepEqual([mistakes.value, requestBody()], [{}, { experiment: "league", reward: "track" }]);
  const config = { ...values.value, robots: [{ preset: "stiff" }] };
  assert.match(describe(makeRun({ kind: "experiment", config })), /reward along the track/);
  chooseExperiment("table1");
  assert.equal("reward" in requestBody(), false);
});

test("robots that differ by seed are tried by all agents, and greedy twice", () => {
  chooseExperiment("league");
  setField("seeds", 4);
  // Two gaits and two worlds; learner, planner, greedy, and greedy with the nominal model.
  assert.equal(trials.value, 2 * 2 * 4 * 4);
  setField("tolerance", 0);
  // Without a tolerance searchers walk once, and on flat ground the nominal model is the world.
  assert.equal(trials.value, 2 * ((4 + 2) + (4 + 3)));
  setField("worlds", ["sensor-noise:sd_m=0.004"]);
  assert.equal(trials.value, 2 * 4 * 4);
});

test("what does not learn does not recover", () => {
  chooseExperiment("league");
  setField("agents", ["learner", "planner"]);
  chooseExperiment("recovery");
  setField("agents", ["tracer", "planner"]);
  assert.match(mistakes.value.agents, /“planner” is not offered/);
  enter("agents", "tracer");
  assert.deepEqual(mistakes.value, {});
});

test("a text that was not valid is taken once another choice makes it valid", () => {
  readQuery(new URLSearchParams("experiment=recovery&agents=planner"));
  assert.match(mistakes.value.agents, /not offered/);
  chooseExperiment("league");
  assert.deepEqual([mistakes.value, values.value.agents], [{}, ["planner"]]);
  chooseExperiment("sweep");
  enter("agents", "learner");
  enter("gamma", "2");
  assert.match(mistakes.value.gamma, /under 1/);
  enter("agents", "tracer");
  assert.ok(!("gamma" in mistakes.value));
});

test("the grid has the settings of the chosen agents", () => {
  assert.deepEqual(Object.keys(agentSettings.value), []);
  chooseExperiment("sweep");
  assert.deepEqual(Object.keys(agentSettings.value), ["alpha", "gamma", "epsilon_start", "epsilon_end"]);
  setField("trace", [0.1, 0.5]);
  assert.ok(takesField("steps") && !takesField("trace"));
  assert.deepEqual(requestBody(), { experiment: "sweep" });
  setField("agents", ["tracer"]);
  assert.deepEqual(requestBody(), { experiment: "sweep", agents: ["tracer"], settings: { trace: [0.1, 0.5] } });
  assert.deepEqual([values.value.alpha, values.value.kind], [[0.1], ["replacing"]]);
  assert.equal(trials.value, 2 * (1 + 2 * 30));
  const [sent, link] = [requestBody(), query()];
  readQuery(new URLSearchParams());
  readQuery(new URLSearchParams(link));
  assert.deepEqual(requestBody(), sent);
});

test("agents with other defaults each keep their own, and count only the settings that they have", () => {
  chooseExperiment("sweep");
  setField("agents", ["learner", "tracer"]);
  assert.deepEqual(values.value.alpha, []);
  assert.equal(trials.value, 2 * (1 + 2 * 30));
  setField("trace", [0.1, 0.5, 0.9]);
  assert.equal(trials.value, 2 * (1 + 30 + 3 * 30));
  setField("alpha", [0.2]);
  assert.deepEqual(requestBody().settings, { trace: [0.1, 0.5, 0.9], alpha: [0.2] });
  setField("alpha", []);
  assert.deepEqual(requestBody().settings, { trace: [0.1, 0.5, 0.9] });
});

test("reports name settings as they are declared, and only those that differ", () => {
  assert.deepEqual(["gait", "alpha", "epsilon_end", "unknown"].map(fieldTitle),
    ["Gait", "α", "Final ε", "unknown"]);
  const rows = [{ agent: "learner", alpha: 0.3, trace: null }, { agent: "tracer", alpha: 0.3, trace: 0.9 }];
  assert.deepEqual(variedFields(rows, ["agent", "alpha", "trace"]), ["agent"]);
  const more = [...rows, { ...rows[1], trace: 0.5 }];
  assert.deepEqual(variedFields(more, ["agent", "alpha", "trace"]), ["agent", "trace"]);
});

test("progress is told with its pace", () => {
  const run = makeRun({ kind: "experiment", state: "running", progress: { done: 400, total: 1000 }, eta_s: 60 });
  assert.deepEqual(paceOf(run), { share: 0.4, label: "400 of 1000 trials", left: "10 a second, 60 s left" });
  assert.equal(paceOf({ ...run, eta_s: null }).left, "");
  assert.equal(paceOf({ ...run, state: "paused" }).left, "");
});

test("distances have the chosen unit", () => {
  const place = { half_side_m: 0.02, greedy_m: 0.5 };
  assert.equal(shown(inUnit(0.38, factorOf(place))), "0.38\u00a0m");
  unit.value = "h";
  assert.equal(shown(inUnit(0.38, factorOf(place))), "19.0\u202fh");
  unit.value = "greedy";
  assert.equal(shown(inUnit(-0.38, factorOf(place))), "\u221276\u202f%");
  assert.equal(bare(0.76), "76");
  assert.equal(shown(inUnit(0.38, factorOf({ ...place, greedy_m: null }))), "–");
});

test("settings are grouped by place, and greedy is the reference of the same gait there", () => {
  const setting = (/** @type {object} */ changes) => /** @type {Setting} */ ({
    key: "k", gait: "wave", observation: "measured", robot: "stiff", divisions: 2, grid_side_m: 0.04,
    half_side_m: 0.02, role: "learner", agent: "learner", total: null, ...changes,
  });
  const greedy = setting({ role: "reference", agent: "greedy", total: { mean_m: 0.5 } });
  const all = [greedy, setting({}), setting({ robot: "weak" }), setting({ gait: "tripod" })];
  const [stiff, weak] = placesOf(all);
  assert.deepEqual([stiff.robot, weak.robot, placesOf(all).length], ["stiff", "weak", 2]);
  const [wave, tripod] = gaitsOf(all, stiff.key);
  assert.deepEqual([wave.gait, wave.learners.length, wave.references.greedy], ["wave", 1, greedy]);
  assert.deepEqual(tripod.references, {});
  assert.deepEqual(all.map(greedyIn(all)), [greedy, greedy, null, null]);
});

test("an experiment is described by its seeds, places and simulator", () => {
  const config = {
    seeds: 30, seed: 2, observations: ["measured", "commanded"], robots: [{ preset: "stiff" }], simulator: "kinematic",
  };
  assert.equal(
    describe(makeRun({ kind: "experiment", config })),
    "30 seeds · from seed 2 · feet measured and commands remembered · stiff · ideal (no slip)",
  );
  assert.match(
    describe(makeRun({ config: { ...config, experiment: "sweep", settings: { alpha: [0.1, 0.3], gamma: [1] } } })),
    /^α 0.1, 0.3 · 30 seeds/,
  );
  const league = { ...config, experiment: "league", worlds: ["limp-pair", "limp:legs=2"], tolerance: 0.03 };
  assert.match(describe(makeRun({ config: league })),
    /^Two limp legs, Leg\u00a02 limp · 30 seeds .* build tolerance 0.03/);
});

test("a custom robot is told by what differs from its preset", () => {
  assert.equal(robotTitle({ preset: "stiff" }), "Stiff");
  assert.equal(robotTitle({ preset: "stiff", femur_m: 0.1, friction: 0.5 }),
    "Custom: stiff, femur 0.1\u00a0m, friction 0.5");
});

test("errors name fields as the form shows them", () => {
  assert.equal(inFormWords("alpha must be a number over 0 and at most 1."),
    "Learning rate α must be a number over 0 and at most 1.");
  assert.equal(inFormWords("lanes.0.training.epsilon_end must be from 0 to 1."),
    "Final exploration ε must be from 0 to 1.");
  assert.equal(inFormWords("Leg 2 cannot reach it; choose a smaller grid_side_m than 0.9."),
    "Leg 2 cannot reach it; choose a smaller Grid side than 0.9.");
  assert.equal(inFormWords("Robot.femur_m must be from 0.001 to 2, not 9."),
    "Robot, femur must be from 0.001 to 2, not 9.");
  assert.equal(inFormWords("Seeds must be from 1 to 5; 50 steps are too many."),
    "Seeds must be from 1 to 5; 50 steps are too many.");
});
