// Why the leader is ahead, from recorded figures only.
import assert from "node:assert/strict";
import { beforeEach, test } from "node:test";
import {
  announcement, announceOutcomes, headline, narrative as saidNow, whyMarching,
} from "../../static/js/headline.js";
import { madeAt, stepEnds } from "../../static/js/narrative/moment.js";
import { chanceInWords, leaderOf, reasonOf, workOf } from "../../static/js/narrative/sentences.js";
import { applyEvent, connection, options } from "../../static/js/store.js";
import { makeRun, makeSceneLane, makeStage, OPTIONS } from "./options.js";

/**
 * A lane of steps of 1 s, of the lengths given [m], each thought of for `thinking` seconds before.
 * @param {number[]} lengths
 * @param {{ thinking?: number, futures?: number }} [search]
 */
function track(lengths, { thinking = 0, futures = 0 } = {}) {
  /** @type {any} */
  const lane = { points: [[0, 0]], thinking: [], futures: lengths.map(() => futures) };
  let [time, distance] = [0, 0];
  for (const length of lengths) {
    if (thinking) {
      lane.thinking.push([time, time + thinking]);
      lane.points.push([(time += thinking), distance]);
    }
    lane.points.push([(time += 1), (distance += length)]);
  }
  return { ...lane, total_s: time, steps: lengths.length, stride: 1 };
}

/** @type {(count: number, length: number) => number[]} */
const steps = (count, length) => Array.from({ length: count }, () => length);

/** @param {object} [changes] */
const row = (lane = 0, title = "Greedy", changes = {}) => ({ lane, title, fell_at_step: null, ...changes });
const [A, B] = [row(0, "Greedy"), row(1, "Q-learning")];

/** At the end of all steps. @type {(rows: any[], tracks: any[], happened?: any[]) => string | null} */
const reason = (rows, tracks, happened = []) => reasonOf(rows.map((shown) => ({
  ...shown, made: tracks[shown.lane]?.steps ?? 0, distance_m: tracks[shown.lane]?.points.at(-1)[1] ?? 0,
})), tracks, { time_s: 1000, isPast: false }, happened);

beforeEach(() => {
  options.value = OPTIONS;
});

test("steps count once they have ended, with the distance that they made", () => {
  const slow = track([0.03, 0.03], { thinking: 1 });
  assert.deepEqual(stepEnds(slow), [[0, 0], [2, 0.03], [4, 0.06]]);
  assert.deepEqual([1.5, 3.5, 3.9995, 4].map((time) => madeAt(slow, time)), [0, 1, 2, 2]);
  assert.equal(madeAt({ ...slow, stride: 3, steps: 5 }, 4), 5, "three together, and the last two");
  assert.equal(stepEnds({ ...slow, points: [[0, 0], [2, 0.02]] }), null);
});

test("nothing is told without figures of both, nor of lanes that are level", () => {
  assert.equal(reason([A], [track([0.1])]), null);
  assert.equal(reason([A, B], [track([0.1])]), null);
  assert.equal(reason([A, B], [track([0.1]), track([])]), null);
  assert.equal(reason([A, B], [track(steps(5, 0.01)), track(steps(5, 0.009))]), null);
});

test("1: the other has fallen, and the leader has not", () => {
  const tracks = [track(steps(9, 0.01)), track(steps(9, 0.002))];
  assert.equal(reason([A, row(1, "Q-learning", { fell_at_step: 6 })], tracks), "Q-learning has fallen at step 7.");
  const both = [row(0, "Greedy", { fell_at_step: 3 }), row(1, "Q-learning", { fell_at_step: 6 })];
  assert.match(reason(both, tracks) ?? "", /^Its steps are longer/);
});

test("2: the other marches on the spot", () => {
  const tracks = [track(steps(12, 0.01)), track([0.02, 0.02, ...steps(10, 0.0004)])];
  const words = reason([A, B], tracks);
  assert.equal(words, "Q-learning marches on the spot: 0.4\u00a0cm in its last ten steps.");
});

test("3: a disturbance shortened the other's steps, and more than the leader's", () => {
  const limp = { at_step: 5, words: "Leg\u00a01 limp from step 6" };
  const tracks = [track(steps(10, 0.01)), track([...steps(5, 0.01), ...steps(5, 0.004)])];
  const words = "Leg\u00a01 limp from step 6: Q-learning went 10.0\u00a0mm a step before, 4.0\u00a0mm after.";
  assert.equal(reason([A, B], tracks, [limp]), words);
  assert.doesNotMatch(reason([A, B], tracks, [{ ...limp, at_step: 9 }]) ?? "", /limp/, "two steps after tell nothing");
  const alike = [track([...steps(5, 0.02), ...steps(5, 0.005)]), tracks[1]];
  assert.doesNotMatch(reason([A, B], alike, [limp]) ?? "", /limp/, "the leader lost more by it");
});

