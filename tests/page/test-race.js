// The race at the moment that is shown: timeline, standings, headline.
import assert from "node:assert/strict";
import { beforeEach, test } from "node:test";
import { headline, narrative } from "../../static/js/headline.js";
import { clipped, isLoser, isTimedOut, shownTime, standings } from "../../static/js/race.js";
import { stageIds } from "../../static/js/runs.js";
import { distanceAt, timeSpent } from "../../static/js/narrative/moment.js";
import { raceInView, stepShown } from "../../static/js/on-stage.js";
import { heldRace, isMoving, openRace } from "../../static/js/raced-on.js";
import { applyEvent, options } from "../../static/js/store.js";
import { flatParts, planningModelTitle } from "../../static/js/titles.js";
import { makeRun, makeSceneLane, OPTIONS } from "./options.js";

/** @import { TimelinePoint } from "../../static/js/types.js" */

/** Thinks for a second, walks for two, thinks for one. @type {TimelinePoint[]} */
const PATH = [[0, 0], [1, 0], [3, 0.4], [4, 0.4]];

const STAGE = {
  run_id: null, next_run_id: null, phase: "empty", origin: "none", playing: true, ended: false, speed: 1,
  clock: "paper", end_at_time_out: true, announced: null,
};

const laneResult = (/** @type {string} */ agent, rank = 1, finished_distance_m = 0.3, elapsed_s = 16) => ({
  agent, steps: 50, total_distance_m: 0.5, decision_s: 5, simulated_transitions: 600,
  clocks: { paper: { rank, finished_distance_m, elapsed_s, crossed_s: null } },
});

const RACE = makeRun({
  kind: "race", progress: { done: 100, total: 100 },
  config: { steps: 50, lanes: [{ agent: "learner" }, { agent: "greedy" }] },
  result: { lanes: [laneResult("learner", 2, 0.2), laneResult("greedy", 1, 0.3, 22)] },
});

const SCENE = {
  kind: "race", clock: "paper", phase: "race", time_s: 1, duration_s: 9, computed_s: 9, time_out_s: null, ended: false,
  action_values: null, lanes: [makeSceneLane({}), makeSceneLane({ lane: 1, name: "Greedy", rank: 2 })],
};

/** Put a race on stage at a moment. */
const show = (/** @type {import("../../static/js/types.js").Run} */ race, /** @type {object} */ scene = {}) => {
  const shown = { ...SCENE, run_id: race.id, ...scene };
  const stage = { ...STAGE, run_id: race.id, phase: shown.ended ? "ended" : "showing", ended: shown.ended };
  applyEvent("snapshot", { runs: [RACE, race], stage, scene: shown });
};

/** @param {object} scene */
const showScene = (scene) => show(RACE, scene);

/** The rule by which the race on stage is ranked. */
const ruleShown = () => narrative.value.rule ?? "";

const AT_END = { phase: "finished", time_s: 22, duration_s: 22, computed_s: 22, time_out_s: 16, ended: true };

/** Put a race of these lanes on stage, at its end. */
const showResult = (
  /** @type {any[]} */ lanes, /** @type {object} */ changes = {}, /** @type {object} */ scene = {},
) => {
  const agents = ["learner", "greedy", "planner"];
  const config = { steps: 50, lanes: lanes.map((_, n) => ({ agent: agents[n] })) };
  const race = makeRun({ kind: "race", progress: { done: 99, total: 150 }, config, result: { lanes }, ...changes });
  const titles = ["Learner", "Greedy", "Planner"];
  const shown = lanes.map(({ clocks, steps, failure }, lane) => makeSceneLane({
    lane, name: titles[lane], rank: clocks.paper.rank, distance_m: 0.5, step: steps, done: true, failure,
  }));
  show(race, { ...AT_END, lanes: shown, ...scene });
};

beforeEach(() => {
  options.value = OPTIONS;
  applyEvent("snapshot", { runs: [RACE], stage: STAGE, scene: null });
});

test("a race that is not on stage is in no panel", () => {
  assert.deepEqual([shownTime.value, standings.value, headline.value, raceInView.value], [null, null, null, null]);
  applyEvent("stage", { ...STAGE, run_id: "unknown", phase: "ended" });
  assert.equal(raceInView.value, null);
});

