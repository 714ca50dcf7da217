// The race at the moment that is shown: timeline, standings, headline.
import assert from "node:assert/strict";
import { beforeEach, test } from "node:test";
import {
  clipped, distanceAt, headline, isTimedOut, ruleOf, shownTime, standings, timeSpent,
} from "../../static/js/race.js";
import { stageIds } from "../../static/js/runs.js";
import { heldRace, stepShown } from "../../static/js/selectors.js";
import { applyEvent, options } from "../../static/js/store.js";
import { flatParts, planningModelTitle } from "../../static/js/titles.js";
import { makeRun, OPTIONS } from "./options.js";

/** @import { TimelinePoint } from "../../static/js/types.js" */

/** Thinks for a second, walks for two, thinks for one. @type {TimelinePoint[]} */
const PATH = [[0, 0], [1, 0], [3, 0.4], [4, 0.4]];

const STAGE = { run_id: null, next_run_id: null, playing: true, speed: 1, clock: "paper" };

const laneResult = (/** @type {string} */ agent, rank = 1, finished_distance_m = 0.3, elapsed_s = 16) => ({
  agent, steps: 50, total_distance_m: 0.5, decision_s: 5, simulated_transitions: 600,
  clocks: { paper: { rank, finished_distance_m, elapsed_s, crossed_s: null } },
});

/** Puts a race of these lanes on the page, after its show. */
const showResult = (/** @type {object[]} */ lanes, /** @type {object} */ changes = {}) => {
  const config = { steps: 50, lanes: lanes.map((_, n) => ({ agent: ["learner", "greedy", "planner"][n] })) };
  const race = makeRun({ kind: "race", progress: { done: 99, total: 150 }, config, result: { lanes }, ...changes });
  applyEvent("snapshot", { runs: [race], stage: STAGE, scene: null });
};

const RACE = makeRun({
  kind: "race", progress: { done: 100, total: 100 },
  config: { steps: 50, lanes: [{ agent: "learner" }, { agent: "greedy" }] },
  result: { lanes: [laneResult("learner", 2, 0.2), laneResult("greedy", 1, 0.3, 22)] },
});

const sceneLane = (/** @type {object} */ changes) => ({
  lane: 0, name: "Learner", color: "#111", rank: 1, distance_m: 0, step: 0, steps: 50, done: false, thinking: false,
  futures: 0, futures_total: 0, crossed: false, marching: false, ...changes,
});

/** @param {{ phase: string, time_s: number, lanes: object[] }} scene */
const showScene = (scene) => {
  applyEvent("stage", { ...STAGE, run_id: RACE.id });
  applyEvent("scene", { run_id: RACE.id, kind: "race", clock: "paper", duration_s: 9, action_values: null, ...scene });
};

beforeEach(() => {
  options.value = OPTIONS;
  applyEvent("snapshot", { runs: [RACE], stage: STAGE, scene: null });
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
    applyEvent("snapshot", { runs: [race], stage: STAGE, scene: null });
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
  assert.equal(shownTime.value, Infinity);
  assert.ok(isTimedOut.value);
  const [first, second] = standings.value ?? [];
  assert.deepEqual([first.title, first.rank, first.finished_m], ["Greedy", 1, 0.3]);
  assert.deepEqual([second.title, second.total_m, second.decision_s, second.simulated], ["Learner", 0.5, 0.1, 600]);
  assert.equal(headline.value, "Greedy wins: 0.30\u00a0m when Learner had used its 50 steps");
});

test("the headline says who won and what decided it", () => {
  showResult([laneResult("learner", 1, 0.37), laneResult("greedy", 2, 0.2, 22)]);
  assert.equal(headline.value, "Learner wins: 0.37\u00a0m when it had used its 50 steps");
  showResult([laneResult("learner", 2, 0.2), laneResult("greedy", 1, 0.37)]);
  assert.equal(headline.value, "Greedy wins: 0.37\u00a0m after 50 steps each");
  showResult([laneResult("learner", 2, 0.2), laneResult("greedy", 1, 0.37), laneResult("planner", 3, 0.1, 90)]);
  assert.equal(headline.value, "Greedy wins: 0.37\u00a0m when Greedy and Learner had used their 50 steps");
});

test("ties and narrow margins are told", () => {
  showResult([laneResult("learner", 1, 0.3), laneResult("greedy", 1, 0.3, 22), laneResult("planner", 3, 0.1, 90)]);
  assert.equal(headline.value, "Learner and Greedy tie: 0.30\u00a0m when Learner had used its 50 steps");
  showResult([laneResult("learner", 2, 0.302), laneResult("greedy", 1, 0.304, 22)]);
  assert.equal(headline.value, "Greedy wins by 2 mm: 0.30\u00a0m when Learner had used its 50 steps");
});

