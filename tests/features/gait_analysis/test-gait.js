// The gait of a race: the moments of its lanes, its footfalls, and its figures in words.
import assert from "node:assert/strict";
import { beforeEach, mock, test } from "node:test";
import {
  analysis, canSeek, cycleSentence, extentOf, FIGURES, followGait, legsInOrder, legsInTheAir, lineOf,
  momentOf, part, problem, raceTimeAt, rangeInWords, SERIES, subject, swingsOf,
} from "../../../static/features/gait_analysis/gait.js";
import { applyEvent, connection, options, scene } from "../../../static/js/store.js";
import { makeRun, OPTIONS } from "../../page/options.js";

/** @import { GaitFigures } from "../../../static/js/types.js" */

/** @type {GaitFigures} */
const FIGURES_OF_A_WALK = {
  from_s: 1, to_s: 5, distance_m: 0.2, speed_m_s: 0.05, speed_body_lengths_s: 0.25, duty_factor: 0.75, mass_kg: 2,
  legs: [
    { leg: 1, stance: [[1, 2], [2.5, 5]], duty_factor: 0.875 },
    { leg: 2, stance: [[1.5, 4]], duty_factor: 0.625 },
  ],
  cycle: { steps: 2, period_s: 0.64, first_step: 5, repeats: 4, advance_m: 0.031, actions: [[1, 2], [0, 1]] },
  posture: {
    time_s: [1, 5], height_m: [0.1, 0.102], pitch_deg: [-0.04, 2], roll_deg: [0, 0],
    height_range_m: [0.1, 0.102], pitch_range_deg: [-0.04, 2], roll_range_deg: [0, 0],
  },
  effort: {
    time_s: [5], torque_nm: [0.6], power_w: [2], largest_torque_nm: 0.6, torque_limit_nm: 1.5, energy_j: 8,
    mean_power_w: 2, cost_of_transport: null,
  },
};

const STAGE = { run_id: "race", next_run_id: null, playing: true, speed: 1, clock: "paper" };
const TRAINING = makeRun({ id: "training", kind: "training", progress: { done: 40, total: 50 } });

beforeEach(() => {
  options.value = OPTIONS;
  const race = makeRun({
    id: "race", kind: "race", progress: { done: 100, total: 100 }, config: { steps: 50, lanes: [{ agent: "greedy" }] },
  });
  applyEvent("snapshot", { role: "operator", runs: [race, TRAINING], stage: STAGE, scene: null });
});

test("a moment of robot time is shown once the lane has thought before it", () => {
  /** Thinks for a second before it begins, and for two after it has walked for one. */
  const lane = { thinking: /** @type {[number, number][]} */ ([[0, 1], [2, 4]]) };
  assert.equal(raceTimeAt(lane, 0), 1);
  assert.equal(raceTimeAt(lane, 0.5), 1.5);
  assert.equal(raceTimeAt(lane, 1), 4);
  assert.equal(raceTimeAt(lane, 1.5), 4.5);
  assert.equal(raceTimeAt({ thinking: [] }, 1.5), 1.5);
});

test("it is about the race, and about a training while that is shown", () => {
  assert.equal(subject.value?.part, "race");
  applyEvent("stage", { ...STAGE, run_id: "training" });
  scene.value = /** @type {any} */ ({ run_id: "training", kind: "training", time_s: 3.2, lanes: [] });
  assert.deepEqual([subject.value?.run.id, subject.value?.part], ["training", "practice"]);
  assert.equal(momentOf(0), 3.2);
  assert.equal(canSeek.value, true);
  applyEvent("snapshot", { role: "spectator", runs: [TRAINING], stage: { ...STAGE, run_id: "training" }, scene: null });
  assert.equal(canSeek.value, false);
});

test("legs are drawn pair by pair", () => {
  const [gait] = OPTIONS.gaits;
  const run = makeRun({ config: { gait: gait.name } });
  const legs = gait.pairs.flat().length;
  assert.deepEqual(legsInOrder(run, legs).map(([leg]) => leg), gait.pairs.flat());
  assert.deepEqual(legsInOrder(run, legs).map(([, pair]) => pair), gait.pairs.flatMap((_, n) => [n + 1, n + 1]));
  const unnamed = makeRun({ config: { gait: { right_leg: 1 } } });
  assert.deepEqual(legsInOrder(unnamed, 2), [[1, null], [2, null]]);
});