test("distances are interpolated between the points of a path", () => {
  assert.equal(distanceAt(PATH, 0.5), 0);
  assert.equal(distanceAt(PATH, 2), 0.2);
  assert.equal(distanceAt(PATH, 99), 0.4);
  assert.equal(distanceAt([], 1), 0);
  assert.equal(distanceAt([[0, 0], [1, 0.1], [1, 0.2]], 1), 0.1);
});

test("what a search knows is told if something happens in the race, or if it was asked for", () => {
  const knownIn = (/** @type {object} */ config, /** @type {object} */ lane) => {
    const lanes = [{ agent: "greedy", plans_with: "world", plans_with_by_default: true, ...lane }];
    const race = makeRun({ ...RACE, id: "other", config: { steps: 50, lanes, ...config } });
    show(race, { lanes: [makeSceneLane({})] });
    return standings.value?.[0].plans_with;
  };
  assert.equal(knownIn({}, {}), null);
  assert.equal(knownIn({}, { plans_with: "nominal", plans_with_by_default: false }), "nominal");
  const limp = { kind: "limp", at_step: 25, legs: [1] };
  assert.equal(knownIn({ disturbances: [limp] }, { plans_with: "nominal" }), "nominal");
  assert.deepEqual(["world", "start", "nominal"].map(planningModelTitle),
    ["true model", "model of the start", "nominal model"]);
});

test("a path is cut at the moment that is shown", () => {
  assert.deepEqual(clipped(PATH, 2), [[0, 0], [1, 0], [2, 0.2]]);
  assert.deepEqual(clipped(PATH, 10), PATH);
  assert.deepEqual(clipped(PATH, -1), [[0, 0]]);
});

test("time is spent thinking or walking", () => {
  const lane = { thinking: /** @type {[number, number][]} */ ([[0, 1], [3, 4]]), total_s: 4 };
  assert.deepEqual(timeSpent(lane, 2), { thought: 1, walked: 1 });
  assert.deepEqual(timeSpent(lane, 3.5), { thought: 1.5, walked: 2 });
  assert.deepEqual(timeSpent(lane, Infinity), { thought: 2, walked: 2 });
});

test("after its show a race has its result, ranked", () => {
  showResult(RACE.result?.lanes ?? []);
  assert.equal(shownTime.value, 22);
  assert.ok(isTimedOut.value);
  const [first, second] = standings.value ?? [];
  assert.deepEqual([first.title, first.rank, first.finished_m], ["Greedy", 1, 0.3]);
  assert.deepEqual([second.title, second.total_m, second.decision_s, second.simulated], ["Learner", 0.5, 0.1, 600]);
  assert.equal(headline.value, "Greedy wins by 10\u00a0cm");
  assert.equal(ruleShown(), "Ranked at time-out, when Learner had used its 50 steps (paper clock).");
});

test("the headline says who won, and the rule what decided it", () => {
  showResult([laneResult("learner", 2, 0.2), laneResult("greedy", 1, 0.37)]);
  assert.deepEqual([headline.value, ruleShown()],
    ["Greedy wins by 17\u00a0cm", "Ranked at time-out, after 50 steps each (paper clock)."]);
  showResult([laneResult("learner", 2, 0.2), laneResult("greedy", 1, 0.37), laneResult("planner", 3, 0.1, 90)]);
  assert.equal(headline.value, "Greedy wins by 17\u00a0cm");
  assert.match(ruleShown(), /, when Greedy and Learner had used their 50 steps \(paper clock\)\.$/);
  showResult([laneResult("learner", 1, 0.37)]);
  assert.equal(headline.value, "Learner wins with 0.37\u00a0m", "there is no other to be ahead of");
});

test("ties and narrow margins are told", () => {
  showResult([laneResult("learner", 1, 0.3), laneResult("greedy", 1, 0.3, 22), laneResult("planner", 3, 0.1, 90)]);
  assert.equal(headline.value, "Learner and Greedy tie");
  showResult([laneResult("learner", 2, 0.302), laneResult("greedy", 1, 0.304, 22)]);
  assert.equal(headline.value, "Greedy wins by 2\u00a0mm");
});