test("4: its steps are longer, with the moves that it simulates before each, if it does", () => {
  const other = track(steps(8, 0.007));
  assert.equal(reason([A, B], [track(steps(8, 0.01), { futures: 12 }), other]),
    "Its steps are longer: 10.0\u00a0mm against 7.0\u00a0mm of Q-learning. It simulates 12 moves before each.");
  const table = reason([A, B], [track(steps(8, 0.01)), other]);
  assert.equal(table, "Its steps are longer: 10.0\u00a0mm against 7.0\u00a0mm of Q-learning.");
  const uneven = { ...track(steps(2, 0.02)), futures: [10, 13] };
  assert.match(reason([A, B], [uneven, track(steps(2, 0.007))]) ?? "", /It simulates about 12 moves before each\.$/);
});

test("5: it thinks less and has made more steps", () => {
  const words = reason([A, B], [track(steps(8, 0.01)), track(steps(4, 0.01), { thinking: 1 })]);
  assert.equal(words, "It thinks less: 8 steps made against 4 of Q-learning.");
});

test("6: both walk alike, and the lead is that of the first ten steps", () => {
  const first = track([...steps(5, 0.014), ...steps(35, 0.01)]);
  assert.equal(reason([A, B], [first, track(steps(40, 0.01))]), "Both walk alike; Greedy began 2\u00a0cm better.");
  assert.equal(reason([A, B], [track([...steps(35, 0.01), ...steps(5, 0.014)]), track(steps(40, 0.01))]), null);
});

test("a reason has at most 25 words", () => {
  const long = row(1, "Posterior sampling (deep)", { fell_at_step: 41 });
  const tracks = [track(steps(50, 0.0123), { futures: 7800 }), track(steps(50, 0.001), { futures: 7 })];
  for (const other of [long, { ...long, fell_at_step: null }, row(1, long.title)]) {
    assert.ok((reason([A, other], tracks) ?? "").split(" ").length <= 25);
  }
});

test("at the end it is told how the winner spent its time", () => {
  const winner = track(steps(4, 0.01), { thinking: 1 });
  assert.equal(workOf(winner, 6, 50), "It thought 50 % of the time: 3 of 50 steps.");
  assert.equal(workOf(undefined, 6, 50), null);
});

test("practice says how many of its steps are random, while there are any", () => {
  assert.equal(chanceInWords(0.334), "33 of 100 steps are still random (ε\u00a00.33): it finds out which moves pay.");
  assert.equal(chanceInWords(0), null);
  assert.equal(chanceInWords(undefined), null);
});

test("practice is told by its newest test that is shown, and before the first by when that comes", () => {
  const run = makeRun({ state: "running", progress: { done: 120, total: 500 } });
  const showStep = (/** @type {number} */ step) => applyEvent("snapshot", {
    runs: [run], stage: makeStage({ run_id: run.id, phase: "live" }),
    scene: { run_id: run.id, kind: "training", phase: "practice", lanes: [makeSceneLane({ step })] },
  });
  showStep(10);
  applyEvent("evaluation", { run_id: run.id, step: 50, distance_m: 0.12, epsilon: 0.9 });
  applyEvent("evaluation", { run_id: run.id, step: 100, distance_m: 0.31, epsilon: 0.8 });
  assert.deepEqual([headline.value, saidNow.value.reason], ["Learner practises", "Its first test is at step 50."]);
  showStep(50);
  assert.equal(headline.value, "Learner practises", "while it takes the step after which it is tested");
  showStep(51);
  assert.equal(headline.value, "Learner walks 0.12\u00a0m so far");
  assert.match(saidNow.value.reason ?? "", /^90 of 100 steps are still random/);
  connection.value = "reconnecting";
  assert.equal(saidNow.value.reason, "This is the last that is known.");
  connection.value = "live";
});

