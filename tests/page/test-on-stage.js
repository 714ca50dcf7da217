// What is on stage, what is computed, and whose time is shown.
import assert from "node:assert/strict";
import { beforeEach, test } from "node:test";
import {
  interruptedRun, isPlaying, offStage, progress, resumableOnStage, steering, windowTitle,
} from "../../static/js/on-stage.js";
import { markAsMine } from "../../static/js/selectors.js";
import { page } from "../../static/js/page-state.js";
import { applyEvent, connection, isLockedOut, options } from "../../static/js/store.js";
import { makeRun, makeStage, OPTIONS } from "./options.js";

/** @import { Run } from "../../static/js/types.js" */

const STAGE = makeStage();

/** Put a run on stage, whose first lane is at a step. @type {(run: Run, step: number, stage?: object) => object} */
const showing = (run, step, stage = {}) => ({
  role: "operator",
  stage: { ...STAGE, run_id: run.id, phase: "live", origin: "started", ...stage },
  scene: {
    run_id: run.id, kind: run.kind, label: `${run.name}, step ${step}`, phase: "practice", time_s: step,
    duration_s: 500,
    computed_s: run.progress.done, time_out_s: null, ended: false, shown_speed: 2, lanes: [{ lane: 0, step }],
  },
});

/** @param {Run[]} runs @param {object} rest */
const snapshot = (runs, rest) => applyEvent("snapshot", { runs, ...rest });

const practice = (/** @type {object} */ changes = {}) =>
  makeRun({ state: "running", progress: { done: 312, total: 500 }, eta_s: null, ...changes });

beforeEach(() => {
  options.value = OPTIONS;
  connection.value = "live";
  isLockedOut.value = false;
});

test("two times are told while the computation is ahead of the picture, and one while it is not", () => {
  const run = practice();
  snapshot([run], showing(run, 25));
  assert.equal(progress.value?.label, "Practising: 25 shown ▸ 312 of 500 steps computed");
  assert.deepEqual([progress.value?.share, progress.value?.shown], [312 / 500, 25 / 500]);
  snapshot([run], showing(run, 312));
  assert.equal(progress.value?.label, "Practising, 312 of 500 steps");
});

test("work that is not on stage is said not to be", () => {
  const [run, other] = [practice(), practice({ state: "finished", progress: { done: 500, total: 500 } })];
  markAsMine(run.id);
  snapshot([run, other], showing(other, 20, { phase: "showing", origin: "chosen" }));
  assert.equal(progress.value?.label, "Practising, 312 of 500 steps, not on the stage");
  assert.equal(offStage.value?.id, run.id);
});

test("a picture that is behind a finished computation says so, and a replay does not", () => {
  const run = practice({ state: "finished", progress: { done: 500, total: 500 } });
  snapshot([run], showing(run, 25, { phase: "showing" }));
  assert.equal(progress.value?.label, "Showing the training, which is computed to its end");
  assert.deepEqual([progress.value?.share, progress.value?.shown], [1, 0.05]);
  snapshot([run], showing(run, 25, { phase: "showing", origin: "chosen" }));
  assert.equal(progress.value?.label, "Replaying the training");
});

test("a slider says what it acts on: a step ahead of the picture, the next training, or what is shown", () => {
  const run = practice();
  snapshot([run], showing(run, 25));
  assert.deepEqual(steering.value, { step: 313, shown: 25 });
  snapshot([run], showing(run, 311));
  assert.equal(steering.value, null);
  const ended = { ...run, state: /** @type {const} */ ("finished"), progress: { done: 500, total: 500 } };
  snapshot([ended], showing(ended, 25, { phase: "showing" }));
  assert.equal(steering.value, "computed");
  snapshot([ended], showing(ended, 500, { phase: "ended", ended: true }));
  assert.equal(steering.value, null);
});

test("an interrupted training is resumed with the race that needs it", () => {
  const training = practice({ state: "interrupted", can_resume: true });
  const config = { lanes: [{ agent: "learner", training_id: training.id }], steps: 50 };
  const race = makeRun({ kind: "race", state: "interrupted", can_resume: true, config });
  snapshot([race, training], showing(training, 312, { phase: "ended", ended: true }));
  assert.equal(resumableOnStage.value?.id, race.id);
  assert.equal(interruptedRun.value, null, "the stage offers it");
  const other = makeRun({ state: "finished" });
  snapshot([race, training, { ...other, created_at: "2001-01-01T00:00:00Z" }], showing(other, 1));
  assert.deepEqual([resumableOnStage.value, interruptedRun.value], [null, race]);
});

test("the window's title tells what is shown", () => {
  const run = practice({ name: "Evening" });
  snapshot([run], showing(run, 25));
  assert.equal(windowTitle("race", null), "Evening, step 25 · Racing Hexapods");
  assert.equal(windowTitle("race", "Greedy leads with 0.31 m"), "Greedy leads with 0.31 m · Racing Hexapods");
  assert.equal(windowTitle("runs", "Greedy leads with 0.31 m"), "Runs · Racing Hexapods");
  connection.value = "reconnecting";
  assert.equal(windowTitle("runs", null), "Reconnecting · Runs · Racing Hexapods");
  isLockedOut.value = true;
  assert.equal(windowTitle("race", null), "No access · Racing Hexapods");
  isLockedOut.value = false;
  connection.value = "live";
  snapshot([], { stage: STAGE, scene: null });
  assert.equal(windowTitle("race", null), "Racing Hexapods");
});

test("while the server is away nothing is said to go on: of work the last that is known is told", () => {
  const run = practice({ eta_s: 35 });
  snapshot([run], showing(run, 311));
  assert.deepEqual([progress.value?.left, isPlaying.value], ["35 s left", true]);
  connection.value = "reconnecting";
  assert.deepEqual([progress.value?.label, progress.value?.left, progress.value?.share],
    ["Last known: practising, 312 of 500 steps", "", 312 / 500]);
  assert.equal(isPlaying.value, false);
  snapshot([run], showing(run, 25));
  assert.deepEqual([steering.value, offStage.value], [null, null]);
  const ended = practice({ state: "finished", progress: { done: 500, total: 500 } });
  snapshot([ended], showing(ended, 25, { phase: "showing" }));
  assert.equal(progress.value, null);
  // A replay of the page's own goes on with what is loaded.
  page.run.value = ended.id;
  assert.equal(isPlaying.value, true);
  page.run.value = null;
});
