// The form, its address, and the requests that it makes.
import assert from "node:assert/strict";
import { beforeEach, test } from "node:test";
import {
  chooseLearner, chooseRobot, enter, form, isReadOnly, mistakes, offerLearner, openForm, raceBody, setField, setFields,
  stageTexts, trainingBody, tryOwnSettings, wrong,
} from "../../static/js/form.js";
import { ignored, page } from "../../static/js/page-state.js";
import { isPreset } from "../../static/js/settings.js";
import { options, role } from "../../static/js/store.js";
import { OPTIONS } from "./options.js";

/** The form's texts, as a link has them. */
const inLink = () => page.form.value;
/** Open a link with these. @param {string | URLSearchParams} query */
function open(query) {
  page.form.value = new URLSearchParams(query);
  ignored.query.value = [];
  openForm();
}

beforeEach(() => {
  options.value = OPTIONS;
  open("");
});

test("the form begins with the server's defaults and nothing else", () => {
  const { disturbances: _, settings, ...training } = OPTIONS.defaults.training;
  const lanes = { lanes: ["learner", "greedy"], "learner.keep_learning": false };
  const greedy = { "greedy.plans_with": null, "greedy.observation": "measured" };
  assert.deepEqual(form.value,
    { ...training, ...settings, world: "flat", disturb: [], race_steps: 50, ...lanes, ...greedy, name: "" });
});

test("a robot brings the gait that suits it, unless another one was chosen that its legs can have", () => {
  const [stiff, dog] = OPTIONS.robots;
  chooseRobot(dog.name);
  assert.deepEqual([form.value.robot, form.value.gait], ["dog", dog.gait]);
  chooseRobot(stiff.name);
  assert.equal(form.value.gait, "tripod", "its legs cannot have the groups of the other");
  setField("gait", "wave");
  chooseRobot(dog.name);
  assert.equal(form.value.gait, "wave");
  chooseRobot(/** @type {any} */ ({ preset: "dog", friction: 0.3 }));
  assert.equal(form.value.gait, "wave", "what a robot of one's own can have is told by the server");
});

test("a learner is offered for a body, and the server's default for the next one that stands", () => {
  offerLearner("tracer");
  assert.equal(form.value.agent, "tracer");
  assert.equal(String(inLink()), "agent=tracer", "the link is that of the same learner");
  offerLearner(null);
  assert.equal(form.value.agent, OPTIONS.defaults.training.agent);
  offerLearner("greedy");
  assert.equal(form.value.agent, OPTIONS.defaults.training.agent, "that learns nothing");
});

test("a learner that a person or a link has chosen is never replaced", () => {
  chooseLearner(OPTIONS.defaults.training.agent);
  offerLearner("tracer");
  assert.equal(form.value.agent, OPTIONS.defaults.training.agent);

  open("agent=tracer");
  offerLearner(null);
  assert.equal(form.value.agent, "tracer");
});

test("no learner is offered to a spectator, nor where a feature presets the form", () => {
  role.value = "spectator";
  offerLearner("tracer");
  assert.equal(page.form.value.has("agent"), false);
  role.value = "operator";
  isPreset.value = true;
  offerLearner("tracer");
  isPreset.value = false;
  assert.equal(page.form.value.has("agent"), false);
});

test("a link has what was changed, and is clean again when the form is", () => {
  setField("alpha", 0.7);
  assert.equal(String(inLink()), "alpha=0.7");
  setField("alpha", OPTIONS.defaults.training.settings.alpha);
  assert.equal(String(inLink()), "");
});

test("a form read from its own query is the same form", () => {
  const changes = {
    agent: "tracer", trace: 0.5, kind: "adding", gait: "wave", pace: 2, lanes: ["greedy"], name: "A & B",
  };
  setFields(changes);
  const [before, query] = [form.value, String(inLink())];
  open("");
  open(query);
  assert.deepEqual(form.value, before);
  assert.deepEqual({ ...before, ...changes }, before);
  setField("pace", "max");
  assert.ok(!inLink().has("pace"));
});

