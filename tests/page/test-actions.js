// Actions while the answer to the one before is awaited: on a slow connection none is lost.
import assert from "node:assert/strict";
import { beforeEach, test } from "node:test";
import { setImmediate } from "node:timers/promises";
import {
  canStart, missingLane, pause, pending, problems, seekIn, setStage, stop, togglePause, togglePlaying,
} from "../../static/js/actions.js";
import { form, setField } from "../../static/js/form.js";
import { practiseAtPaceOfPicture, tune } from "../../static/js/live-changes.js";
import { isLifted, restriction } from "../../static/js/settings.js";
import { applyEvent, connection, options } from "../../static/js/store.js";
import { makeRun, OPTIONS } from "./options.js";

const STAGE = { run_id: "a", next_run_id: null, playing: true, ended: false, speed: 1, clock: "paper" };
const SCENE = { run_id: "a", kind: "race" };

/** Requests: the last part of the address, and the body. @type {unknown[]} */
let sent = [];
/** Each answers the oldest unanswered request. @type {((answer: unknown) => void)[]} */
let answers = [];

beforeEach(() => {
  [sent, answers] = [[], []];
  options.value = OPTIONS;
  globalThis.fetch = (address, request) => {
    const name = String(address).split("/").at(-1) ?? "";
    sent.push(request?.body ? { [name]: JSON.parse(String(request.body)) } : name);
    return new Promise((resolve) => {
      answers.push((answer) => resolve(Response.json(answer)));
    });
  };
});

/** Answer requests in their order, until none is open any more. @param {(sent: unknown) => unknown} answerTo */
async function answerAll(answerTo) {
  for (let n = 0; n < 200; n += 1) {
    const number = sent.length - answers.length;
    answers.shift()?.(answerTo(sent[number]));
    await setImmediate();
  }
  assert.deepEqual(Object.values(pending.value).filter(Boolean), []);
}

test("of several seeks before the stage answers, the newest is sent next", async () => {
  applyEvent("snapshot", { role: "operator", runs: [], stage: STAGE, scene: SCENE });
  const seek = seekIn("a");
  assert.ok(seek);
  assert.equal(seekIn("b"), null);
  for (const time_s of [1, 2, 3]) seek(time_s);
  assert.deepEqual(sent, [{ stage: { time_s: 1 } }]);
  await answerAll(() => STAGE);
  assert.deepEqual(sent, [{ stage: { time_s: 1 } }, { stage: { time_s: 3 } }]);
  applyEvent("snapshot", { role: "spectator", runs: [], scene: SCENE });
  assert.equal(seekIn("a"), null);
});

test("other settings of the stage are sent with it", async () => {
  applyEvent("snapshot", { role: "operator", runs: [], stage: STAGE, scene: SCENE });
  setStage({ time_s: 1 });
  setStage({ clock: "wall" });
  setStage({ speed: 4 });
  togglePlaying();
  await answerAll(() => STAGE);
  assert.deepEqual(sent, [{ stage: { time_s: 1 } }, { stage: { clock: "wall", speed: 4, playing: false } }]);
});

test("play and pause pressed twice end as they began", async () => {
  applyEvent("snapshot", { role: "operator", runs: [], stage: STAGE, scene: SCENE });
  togglePlaying();
  togglePlaying();
  await answerAll(() => STAGE);
  assert.deepEqual(sent, [{ stage: { playing: false } }, { stage: { playing: true } }]);
});

test("a training that is paused and resumed at once goes on", async () => {
  const run = makeRun({ id: "a", state: "running", result: null, progress: { done: 5, total: 500 } });
  applyEvent("snapshot", { role: "operator", runs: [run], stage: STAGE, scene: null });
  togglePause();
  togglePause();
  const answer = (/** @type {unknown} */ request) =>
    ({ pause: { ...run, state: "paused" }, resume: run })[String(request)] ?? STAGE;
  await answerAll(answer);
  assert.deepEqual(sent, ["pause", { stage: { playing: false } }, "resume", { stage: { playing: true } }]);
});