test("a lane that failed does not time the race out, and no time-out is claimed without one", () => {
  const failed = { ...laneResult("learner", 1, 0.4, 3), steps: 9, failure: "it broke" };
  showResult([failed, laneResult("greedy", 2, 0.3, 22)]);
  assert.equal(headline.value, "Learner wins, stopped at step 9: 0.40\u00a0m when Greedy had used its 50 steps");
  showResult([failed, { ...failed, clocks: laneResult("greedy", 2, 0.1).clocks }]);
  assert.equal(headline.value, "Learner got farthest, 0.40\u00a0m: no robot used its 50 steps");
  assert.ok(!isTimedOut.value);
  showResult([failed, failed], { state: "stopped", result: null });
  assert.equal(headline.value, null, "before its timeline is loaded");
});

test("what flat parts are is said without contradiction under each clock", () => {
  assert.deepEqual(["paper", "wall", "free"].map((clock) => /^Flat parts are thinking/.test(flatParts(clock))),
    [true, true, false]);
  assert.match(ruleOf(50, "paper clock"), /^The farthest at time-out wins: .* 50 steps \(paper clock\)\.$/);
});

test("during its show nothing later than the scene is told", () => {
  showScene({
    phase: "race", time_s: 1,
    lanes: [sceneLane({ distance_m: 0.1, step: 5 }), sceneLane({ lane: 1, name: "Greedy", rank: 2 })],
  });
  assert.ok(!isTimedOut.value);
  const [first] = standings.value ?? [];
  assert.deepEqual([first.agent, first.finished_m, first.total_m, first.simulated], ["learner", null, null, null]);
  assert.equal(headline.value, "Learner leads with 0.10\u00a0m");
});

test("before the first step everyone is on the start line, and equal ranks are level", () => {
  showScene({ phase: "race", time_s: 0, lanes: [sceneLane({}), sceneLane({ lane: 1 })] });
  assert.equal(headline.value, "On the start line");
  showScene({
    phase: "race", time_s: 1, lanes: [sceneLane({ distance_m: 0.1 }), sceneLane({ lane: 1, distance_m: 0.1 })],
  });
  assert.equal(headline.value, "Level");
});

test("only long decisions are shown as thinking", () => {
  const thinking = { thinking: true, futures: 3 };
  showScene({
    phase: "race", time_s: 1,
    lanes: [sceneLane({ ...thinking, futures_total: 12 }), sceneLane({ ...thinking, lane: 1, futures_total: 156 })],
  });
  assert.deepEqual((standings.value ?? []).map(({ isThinking }) => isThinking), [false, true]);
});

test("a race that branches off has the original's distances beside its own", () => {
  const branch_from = { race_id: RACE.id, step: 20 };
  const disturbances = [{ kind: "limp", at_step: 20, legs: [1] }];
  const config = { ...RACE.config, branch_from, disturbances };
  const race = makeRun({ ...RACE, id: "branch", created_at: "2031-01-01T00:00:00Z", config });
  applyEvent("snapshot", { runs: [RACE, race], stage: STAGE, scene: null });
  const originals = (standings.value ?? []).map(({ agent, original }) => [agent, original]);
  assert.deepEqual(originals, [
    ["greedy", { finished_m: 0.3, total_m: 0.5 }], ["learner", { finished_m: 0.2, total_m: 0.5 }],
  ]);
  applyEvent("stage", { ...STAGE, run_id: "branch" });
  assert.deepEqual(stageIds.value, ["branch", RACE.id]);
  applyEvent("snapshot", { runs: [RACE], stage: STAGE, scene: null });
  assert.equal(standings.value?.[0].original, null);
});

test("a fall is told once it is shown, and the heading at the end", () => {
  const lane = { ...laneResult("learner"), fell_at_step: 7, heading_deg: 35 };
  const race = makeRun({ ...RACE, id: "fall", result: { lanes: [lane, laneResult("greedy", 2)] } });
  const postureAt = (/** @type {number} */ step) => {
    applyEvent("snapshot", {
      runs: [race], stage: { ...STAGE, run_id: "fall" },
      scene: {
        run_id: "fall", kind: "race", clock: "paper", phase: "race", time_s: 1, action_values: null,
        lanes: [sceneLane({ step, done: step === 50 }), sceneLane({ lane: 1, rank: 2 })],
      },
    });
    const [{ fell_at_step, heading_deg }] = standings.value ?? [];
    return [fell_at_step, heading_deg];
  };
  assert.deepEqual([postureAt(7), postureAt(8), postureAt(50)], [[null, null], [7, null], [7, 35]]);
});

test("a race can be raced on while its replay is held", () => {
  const lanes = [sceneLane({ step: 50, done: true }), sceneLane({ lane: 1, step: 12 })];
  showScene({ phase: "race", time_s: 1, lanes });
  assert.deepEqual([heldRace.value, stepShown.value], [null, 12]);
  applyEvent("stage", { ...STAGE, run_id: RACE.id, playing: false });
  assert.equal(heldRace.value?.id, RACE.id);
  showScene({ phase: "finished", time_s: 9, lanes: lanes.map((lane) => ({ ...lane, done: true })) });
  applyEvent("stage", { ...STAGE, run_id: RACE.id, ended: true });
  assert.deepEqual([heldRace.value?.id, stepShown.value], [RACE.id, null]);
});
