// The scale of the time bar, what happened on it, and what a press on it does.
import assert from "node:assert/strict";
import { afterEach, beforeEach, test } from "node:test";
import { page } from "../../static/js/page-state.js";
import { followTimeline } from "../../static/js/race.js";
import { closeReplay, followPlayer } from "../../static/js/player.js";
import { stepEnds } from "../../static/js/narrative/moment.js";
import { applyEvent, connection, options, stage } from "../../static/js/store.js";
import {
  laneRows, markInWords, marks, positionInWords, pressSlider, scale, seekTo, seekToMark, timeAtDistance, toggleTime,
} from "../../static/js/time.js";
import { makeRun, makeSceneLane, makeStage, OPTIONS } from "./options.js";

/** @import { Playhead, Run, TimelinePoint } from "../../static/js/types.js" */

/** What was asked of the server: the method, the end of the address and the body. @type {unknown[][]} */
let requests = [];
/** The timeline that it has. */
const TIMELINE = { clock: "paper", finish_line_m: 0.45, first_finish_s: 16, lanes: /** @type {object[]} */ ([]) };
globalThis.fetch = (address, { method = "GET", body = null } = {}) => {
  const { pathname } = new URL(String(address));
  // Pictures do not come.
  if (pathname.includes("/replay") || pathname.endsWith("/start-line")) return new Promise(() => {});
  const [last] = pathname.split("/").slice(-1);
  if (method !== "GET") requests.push([method, last, JSON.parse(String(body))]);
  const answer = last === "timeline" ? TIMELINE : stage.value;
  return Promise.resolve(new Response(JSON.stringify(answer)));
};
globalThis.requestAnimationFrame = () => 0;

/** Let answers be read. */
const settle = async () => {
  for (let n = 0; n < 5; n += 1) {
    await new Promise((resolve) => {
      setImmediate(resolve);
    });
  }
};

/** Thinks for a second before each of two steps of a second. @type {TimelinePoint[]} */
const POINTS = [[0, 0], [1, 0], [2, 0.3], [3, 0.3], [4, 0.6]];
const TRACK = {
  agent: "greedy", steps: 2, stride: 1, points: POINTS, thinking: /** @type {[number, number][]} */ ([[0, 1], [2, 3]]),
  futures: [12, 12], total_s: 4,
};

/**
 * Show a run: how far it is, and how far the picture is.
 * @type {(run: Run, scene: object, rest?: { role?: string, stage?: object }) => void}
 */
const show = (run, scene, { role = "operator", stage: changes = {} } = {}) => applyEvent("snapshot", {
  role, runs: [run],
  stage: makeStage({ run_id: run.id, phase: "showing", playhead: heldAt({ ...TIMES, ...scene }), ...changes }),
  scene: {
    run_id: run.id, kind: run.kind, label: "", phase: run.kind === "race" ? "race" : "practice", ...TIMES, ended: false,
    shown_speed: 1, action_values: null, lanes: [makeSceneLane()], ...scene,
  },
});
const TIMES = { time_s: 0, duration_s: null, computed_s: 0, time_out_s: null };
/** @type {(times: typeof TIMES) => Playhead} */
const heldAt = ({ time_s, ...known }) => ({ at_s: 0, points: [[0, time_s]], rate: 0, ...known });
followPlayer();

/** @param {object} [changes] */
const makeRace = (changes = {}) => makeRun({
  kind: "race", progress: { done: 4, total: 4 }, config: { steps: 2, lanes: [{ agent: "greedy" }] }, ...changes,
});

// One that is open asks again for ever.
afterEach(() => {
  closeReplay();
});

beforeEach(() => {
  options.value = OPTIONS;
  connection.value = "live";
  TIMELINE.lanes = [];
  requests = [];
});

// ---- the scale

test("a practice is told in steps: all of them while it is computed, then those that it made", () => {
  const run = makeRun({ state: "running", progress: { done: 200, total: 500 } });
  show(run, { time_s: 20, duration_s: 250, computed_s: 100 });
  assert.deepEqual(scale.value,
    { unit: "step", unit_s: 0.5, end: 500, picture: 40, computed: 200, isComputing: true });
  // The server's duration stays that of the steps that were ordered.
  show({ ...run, state: "stopped" }, { time_s: 20, duration_s: 250, computed_s: 100 });
  assert.deepEqual(scale.value,
    { unit: "step", unit_s: 0.5, end: 200, picture: 40, computed: 200, isComputing: false });
  // A crash loses the steps since the last checkpoint, which count as done.
  show({ ...run, state: "interrupted" }, { time_s: 75, duration_s: 250, computed_s: 75 });
  assert.deepEqual(scale.value,
    { unit: "step", unit_s: 0.5, end: 150, picture: 150, computed: 150, isComputing: false });
});