test("the same command twice is sent once", async () => {
  const run = makeRun({ id: "a", state: "running", result: null, progress: { done: 5, total: 500 } });
  applyEvent("snapshot", { role: "operator", runs: [run], stage: STAGE, scene: null });
  pause();
  pause();
  await answerAll((request) => (request === "pause" ? { ...run, state: "paused" } : STAGE));
  assert.deepEqual(sent, ["pause", { stage: { playing: false } }]);
});

test("Stop pressed twice does not stop the run that comes next", async () => {
  const [run, next] = ["a", "b"].map((id) => (
    makeRun({ id, state: "running", result: null, progress: { done: 5, total: 500 } })
  ));
  applyEvent("snapshot", { role: "operator", runs: [run, next], stage: STAGE, scene: null });
  stop();
  stop();
  pause();
  stop();
  await answerAll((request) => (request === "stop" ? { ...run, state: "stopped" } : STAGE));
  assert.deepEqual(sent, ["stop"]);
});

test("a change that reaches a training after its end is refused in words, with what to do", async (context) => {
  context.mock.timers.enable({ apis: ["setTimeout"] });
  const run = makeRun({ id: "a", state: "running", progress: { done: 312, total: 500 } });
  applyEvent("snapshot", { role: "operator", runs: [run], stage: STAGE, scene: SCENE });
  const refusal = () => Response.json({ detail: "training a is finished" }, { status: 409 });
  globalThis.fetch = () => Promise.resolve(refusal());
  tune({ alpha: 0.5 });
  applyEvent("run", { ...run, state: "finished", progress: { done: 500, total: 500 } });
  context.mock.timers.tick(1000);
  for (let n = 0; n < 20; n += 1) await setImmediate();
  const words = problems.value.tune?.message ?? "";
  assert.match(words, /^The training was computed up to step 500 of 500 when .* no effect/);
  assert.match(words, /practise at the pace of the picture/);
  practiseAtPaceOfPicture();
  assert.deepEqual([form.value.pace, problems.value.tune], [4, null]);
});

test("a change of a training waits for the answer to the one before, which it could overtake", async (context) => {
  context.mock.timers.enable({ apis: ["setTimeout"] });
  const run = makeRun({ id: "a", state: "running", progress: { done: 312, total: 500 } });
  applyEvent("snapshot", { role: "operator", runs: [run], stage: STAGE, scene: SCENE });
  const passes = async () => {
    context.mock.timers.tick(1000);
    for (let n = 0; n < 20; n += 1) await setImmediate();
  };
  tune({ alpha: 0.5 });
  await passes();
  tune({ alpha: 0.6 });
  tune({ alpha: 0.7 });
  await passes();
  assert.equal(sent.length, 1);
  answers.shift()?.(run);
  await passes();
  assert.equal(sent.length, 2);
  assert.match(JSON.stringify(sent), /0\.5.*0\.7/);
  answers.shift()?.(run);
  await passes();
});

test("no lane is offered where a restriction keeps the lanes as they are", () => {
  setField("lanes", ["tracer", "greedy"]);
  assert.equal(missingLane.value?.action?.label, "Add Learner");
  restriction.value = { bounds: { alpha: {} }, reason: "The example sets" };
  assert.deepEqual([missingLane.value?.words, missingLane.value?.action],
    ["Learner is not in the race; Tracer will learn and race.", null]);
  isLifted.value = true;
  assert.ok(missingLane.value?.action, "the reader has opened all settings");
  [restriction.value, isLifted.value] = [null, false];
  setField("lanes", ["learner", "greedy"]);
});

test("while the server is away nothing is started, held or stopped, by no key either", async () => {
  const run = makeRun({ id: "a", state: "running", result: null, progress: { done: 5, total: 500 } });
  applyEvent("snapshot", { role: "operator", runs: [], stage: STAGE, scene: SCENE });
  assert.ok(canStart.value);
  connection.value = "reconnecting";
  assert.ok(!canStart.value);
  togglePlaying();
  applyEvent("snapshot", { role: "operator", runs: [run], stage: STAGE, scene: SCENE });
  pause();
  stop();
  togglePause();
  await answerAll(() => STAGE);
  assert.deepEqual(sent, []);
  connection.value = "live";
  stop();
  await answerAll(() => ({ ...run, state: "stopped" }));
  assert.equal(sent[0], "stop");
});