test("what is not valid in an address is kept as it is, explained, and stays in the address", () => {
  open("alpha=seven&steps=&gamma=0.5&pace=fast&agent=greedy&gait=nonsense&robot=tank&lanes=greedy,ghost&seed=-5");
  assert.equal(form.value.gamma, 0.5);
  const texts = Object.fromEntries(Object.entries(wrong.value).map(([field, { text }]) => [field, text]));
  const expected = {
    alpha: "seven", steps: "", pace: "fast", agent: "greedy", gait: "nonsense", robot: "tank", lanes: "greedy,ghost",
    seed: "-5",
  };
  assert.deepEqual(texts, expected);
  assert.ok(Object.values(mistakes.value).every((mistake) => mistake.length > 0));
  setField("name", "another field");
  const query = inLink();
  assert.deepEqual(Object.fromEntries(Object.keys(expected).map((field) => [field, query.get(field)])), expected);
  setFields({ gait: "wave", robot: "stiff" });
  assert.ok(!("gait" in mistakes.value) && !("robot" in mistakes.value) && "alpha" in mistakes.value);
});

test("fields of an address that the form does not have are left out", () => {
  open("unknown=1&trace=0.5");
  assert.ok(!("unknown" in form.value) && !("trace" in form.value));
  assert.deepEqual(mistakes.value, {});
});