test("a lane that failed does not time the race out, and no time-out is claimed without one", () => {
  const failed = { ...laneResult("learner", 1, 0.4, 3), steps: 9, failure: "it broke" };
  showResult([failed, laneResult("greedy", 2, 0.3, 22)]);
  assert.equal(headline.value, "Learner wins, stopped at step 9");
  assert.match(ruleShown(), /when Greedy had used its 50 steps/);
  showResult([failed, failed], { state: "failed" }, { time_out_s: null });
  assert.equal(headline.value, "Failed at step 9 of 50: Learner and Greedy had come farthest, 0.50\u00a0m");
  assert.ok(!isTimedOut.value);
});

test("a race that was stopped says so at its last step, without ranks and without a time-out", () => {
  const lanes = [
    makeSceneLane({ distance_m: 0.1, step: 26, rank: 2, halted: true }),
    makeSceneLane({ lane: 1, name: "Greedy", distance_m: 0.31, step: 25, halted: true }),
  ];
  const result = { lanes: RACE.result?.lanes?.map((lane) => ({ ...lane, steps: 26, total_distance_m: null })) };
  const race = makeRun({ ...RACE, id: "stopped", state: "stopped", result });
  show(race, { ...AT_END, lanes, time_out_s: null });

  assert.equal(headline.value, "Stopped at steps 25 to 26 of 50: Greedy had come farthest, 0.31\u00a0m");
  assert.equal(ruleShown(), "No ranking: the race was stopped before its time-out (paper clock).");
  assert.deepEqual((standings.value ?? []).map(({ agent, rank, isDone, isHalted, step, finished_m, total_m }) =>
    [agent, rank, isDone, isHalted, step, finished_m, total_m]), [
    ["greedy", null, false, true, 25, null, null], ["learner", null, false, true, 26, null, null],
  ]);
  show(makeRun({ ...race, state: "interrupted" }), { ...AT_END, lanes, time_out_s: null });
  assert.match(headline.value ?? "", /^Interrupted at steps 25 to 26 of 50/);
  show(race, { lanes, time_s: 3 });
  assert.equal(headline.value, "Stopped at steps 25 to 26 of 50", "nobody leads while robots stand still");
  assert.deepEqual([narrative.value.reason, (standings.value ?? []).map(({ rank }) => rank)], [null, [null, null]]);
  show(race, { lanes: lanes.map((lane) => ({ ...lane, halted: false })), time_s: 3 });
  assert.equal(headline.value, "Greedy leads by 21\u00a0cm", "on its way there");
});

test("at the photo finish lanes that walk on have their totals once the race has finished", () => {
  const lanes = [
    makeSceneLane({ distance_m: 0.2, step: 50, rank: 2, done: true }),
    makeSceneLane({ lane: 1, distance_m: 0.3, step: 40 }),
  ];
  show(RACE, { ...AT_END, phase: "photo-finish", time_s: 16, lanes });
  assert.deepEqual(standings.value?.map(({ finished_m, total_m }) => [finished_m, total_m]), [[0.3, 0.5], [0.2, 0.5]]);
  show(RACE, { phase: "photo-finish", time_s: 16, time_out_s: 16, lanes });
  assert.deepEqual(standings.value?.map(({ finished_m, total_m }) => [finished_m, total_m]), [[0.3, null], [0.2, 0.5]]);
});

test("what flat parts are is said without contradiction under each clock", () => {
  assert.deepEqual(["paper", "wall", "free"].map((clock) => /^Flat parts are thinking/.test(flatParts(clock))),
    [true, true, false]);
});

test("before time-out the rule says how the race will be ranked", () => {
  showScene({ phase: "race", time_s: 1 });
  assert.equal(ruleShown(),
    "The farthest at time-out wins: when the first robot has used its 50 steps (paper clock).");
});

test("during its show nothing later than the scene is told", () => {
  showScene({
    phase: "race", time_s: 1,
    lanes: [makeSceneLane({ distance_m: 0.1, step: 5 }), makeSceneLane({ lane: 1, name: "Greedy", rank: 2 })],
  });
  assert.ok(!isTimedOut.value);
  const [first] = standings.value ?? [];
  assert.deepEqual([first.agent, first.finished_m, first.total_m, first.simulated], ["learner", null, null, null]);
  assert.equal(headline.value, "Learner leads by 10\u00a0cm");
});