test("a race is told in seconds, and while it is computed it is expected to take longer", () => {
  const race = makeRace({ state: "running" });
  show(race, { time_s: 1, computed_s: 2 });
  assert.deepEqual(scale.value, { unit: "s", unit_s: 1, end: 10, picture: 1, computed: 2, isComputing: true });
  show(race, { time_s: 1, computed_s: 20 });
  assert.equal(scale.value?.end, 22);
});

test("the bar of a race ends at its time-out, unless the show goes on or the picture is past it", () => {
  const race = makeRace();
  const times = { duration_s: 40, computed_s: 40, time_out_s: 16 };
  show(race, { ...times, time_s: 3 });
  assert.deepEqual([scale.value?.end, scale.value?.computed], [16, 16]);
  show(race, { ...times, time_s: 3 }, { stage: { end_at_time_out: false } });
  assert.equal(scale.value?.end, 40);
  show(race, { ...times, time_s: 20 });
  assert.equal(scale.value?.end, 40, "the thumb stays on the bar");
});

test("there is no scale before a run can be seen, nor of another run than that in the picture", () => {
  const run = makeRun({ state: "running", progress: { done: 0, total: 500 } });
  show(run, {});
  assert.equal(scale.value, null);
  show(run, { run_id: "another", duration_s: 9, computed_s: 9 });
  assert.equal(scale.value, null);
  applyEvent("snapshot", { runs: [], stage: makeStage(), scene: { run_id: null, kind: "idle" } });
  assert.equal(scale.value, null);
});

test("a position is told as a step or as seconds", () => {
  assert.equal(positionInWords({ unit: "step" }, 1234.4), "step 1234");
  assert.equal(positionInWords({ unit: "s" }, 8.26), "8.3\u00a0s");
});

// ---- what happened

test("the times of steps are those at which they began and ended, without the thinking", () => {
  const timesOf = (/** @type {any} */ track) => stepEnds(track)?.map(([t]) => t) ?? null;
  assert.deepEqual(timesOf(TRACK), [0, 2, 4]);
  assert.deepEqual(timesOf({ points: [[0, 0], [1, 0.1]], thinking: [], futures: [0] }), [0, 1]);
  assert.equal(timesOf({ ...TRACK, points: POINTS.slice(0, 3) }), null, "it is thinned");
});

test("a lane has come so far between two points of its path, and to where it began at once", () => {
  assert.equal(timeAtDistance(TRACK, 0.15), 1.5);
  assert.equal(timeAtDistance(TRACK, 0.6), 4);
  assert.equal(timeAtDistance(TRACK, 0), 0);
  assert.equal(timeAtDistance(TRACK, 0.7), null);
});

test("marks of a practice are its tests, its changes and what happened, as far as it is computed", () => {
  const limp = { step: 100, disturbance: { kind: "limp", at_step: 100, legs: [1] } };
  const run = makeRun({
    state: "running", progress: { done: 200, total: 500 },
    changes: [{ step: 60, settings: { alpha: 0.5 } }, limp, { step: 300, settings: { alpha: 0.9 } }],
  });
  show(run, { time_s: 100, duration_s: 250, computed_s: 100, lanes: [makeSceneLane({ step: 200 })] });
  applyEvent("evaluation", { run_id: run.id, step: 50, distance_m: 0.12, epsilon: 1 });
  assert.deepEqual(marks.value.map(({ kind, at, isMinor = false }) => [kind, at, isMinor]),
    [["evaluation", 50, true], ["change", 60, false], ["disturbance", 100, false]]);
  assert.deepEqual(marks.value.map(markInWords), ["Test: 0.12\u00a0m", "α\u00a00.5", "Leg\u00a01 limp"]);
});