test("a link to a single setting sets it alone", () => {
  open("alpha=0.5");
  assert.equal(String(inLink()), "alpha=0.5");
  assert.equal(form.value.alpha, 0.5);
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

test("a value that the chosen learner cannot read is explained, and its default stands until then", () => {
  setFields({ agent: "tracer", kind: 3, trace: "often" });
  assert.deepEqual([form.value.kind, form.value.trace], ["replacing", 0.9]);
  assert.deepEqual(Object.keys(mistakes.value).sort(), ["kind", "trace"]);
  assert.equal(wrong.value.trace.text, "often");
  chooseLearner("learner");
  assert.deepEqual(mistakes.value, {});
});

test("settings of the other learners of a race are checked too", () => {
  setFields({ lanes: ["learner", "tracer"], trace: 7 });
  assert.match(mistakes.value.trace, /from 0 to 1/);
  assert.equal(inLink().get("trace"), "7");
  setField("lanes", ["learner"]);
  assert.deepEqual(mistakes.value, {});
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

test("what was typed is kept as it is until it is valid; the value stays the last valid one", () => {
  enter("alpha", "0,7");
  assert.equal(form.value.alpha, 0.7);
  enter("alpha", "7 ");
  assert.deepEqual([form.value.alpha, wrong.value.alpha.text], [0.7, "7 "]);
  assert.match(mistakes.value.alpha, /over 0 and at most 1/);
  assert.equal(inLink().get("alpha"), "7 ");
  enter("alpha", "0.5");
  assert.deepEqual([form.value.alpha, mistakes.value], [0.5, {}]);
  enter("lanes", "");
  assert.match(mistakes.value.lanes, /from 1 to 6/);
  enter("name", "x".repeat(21));
  assert.match(mistakes.value.name, /at most 20/);
});

test("a custom robot and a custom gait are kept whole, also by a link", () => {
  const robot = { preset: "stiff", femur_m: 0.1, legs: [{ azimuth_deg: 0, radius_m: 0.1 }] };
  const gait = { right_leg: 1, left_leg: 4, symmetry: "origin" };
  setFields({ robot, gait });
  open(inLink());
  assert.deepEqual([form.value.robot, form.value.gait], [robot, gait]);
  assert.deepEqual([trainingBody().robot, trainingBody().gait], [robot, gait]);
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
    agent: "learner", gait: "tripod", robot: "stiff", simulator: "mujoco", divisions: 2, grid_side_m: 0.04,
    tolerance: 0, reward: "forward", steps: 500,
    seed: 0, observation: "measured", settings: { alpha: 0.3, gamma: 0.5, epsilon_start: 1, epsilon_end: 0 },
    steps_per_episode: 50, evaluate_every: 50, pace: "max",
  });
  chooseLearner("tracer");
  const { settings, ...rest } = trainingBody();
  assert.deepEqual(settings, { alpha: 0.1, trace: 0.9, kind: "replacing" });
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
  const practices = () => lanesOf().map(({ training }) => /** @type {any} */ (training?.settings));
  const [learner, tracer] = practices();
  assert.deepEqual([learner?.alpha, learner?.gamma, learner?.trace], [0.3, 0.8, undefined]);
  assert.deepEqual([tracer?.alpha, tracer?.gamma, tracer?.trace], [0.1, undefined, 0.5]);
  open(inLink());
  assert.deepEqual(practices(), [learner, tracer]);
});

test("what a link says that is no field is told, until another link is read", () => {
  open("alhpa=0.5&alpha=0.4");
  assert.deepEqual(ignored.query.value, ["alhpa=0.5"]);
  assert.equal(form.value.alpha, 0.4);
  open("alpha=0.4");
  assert.deepEqual(ignored.query.value, []);
});

test("a lane has its agent's settings, in the form, in the address and in the request", () => {
  setFields({ lanes: ["tracer", "planner", "greedy"] });
  assert.equal(form.value["planner.depth"], 3);
  assert.deepEqual(raceBody().lanes.slice(1), [{ agent: "planner", settings: { depth: 3 } }, { agent: "greedy" }]);
  enter("planner.depth", "2");
  enter("tracer.keep_learning", "false");
  const query = inLink();
  assert.equal(query.get("planner.depth"), "2");
  open(inLink());
  const [tracer, planner] = /** @type {any[]} */ (raceBody().lanes);
  assert.deepEqual(planner, { agent: "planner", settings: { depth: 2 } });
  assert.equal(tracer.keep_learning, false);
  assert.ok(!Object.keys({ ...tracer.training, ...trainingBody() }).some((name) => name.includes(".")));
  assert.deepEqual(ignored.query.value, []);
});

test("a lane that keeps learning as its agent does by default does not say so", () => {
  setFields({ lanes: ["tracer", "learner"] });
  assert.deepEqual(raceBody().lanes.map((lane) => "keep_learning" in lane), [false, false]);
  setField("learner.keep_learning", true);
  assert.deepEqual(raceBody().lanes.map((lane) => /** @type {any} */ (lane).keep_learning), [undefined, true]);
});

test("a lane's setting that is not valid is kept as it is, and holds the start", () => {
  setFields({ lanes: ["planner"] });
  enter("planner.depth", "9");
  assert.deepEqual(mistakes.value, { "planner.depth": "Must be from 1 to 5" });
  assert.equal(form.value["planner.depth"], 3);
  setFields({ lanes: ["greedy"] });
  assert.deepEqual(mistakes.value, {});
});

test("a learner that keeps learning may begin in the race, with its settings in the lane", () => {
  setFields({ lanes: ["learner"], "learner.keep_learning": true, gamma: 0.5 });
  const settings = { alpha: 0.3, gamma: 0.5, epsilon_start: 1, epsilon_end: 0 };
  assert.deepEqual(raceBody({ isUnpractised: true }).lanes,
    [{ agent: "learner", keep_learning: true, observation: "measured", settings }]);
});

test("a learner that begins in the race reads its state as it would in its practice", () => {
  setFields({ lanes: ["tracer", "greedy"], observation: "commanded" });
  const [tracer, greedy] = /** @type {any[]} */ (raceBody({ isUnpractised: true }).lanes);
  assert.equal(tracer.observation, "commanded");
  assert.deepEqual(greedy, { agent: "greedy" });
  const [practised] = /** @type {any[]} */ (raceBody().lanes);
  assert.deepEqual([practised.observation, practised.training.observation], [undefined, "commanded"]);
});

test("a search reads its state as its lane says, in the link and in the request", () => {
  enter("greedy.observation", "commanded");
  const lane = { agent: "greedy", observation: "commanded" };
  assert.deepEqual(raceBody().lanes[1], lane);
  open(inLink());
  assert.deepEqual([raceBody().lanes[1], form.value.observation], [lane, "measured"]);
  assert.deepEqual(ignored.query.value, []);
  enter("greedy.observation", "felt");
  assert.match(mistakes.value["greedy.observation"], /“felt” is not valid/);
});

test("a world and what happens are in the link, one by one, and in the requests", () => {
  setFields({ world: "limp-pair", disturb: ["slope:degrees=8:at=25", "limp:legs=2"] });
  const query = inLink();
  assert.equal(query.get("world"), "limp-pair");
  assert.deepEqual(query.getAll("disturb"), ["slope:degrees=8:at=25", "limp:legs=2"]);
  open(inLink());
  const happens = {
    world: "limp-pair",
    disturbances: [{ kind: "slope", degrees: 8, at_step: 25 }, { kind: "limp", legs: [2], at_step: 0 }],
  };
  for (const { world, disturbances } of /** @type {any[]} */ ([trainingBody(), raceBody()])) {
    assert.deepEqual({ world, disturbances }, happens);
  }
  const [{ training }] = /** @type {any[]} */ (raceBody().lanes);
  assert.ok(!["world", "disturb", "disturbances"].some((field) => field in training));
  setFields({ world: "flat", disturb: [] });
  assert.equal(String(inLink()), "");
  assert.ok(!("world" in trainingBody()) && !("disturbances" in trainingBody()));
});

test("what cannot happen is kept in the link as it is, explained, and holds the start", () => {
  open("disturb=limp:legs=1&disturb=fire:legs=2&world=moon");
  assert.match(mistakes.value.disturb, /“fire” is nothing that can happen/);
  assert.match(mistakes.value.world, /“moon” is not offered/);
  setField("name", "another field");
  const query = inLink();
  assert.deepEqual([query.getAll("disturb"), query.get("world")], [["limp:legs=1", "fire:legs=2"], "moon"]);
  setFields({ disturb: ["limp:legs=1"], world: "limp-pair", simulator: "kinematic" });
  assert.match(mistakes.value.disturb, /The kinematic simulator knows no limp: choose mujoco/);
  assert.match(mistakes.value.world, /knows no limp/);
  setFields({ disturb: ["sensor-noise:sd_m=0.004"], world: "flat" });
  assert.deepEqual(mistakes.value, {});
});

test("a search plans with what it is told to, and by default is told nothing", () => {
  assert.deepEqual(raceBody().lanes[1], { agent: "greedy" });
  enter("greedy.plans_with", "nominal");
  assert.deepEqual(raceBody().lanes[1], { agent: "greedy", plans_with: "nominal" });
  open(inLink());
  assert.equal(form.value["greedy.plans_with"], "nominal");
  enter("greedy.plans_with", "hope");
  assert.match(mistakes.value["greedy.plans_with"], /“hope” is not valid/);
  enter("greedy.plans_with", "");
  assert.deepEqual([form.value["greedy.plans_with"], mistakes.value], [null, {}]);
});

test("what a spectator reads is not in the link; what they try is, even where it is the default", () => {
  role.value = "spectator";
  setFields({ alpha: 0.7, gamma: 0.9 });
  assert.deepEqual([isReadOnly.value, form.value.alpha, String(inLink())], [true, 0.7, ""]);
  tryOwnSettings();
  assert.deepEqual([isReadOnly.value, inLink().get("alpha"), inLink().get("gamma")], [false, "0.7", "0.9"]);
  setField("alpha", 0.3);
  assert.deepEqual([isReadOnly.value, form.value.alpha], [false, 0.3]);
  open("");
  assert.deepEqual([isReadOnly.value, form.value.alpha], [true, 0.7], "back to those on stage");
  role.value = "operator";
  stageTexts.value = new URLSearchParams();
});

test("a whole form in a link of an earlier version leaves another learner its own defaults", () => {
  open("agent=learner&gait=tripod&steps=500&alpha=0.3&gamma=0.5&lanes=learner,greedy&learner.keep_learning=false");
  assert.equal(String(inLink()), "gamma=0.5");
  chooseLearner("tracer");
  assert.deepEqual([form.value.alpha, form.value.lanes], [0.1, ["tracer", "greedy"]]);
});