test("before the first step everyone is on the start line, and equal ranks are level", () => {
  showScene({ phase: "race", time_s: 0, lanes: [makeSceneLane({}), makeSceneLane({ lane: 1 })] });
  assert.equal(headline.value, "On the start line");
  showScene({
    phase: "race", time_s: 1, lanes: [makeSceneLane({ distance_m: 0.1 }), makeSceneLane({ lane: 1, distance_m: 0.1 })],
  });
  assert.equal(headline.value, "Learner and Learner are level");
});

test("only long decisions are shown as thinking", () => {
  const thinking = { thinking: true, futures: 3 };
  showScene({
    phase: "race", time_s: 1,
    lanes: [12, 156].map((futures_total, lane) => makeSceneLane({ ...thinking, lane, futures_total })),
  });
  assert.deepEqual((standings.value ?? []).map(({ isThinking }) => isThinking), [false, true]);
});

test("a race that branches off has the original's distances beside its own", () => {
  const branch_from = { race_id: RACE.id, step: 20 };
  const disturbances = [{ kind: "limp", at_step: 20, legs: [1] }];
  const config = { ...RACE.config, branch_from, disturbances };
  const race = makeRun({ ...RACE, id: "branch", created_at: "2031-01-01T00:00:00Z", config });
  show(race, { ...AT_END, lanes: [makeSceneLane({ rank: 2, done: true }), makeSceneLane({ lane: 1, done: true })] });
  const originals = (standings.value ?? []).map(({ agent, original }) => [agent, original]);
  assert.deepEqual(originals, [
    ["greedy", { finished_m: 0.3, total_m: 0.5 }], ["learner", { finished_m: 0.2, total_m: 0.5 }],
  ]);
  assert.deepEqual(stageIds.value, ["branch", RACE.id]);
  show(RACE);
  assert.equal(standings.value?.[0].original, null);
});

test("a fall is told once it is shown, and the heading at the end", () => {
  const lane = { ...laneResult("learner"), fell_at_step: 7, heading_deg: 35 };
  const race = makeRun({ ...RACE, id: "fall", result: { lanes: [lane, laneResult("greedy", 2)] } });
  const postureAt = (/** @type {number} */ step) => {
    show(race, { lanes: [makeSceneLane({ step, done: step === 50 }), makeSceneLane({ lane: 1, rank: 2 })] });
    const [{ fell_at_step, heading_deg }] = standings.value ?? [];
    return [fell_at_step, heading_deg];
  };
  assert.deepEqual([postureAt(8), postureAt(9), postureAt(50)], [[null, null], [7, null], [7, 35]]);
});

test("a race can be raced on from the step that is shown, whether its picture plays or is held", () => {
  const lanes = [makeSceneLane({ step: 50, done: true }), makeSceneLane({ lane: 1, step: 12 })];
  showScene({ phase: "race", time_s: 1, lanes, playing: true });
  assert.deepEqual([heldRace.value, stepShown.value], [null, 12]);
  assert.deepEqual([openRace.value?.id, isMoving.value], [RACE.id, true]);
  applyEvent("stage", { ...STAGE, run_id: RACE.id, phase: "showing", playing: false });
  assert.deepEqual([heldRace.value], [null], "its figures are not those of the moment yet");
  showScene({ phase: "race", time_s: 1, lanes, playing: false });
  assert.deepEqual([heldRace.value?.id, openRace.value?.id, isMoving.value], [RACE.id, RACE.id, false]);
  showScene({ ...AT_END, lanes: lanes.map((lane) => ({ ...lane, done: true })) });
  assert.deepEqual([heldRace.value?.id, stepShown.value], [RACE.id, null]);
});

test("it is asked why a learner loses once the lanes are compared, and of no other", () => {
  showScene({ time_s: 3, lanes: [makeSceneLane({ step: 3, distance_m: 0.1 }), SCENE.lanes[1]] });
  assert.deepEqual([0, 1].map(isLoser), [false, false]);
  showResult([laneResult("learner", 2, 0.2), laneResult("greedy", 1, 0.3)]);
  assert.deepEqual([0, 1].map(isLoser), [true, false]);
  showResult([laneResult("learner", 1, 0.3), laneResult("greedy", 2, 0.2)]);
  assert.deepEqual([0, 1, 7].map(isLoser), [false, false, false]);
});