test("marks of a race are its time-out, who crosses the line, and what happened to each lane at its time", async () => {
  const slope = { kind: "slope", at_step: 1, degrees: 8 };
  const race = makeRace({
    config: { steps: 2, lanes: [{ agent: "greedy" }], disturbances: [slope] },
    result: { lanes: [{ agent: "greedy", fell_at_step: 2, clocks: {} }] },
  });
  TIMELINE.lanes = [TRACK];
  show(race, { time_s: 1, duration_s: 4, computed_s: 4, time_out_s: 4 });
  const stop = followTimeline();
  await settle();
  assert.deepEqual(marks.value.map(({ kind, at }) => [kind, at]),
    [["disturbance", 2], ["crossing", 3.5], ["time-out", 4], ["fall", 4]]);
  assert.deepEqual(marks.value.map(markInWords).slice(1),
    ["Greedy crosses the line", "Time-out", "Greedy falls"]);
  assert.deepEqual(laneRows.value.map(({ name, thinking, until }) => [name, thinking, until]),
    [["Greedy", [[0, 1], [2, 3]], 4]]);
  stop();
});

// ---- what a press does

test("operators seek on the stage, never beyond what is computed", async () => {
  show(makeRun({ state: "running", progress: { done: 200, total: 500 } }), { duration_s: 250, computed_s: 100 });
  seekTo(100);
  await settle();
  seekTo(400, { isHeld: true });
  await settle();
  connection.value = "reconnecting";
  seekTo(10);
  await settle();
  connection.value = "live";
  assert.deepEqual(requests, [["PUT", "stage", { time_s: 50 }], ["PUT", "stage", { time_s: 100, playing: false }]]);
});

test("each press of an arrow moves on from the one before, whatever the picture shows meanwhile", async () => {
  const race = makeRace();
  const at = (/** @type {number} */ time_s) => show(race, { time_s, duration_s: 16, computed_s: 16 });
  at(3);
  for (let press = 0; press < 10; press += 1) assert.ok(pressSlider("ArrowRight"));
  at(3.1);
  for (let press = 0; press < 10; press += 1) pressSlider("ArrowRight");
  await settle();
  const [, , last] = requests.at(-1) ?? [];
  assert.deepEqual(Number(/** @type {{ time_s: number }} */ (last).time_s.toFixed(6)), 5);
  seekTo(8);
  at(8);
  pressSlider("ArrowLeft");
  await settle();
  assert.deepEqual(requests.at(-1), ["PUT", "stage", { time_s: 7.9 }], "elsewhere in between");
  pressSlider("PageUp");
  pressSlider("End");
  pressSlider("ArrowRight");
  await settle();
  assert.deepEqual(requests.at(-1), ["PUT", "stage", { time_s: 16 }]);
  assert.equal(pressSlider("x"), false);
});

test("an arrow is a step of a practice", async () => {
  show(makeRun({ progress: { done: 500, total: 500 } }), { time_s: 5, duration_s: 250, computed_s: 250 });
  for (let press = 0; press < 4; press += 1) pressSlider("ArrowRight");
  await settle();
  assert.deepEqual(requests.at(-1), ["PUT", "stage", { time_s: 7 }], "14 steps of half a second");
});

test("the next mark is that after the picture, and tests are no stops", async () => {
  const run = makeRun({ progress: { done: 500, total: 500 }, changes: [{ step: 60, settings: { alpha: 0.5 } }] });
  const at = (/** @type {number} */ step) =>
    show(run, { time_s: step, duration_s: 500, computed_s: 500, lanes: [makeSceneLane({ step: 500 })] });
  at(10);
  applyEvent("evaluation", { run_id: run.id, step: 20, distance_m: 0.1, epsilon: 1 });
  seekToMark(1);
  await settle();
  at(60);
  seekToMark(1);
  seekToMark(-1);
  await settle();
  at(100);
  seekToMark(-1);
  await settle();
  assert.deepEqual(requests.map(([, , body]) => body),
    [{ time_s: 60, playing: false }, { time_s: 60, playing: false }]);
});

test("who may not play the stage plays a replay of their own, from the same moment", () => {
  const race = makeRace();
  const showRace = () => show(race, { time_s: 2, duration_s: 4, computed_s: 4 }, { role: "spectator" });
  showRace();
  toggleTime();
  assert.deepEqual([page.moment.value, page.run.value !== null], [2, true], "it is held");
  closeReplay();
  showRace();
  seekTo(3);
  assert.deepEqual([page.moment.value, page.run.value !== null], [null, true], "it plays");
  closeReplay();
  showRace();
  connection.value = "reconnecting";
  toggleTime();
  seekTo(3);
  assert.equal(page.run.value, null, "the server, which has its pictures, is away");
  connection.value = "live";
  assert.deepEqual(requests, []);
});