test("the last picture of a practice that has ended says how it ended, and nothing of what it still does", () => {
  const run = makeRun({ state: "stopped", progress: { done: 120, total: 500 }, can_resume: true });
  const end = (/** @type {object} */ changes, isEnded = true) => applyEvent("snapshot", {
    role: "operator", runs: [{ ...run, ...changes }], stage: makeStage({ run_id: run.id, ended: isEnded }),
    scene: {
      run_id: run.id, kind: "training", phase: "practice", ended: isEnded, lanes: [makeSceneLane({ step: 120 })],
    },
  });
  end({ progress: { done: 50, total: 500 } }, false);
  assert.deepEqual([headline.value, saidNow.value.reason, saidNow.value.note], ["Learner practises", null, null]);
  end({ progress: { done: 51, total: 500 } }, false);
  assert.equal(saidNow.value.reason, "Its first test is at step 50.");
  end({});
  assert.deepEqual([headline.value, saidNow.value.reason, saidNow.value.note?.what, saidNow.value.note?.action?.label],
    ["Stopped at step 120 of 500", null, "The training was stopped at step 120 of 500.", "Go on"]);
  connection.value = "reconnecting";
  assert.equal(headline.value, "Stopped at step 120 of 500", "which stays so without the server");
  connection.value = "live";
  applyEvent("evaluation", { run_id: run.id, step: 100, distance_m: 0.31, epsilon: 0.8 });
  assert.deepEqual([headline.value, saidNow.value.reason],
    ["Stopped at step 120 of 500", "Learner walked 0.31\u00a0m in its last test, after 100 steps."]);
  end({ state: "interrupted" });
  assert.equal(headline.value, "Interrupted at step 120 of 500");
  end({ state: "finished", progress: { done: 500, total: 500 } });
  assert.deepEqual([headline.value, saidNow.value.reason, saidNow.value.note],
    ["Learner walked 0.31\u00a0m in its last test", "It has practised 500 steps.", null]);
  // Played again it is at an earlier moment.
  end({}, false);
  assert.equal(headline.value, "Learner walks 0.31\u00a0m so far");
});

test("why a robot marches on the spot is told of who learns or simulates, and of nobody else", () => {
  assert.match(whyMarching("learner"), /still have the highest values\. More practice changes that\.$/);
  assert.match(whyMarching("greedy"), /no move that it simulates gains distance/);
  assert.equal(whyMarching("random-walk"), "under 1 cm in ten steps.");
});

// ---- what a screen reader hears of a race

/** @type {(title: string, lane: number, distance_m: number) => any} */
const laneAt = (title, lane, distance_m) => ({ title, lane, distance_m, finished_m: null });

test("a lane leads that is a centimetre ahead of all others, or walks alone", () => {
  const [greedy, learner] = [laneAt("Greedy", 0, 0.12), laneAt("Learner", 1, 0.1)];
  assert.deepEqual(leaderOf([learner, greedy]), { lane: 0, words: "Greedy takes the lead, 0.12\u00a0m" });
  assert.equal(leaderOf([greedy, laneAt("Learner", 1, 0.115)]), null);
  assert.equal(leaderOf([laneAt("Greedy", 0, 0.005)]), null);
  assert.equal(leaderOf([laneAt("Greedy", 0, 0.02)])?.lane, 0);
});

test("each change of the lead is announced once, and those in quick succession by the newest", ({ mock }) => {
  mock.timers.enable({ apis: ["setTimeout"] });
  let now_ms = 100_000;
  mock.method(performance, "now", () => now_ms);
  const wait = (/** @type {number} */ time_ms) => {
    now_ms += time_ms;
    mock.timers.tick(time_ms);
  };
  const lanes = [{ agent: "learner" }, { agent: "greedy" }];
  const run = makeRun({ id: "r", kind: "race", state: "running", progress: { done: 9, total: 100 },
    config: { steps: 50, lanes } });
  /** @param {number} learner_m @param {number} greedy_m @param {object} [changes] */
  const show = (learner_m, greedy_m, changes = {}) => {
    applyEvent("snapshot", {
      runs: [{ ...run, ...changes }], stage: makeStage({ run_id: run.id, phase: "live" }),
      scene: {
        run_id: run.id, kind: "race", phase: "race", ended: false, time_out_s: null, time_s: 3, ...changes,
        lanes: [makeSceneLane({ lane: 0, step: 5, distance_m: learner_m }),
          makeSceneLane({ lane: 1, name: "Greedy", step: 5, distance_m: greedy_m })],
      },
    });
    return announcement.value;
  };
  announceOutcomes();
  assert.equal(show(0, 0), "");
  assert.equal(show(0.05, 0.02), "Learner takes the lead, 0.05\u00a0m");
  wait(1000);
  assert.equal(show(0.06, 0.08), "Learner takes the lead, 0.05\u00a0m", "so soon after the one before nothing is said");
  show(0.1, 0.08);
  wait(3000);
  assert.equal(announcement.value, "Learner takes the lead, 0.05\u00a0m", "it leads again, as was said");
  show(0.1, 0.12);
  assert.equal(announcement.value, "Greedy takes the lead, 0.12\u00a0m");
  wait(500);
  show(0.15, 0.13);
  show(0.15, 0.17);
  show(0.2, 0.18);
  wait(3500);
  assert.equal(announcement.value, "Learner takes the lead, 0.20\u00a0m", "with the distance of the moment it is said");
  wait(5000);
  show(0.2, 0.205);
  assert.equal(announcement.value, "Learner takes the lead, 0.20\u00a0m", "lanes that are level change nothing");
});