test("a foot is in the air between its stances", () => {
  const [first, second] = FIGURES_OF_A_WALK.legs;
  assert.deepEqual(swingsOf(first.stance, FIGURES_OF_A_WALK), [[2, 2.5]]);
  assert.deepEqual(swingsOf(second.stance, FIGURES_OF_A_WALK), [[1, 1.5], [4, 5]]);
  assert.deepEqual(legsInTheAir(FIGURES_OF_A_WALK, 2.2), [1]);
  assert.deepEqual(legsInTheAir(FIGURES_OF_A_WALK, 3), []);
  assert.deepEqual(legsInTheAir(FIGURES_OF_A_WALK, 4.5), [2]);
});

test("lines have their units, and axes that do not magnify noise", () => {
  const [height, pitch, , torque] = SERIES;
  assert.deepEqual(lineOf(FIGURES_OF_A_WALK, height)?.values, [100, 102]);
  assert.deepEqual(lineOf(FIGURES_OF_A_WALK, torque), { times: [5], values: [0.6] });
  assert.equal(lineOf({ ...FIGURES_OF_A_WALK, effort: null }, torque), null);
  assert.deepEqual(extentOf([[100, 102], [101]], height), { low: 99, high: 103 });
  assert.deepEqual(extentOf([[-0.04, 3]], pitch), { low: -0.04, high: 3 });
  assert.deepEqual(extentOf([[0.6]], torque), { low: 0, high: 0.6 });
});

test("figures are told with their units, and a dash stands where there are none", () => {
  const texts = (/** @type {GaitFigures} */ figures) => FIGURES.map(([name, , words]) => [name, words(figures)]);
  const words = Object.fromEntries(texts(FIGURES_OF_A_WALK));
  assert.equal(words.Speed, "0.050\u00a0m/s");
  assert.equal(words["Duty factor"], "0.75");
  assert.equal(words.Cycle, "2 steps, 0.64\u00a0s");
  assert.equal(words["Body height"], "100.0 to 102.0\u00a0mm");
  assert.equal(words.Pitch, "0.0 to 2.0°");
  assert.equal(words.Roll, "0.0°");
  assert.equal(words["Largest torque"], "0.60 of 1.5\u00a0N·m");
  assert.equal(words["Cost of transport"], null);
  const without = Object.fromEntries(texts({ ...FIGURES_OF_A_WALK, effort: null, cycle: null }));
  assert.equal(without.Energy, null);
  assert.equal(without.Cycle, "none");
  assert.equal(rangeInWords([-2, -1], 0, "°"), "−2 to −1°");
});

test("a cycle is told by the legs that move", () => {
  const legs = /** @type {[number, number | null][]} */ ([[1, 1], [4, 1], [2, 2], [5, 2]]);
  assert.equal(cycleSentence(FIGURES_OF_A_WALK, legs),
    "From step 6 on it repeats 2 steps of 3.1\u00a0cm in all; legs 2 and 5, then 1 and 4.");
  assert.equal(cycleSentence({ ...FIGURES_OF_A_WALK, cycle: null }, legs), "");
});

test("an error is shown, and the request repeated if that can be of use", async () => {
  mock.timers.enable({ apis: ["setTimeout"] });
  connection.value = "live";
  applyEvent("snapshot", { role: "operator", runs: [TRAINING], stage: { ...STAGE, run_id: "training" }, scene: null });
  /** @type {(string | null)[]} */
  const requests = [];
  const answers = [[503, { detail: "Busy." }], [200, { part: "practice", step_s: 1, lanes: [] }],
    [409, { detail: "Not evaluated." }]];
  globalThis.fetch = (address) => {
    requests.push(new URL(String(address)).searchParams.get("part"));
    const [status, body] = answers[requests.length - 1];
    return Promise.resolve(new Response(JSON.stringify(body), { status: Number(status) }));
  };
  const pass = async () => {
    for (let turn = 0; turn < 3; turn += 1) {
      await new Promise((resolve) => {
        setImmediate(resolve);
      });
    }
    mock.timers.tick(1000);
  };
  const stop = followGait();
  await pass();
  assert.equal(problem.value, "Busy.");
  await pass();
  assert.deepEqual([problem.value, analysis.value?.part], [null, "practice"]);
  part.value = "evaluation";
  for (let n = 0; n < 3; n += 1) await pass();
  assert.deepEqual([problem.value, analysis.value], ["Not evaluated.", null]);
  assert.deepEqual(requests, ["practice", "practice", "evaluation"]);
  part.value = "practice";
  assert.equal(problem.value, null, "it is about the other part");
  stop();
  mock.timers.reset();
});
