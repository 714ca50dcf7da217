// The form of experiments, its address, trial counts, units and places.
import assert from "node:assert/strict";
import { beforeEach, test } from "node:test";
import {
  bare, factorOf, gaitsOf, greedyTotals, inUnit, placesOf, shown, unit,
} from "../../static/js/experiments/distances.js";
import {
  agentSettings, chooseExperiment, chosenExperiment, parse, readQuery, requestBody, setField, takesField, toQuery,
  trials, values,
} from "../../static/js/experiments/form.js";
import { paceOf } from "../../static/js/experiments/runs.js";
import { options } from "../../static/js/store.js";
import { describeRun, fieldTitle, variedFields } from "../../static/js/titles.js";
import { makeRun, OPTIONS } from "./options.js";

/** @import { Setting } from "../../static/js/types.js" */

const query = () => new URLSearchParams(toQuery()).toString();

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
  assert.deepEqual(requestBody(), { experiment: "sweep", alpha: [0.1, 0.3] });
  setField("alpha", [0.3]);
  assert.deepEqual(requestBody(), { experiment: "sweep" });
});

test("fields that the chosen experiment does not take are kept but not sent", () => {
  chooseExperiment("sweep");
  setField("alpha", [0.1]);
  chooseExperiment("table1");
  assert.deepEqual(requestBody(), { experiment: "table1" });
  chooseExperiment("sweep");
  assert.deepEqual(requestBody(), { experiment: "sweep", alpha: [0.1] });
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

test("values have the type of the default; others are skipped", () => {
  assert.deepEqual(parse("0.1,0.3", [1]), [0.1, 0.3]);
  assert.deepEqual(parse("a,b", ["c"]), ["a", "b"]);
  assert.equal(parse("12", 1), 12);
  assert.equal(parse("1.5", 1), undefined);
  assert.equal(parse("0.1,oops", [1]), undefined);
  assert.equal(parse(",", ["c"]), undefined);
  readQuery(new URLSearchParams("experiment=unknown&seeds=many&blocks=3"));
  assert.deepEqual(requestBody(), { experiment: "table1" });
});

test("trials are counted before they are started", () => {
  // Two gaits, each with two references, two lengths of practice and a race that measures.
  setField("seeds", 3);
  assert.equal(trials.value, 2 * (2 + 2 * 3 + 1));
  chooseExperiment("sweep");
  setField("alpha", [0.1, 0.3, 0.6]);
  assert.equal(trials.value, 2 * (1 + 3 * 3));
  setField("agents", ["learner", "greedy", "planner"]);
  assert.equal(trials.value, 2 * (1 + 1 + 3 * 3));
});

test("the grid has the settings of the chosen agents", () => {
  assert.deepEqual(Object.keys(agentSettings.value), []);
  chooseExperiment("sweep");
  assert.deepEqual(Object.keys(agentSettings.value), ["alpha", "gamma", "epsilon_start", "epsilon_end"]);
  setField("trace", [0.1, 0.5]);
  assert.ok(takesField("steps") && !takesField("trace"));
  assert.deepEqual(requestBody(), { experiment: "sweep" });
  setField("agents", ["tracer"]);
  assert.deepEqual(requestBody(), { experiment: "sweep", agents: ["tracer"], trace: [0.1, 0.5] });
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
  assert.deepEqual(requestBody().alpha, [0.2]);
  setField("alpha", []);
  assert.ok(!("alpha" in requestBody()));
});

test("reports name settings as they are declared, and only those that differ", () => {
  assert.deepEqual(["gait", "alpha", "epsilon_end", "unknown"].map(fieldTitle),
    ["Gait", "α", "ε, last episode", "unknown"]);
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
  assert.deepEqual(all.map(greedyTotals(all)), [0.5, 0.5, null, null]);
});

test("an experiment is described by its seeds, places and simulator", () => {
  const config = {
    seeds: 30, seed: 2, observations: ["measured", "commanded"], robots: [{ preset: "stiff" }], simulator: "kinematic",
  };
  assert.equal(
    describeRun(makeRun({ kind: "experiment", config })),
    "30 seeds · from seed 2 · feet measured and commands remembered · stiff · ideal (no slip)",
  );
  assert.match(
    describeRun(makeRun({ config: { ...config, experiment: "sweep", alpha: [0.1, 0.3], gamma: [1] } })),
    /^α 0.1, 0.3 · 30 seeds/,
  );
});
