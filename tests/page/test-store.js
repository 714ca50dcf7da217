// Server-sent events change the store, and the selectors follow.
import assert from "node:assert/strict";
import { beforeEach, test } from "node:test";
import { copySettings, primaryAction } from "../../static/js/actions.js";
import { enter, form, setField, setFields, trainingBody } from "../../static/js/form.js";
import { page } from "../../static/js/page-state.js";
import { shownTime } from "../../static/js/race.js";
import {
  interruptedRun, isPlaying, isRaceRun, laneTables, liveTraining, matchingTable, myWork, offStage, playbackName,
  raceInView, trainingInView, work,
} from "../../static/js/on-stage.js";
import { everyRun, hasTable, markAsMine, simulatedPerDecision } from "../../static/js/selectors.js";
import { learns } from "../../static/js/settings.js";
import {
  applyEvent, damagedRuns, evaluations, isGone, markGone, options, rates, requestRun, requestRuns, requestStage,
  role, runs, stage,
} from "../../static/js/store.js";
import { makeRun, makeStage, OPTIONS } from "./options.js";

const STAGE = makeStage({ speed: 1 });

/** @param {{ runs?: object[], stage?: object }} parts */
const show = (parts) => applyEvent("snapshot", { runs: [], stage: STAGE, scene: null, role: "operator", ...parts });

const raceOf = (/** @type {{ id: string }} */ training, changes = {}) =>
  makeRun({
    kind: "race",
    config: { lanes: [{ agent: "learner", training_id: training.id }, { agent: "greedy" }], steps: 50 },
    ...changes,
  });

beforeEach(() => {
  options.value = OPTIONS;
  page.form.value = new URLSearchParams();
  show({});
});

test("a snapshot replaces what was known", () => {
  applyEvent("run", makeRun({}));
  const [first, second] = [makeRun({}), makeRun({})];
  show({ runs: [first, second] });
  assert.deepEqual(everyRun.value.map(({ id }) => id), [second.id, first.id]);
  assert.equal(role.value, "operator");
});

test("events add, change and delete", () => {
  const run = makeRun({ state: "queued" });
  applyEvent("run", run);
  applyEvent("run", { ...run, state: "running" });
  assert.equal(runs.value.get(run.id)?.state, "running");
  applyEvent("evaluation", { run_id: run.id, step: 50, distance_m: 0.1, epsilon: 0.9 });
  applyEvent("evaluation", { run_id: run.id, step: 100, distance_m: 0.2, epsilon: 0.8 });
  assert.deepEqual(evaluations.value[run.id].map(({ step }) => step), [50, 100]);
  applyEvent("rates", { run_id: run.id, alpha: 0.5 });
  applyEvent("rates", { run_id: run.id, epsilon: 0.1 });
  assert.deepEqual(rates.value[run.id], { alpha: 0.5, epsilon: 0.1 });
  applyEvent("run-deleted", { id: run.id });
  assert.equal(runs.value.size, 0);
  applyEvent("an event of a later version", {});
});

/** An answer that comes after the events of `meanwhile`. */
const answerAfter = (/** @type {() => void} */ meanwhile, /** @type {any} */ answer) => () => {
  meanwhile();
  return Promise.resolve(answer);
};

test("an answer does not undo the events that overtook it", async () => {
  const [run, deleted] = [makeRun({ state: "queued" }), makeRun({})];
  const meanwhile = () => {
    applyEvent("run", { ...run, state: "finished" });
    applyEvent("run-deleted", { id: deleted.id });
    applyEvent("stage", { ...STAGE, run_id: run.id });
  };
  assert.equal((await requestRun(answerAfter(meanwhile, run))).state, "queued");
  assert.deepEqual([isGone(deleted.id), isGone(run.id)], [true, false]);
  assert.equal(runs.value.get(run.id)?.state, "finished");
  await requestRuns(answerAfter(meanwhile, { items: [run, deleted] }));
  assert.deepEqual([...runs.value.values()].map(({ state }) => state), ["finished"]);
  await requestStage(answerAfter(meanwhile, STAGE));
  assert.equal(stage.value?.run_id, run.id);
});

test("a stage that shows its run's end does not play; it is the stage whether its run is computed or recorded", () => {
  const [done, live] = [makeRun({}), makeRun({ state: "running" })];
  show({ runs: [done, live], stage: { ...STAGE, run_id: done.id, ended: false } });
  assert.deepEqual([isPlaying.value, playbackName.value], [true, "stage"]);
  applyEvent("stage", { ...STAGE, run_id: done.id, ended: true });
  assert.equal(isPlaying.value, false);
  applyEvent("stage", { ...STAGE, run_id: live.id, ended: false });
  assert.deepEqual([isPlaying.value, playbackName.value], [true, "stage"]);
});

test("a deleted run is marked before its event comes, until it is imported again", () => {
  const run = makeRun({});
  applyEvent("run", run);
  markGone(run.id);
  assert.deepEqual([isGone(run.id), runs.value.has(run.id)], [true, false]);
  applyEvent("run", run);
  assert.deepEqual([isGone(run.id), runs.value.has(run.id)], [false, true]);
});

test("an answer does not undo a snapshot, but tells of runs that the snapshot had no room for", async () => {
  const [run, older] = [makeRun({ state: "queued" }), makeRun({})];
  const meanwhile = () => show({ runs: [{ ...run, state: "finished" }], stage: { ...STAGE, run_id: run.id } });
  await requestRuns(answerAfter(meanwhile, { items: [run, older] }));
  assert.equal(runs.value.get(run.id)?.state, "finished");
  assert.ok(runs.value.has(older.id));
  await requestStage(answerAfter(meanwhile, STAGE));
  assert.equal(stage.value?.run_id, run.id);
});

test("an answer that no event has overtaken is taken in", async () => {
  const run = makeRun({ state: "running" });
  applyEvent("run", run);
  const other = () => applyEvent("run", makeRun({}));
  await requestRun(answerAfter(other, { ...run, state: "paused" }));
  assert.equal(runs.value.get(run.id)?.state, "paused");
  await requestStage(answerAfter(other, { ...STAGE, playing: false }));
  assert.equal(stage.value?.playing, false);
});

test("a damaged run is kept apart, until it can be read or is deleted", () => {
  const run = makeRun({});
  const damaged = { id: run.id, kind: null, name: null, created_at: null, damaged: "its config cannot be read" };
  show({ runs: [damaged] });
  assert.deepEqual([runs.value.size, damagedRuns.value.size], [0, 1]);
  applyEvent("run", run);
  assert.deepEqual([runs.value.size, damagedRuns.value.size], [1, 0]);
  applyEvent("run", damaged);
  assert.deepEqual([runs.value.size, damagedRuns.value.size], [0, 1]);
  applyEvent("run-deleted", { id: run.id });
  assert.equal(damagedRuns.value.size, 0);
});

test("agents that the server no longer has are known by their name and do not learn", () => {
  assert.ok(learns("learner"));
  assert.ok(!learns("removed"));
});

test("a race that waits works on its training, which Stop asks of the race", () => {
  const training = makeRun({ state: "running" });
  const race = raceOf(training, { state: "queued" });
  show({ runs: [training, race], stage: { ...STAGE, run_id: training.id } });
  assert.equal(work.value?.requested.id, race.id);
  assert.equal(work.value?.current.id, training.id);
  assert.equal(liveTraining.value?.id, training.id);
  assert.equal(raceInView.value?.id, race.id);
  assert.equal(trainingInView.value?.id, training.id);
});

test("between two trainings of a race it is the race that is in view", () => {
  const [first, second] = [makeRun({}), makeRun({})];
  const race = raceOf(first, { config: { steps: 50, lanes: [first, second].map(({ id }) => ({ training_id: id })) } });
  const next = { ...STAGE, run_id: first.id, next_run_id: second.id };
  show({ runs: [first, second, race], stage: next });
  assert.equal(raceInView.value?.id, race.id);
  assert.equal(shownTime.value, null);
  show({ runs: [first, second, race], stage: { ...next, next_run_id: race.id } });
  assert.equal(raceInView.value?.id, race.id);
  assert.equal(shownTime.value, null);
});

test("my run is off stage while another live run is shown", () => {
  const [mine, other] = [makeRun({ state: "running" }), makeRun({ state: "running" })];
  show({ runs: [mine, other], stage: { ...STAGE, run_id: other.id } });
  const offStageId = () => offStage.value?.id;
  assert.equal(offStageId(), undefined);
  markAsMine(mine.id);
  assert.equal(myWork.value?.requested.id, mine.id);
  assert.equal(offStageId(), mine.id);
  show({ runs: [mine, other], stage: { ...STAGE, run_id: mine.id } });
  assert.equal(offStageId(), undefined);
});

test("a table matches the form by gait, robot, grid, observation and simulator", () => {
  const training = makeRun({});
  const race = raceOf(training);
  show({ runs: [training, race], stage: { ...STAGE, run_id: race.id } });
  assert.equal(matchingTable.value?.id, training.id);
  assert.ok(isRaceRun.value);
  setField("alpha", 0.9);
  assert.equal(matchingTable.value?.id, training.id);
  setField("divisions", 3);
  assert.equal(matchingTable.value, null);
  assert.ok(!isRaceRun.value);
});

test("the button names no number of steps while the field has a text that is none", () => {
  const label = () => primaryAction.value.label;
  assert.equal(label(), "Train 500 steps, then race");
  // A phone has room for what it does, and not for how long.
  assert.equal(primaryAction.value.short, "Train, then race");
  enter("steps", "abc");
  assert.equal(label(), "Train, then race");
  const training = makeRun({});
  const race = raceOf(training);
  show({ runs: [training, race], stage: { ...STAGE, run_id: race.id } });
  assert.equal(label(), "Practise more, race again");
  enter("alpha", "seven");
  enter("steps", "750");
  assert.equal(label(), "Practise 750 more, race again");
});

test("the settings of a run with a custom robot are taken with all of the robot", () => {
  const robot = { preset: "stiff", femur_m: 0.1 };
  const training = makeRun({ config: { ...makeRun({}).config, robot } });
  const tableId = () => matchingTable.value?.id;
  const preset = makeRun({ config: { ...makeRun({}).config, robot: { preset: "stiff" } } });
  show({ runs: [training], stage: { ...STAGE, run_id: training.id } });
  // A table of another robot is none of the preset's.
  assert.equal(tableId(), undefined);
  copySettings(training);
  assert.deepEqual(trainingBody().robot, robot);
  assert.equal(tableId(), training.id);
  show({ runs: [preset], stage: { ...STAGE, run_id: preset.id } });
  assert.equal(tableId(), undefined);
  copySettings(preset);
  assert.equal(trainingBody().robot, "stiff");
  assert.equal(tableId(), preset.id);
});

test("a table is of its learner, and each learner of a race needs one", () => {
  const training = makeRun({});
  show({ runs: [training], stage: { ...STAGE, run_id: training.id } });
  assert.deepEqual(laneTables.value, { learner: training.id });
  setFields({ agent: "tracer", lanes: ["learner", "tracer"] });
  const tables = () => [matchingTable.value?.id, laneTables.value];
  assert.deepEqual(tables(), [undefined, null]);
  const other = makeRun({ config: { ...training.config, agent: "tracer" } });
  const race = raceOf(training, {
    config: { steps: 50, lanes: [training, other].map(({ id, config }) => ({ agent: config.agent, training_id: id })) },
  });
  show({ runs: [training, other, race], stage: { ...STAGE, run_id: race.id } });
  assert.deepEqual(tables(), [other.id, { learner: training.id, tracer: other.id }]);
  assert.ok(isRaceRun.value);
  setField("lanes", ["greedy"]);
  assert.equal(laneTables.value, null);
});

test("only trainings that ended have a table", () => {
  assert.ok(hasTable(makeRun({ state: "stopped" })));
  assert.ok(!hasTable(makeRun({ state: "running" })));
  assert.ok(!hasTable(raceOf(makeRun({}))));
  assert.ok(!hasTable(null));
});

test("an interrupted run is offered while nothing works", () => {
  const run = makeRun({ state: "interrupted" });
  show({ runs: [run] });
  assert.equal(interruptedRun.value?.id, run.id);
  show({ runs: [run, makeRun({ state: "running" })] });
  assert.equal(interruptedRun.value, null);
});

test("simulated transitions grow with the depth and the grid", () => {
  // Three pairs of legs, and on a grid of two divisions five places, of which each pair is at one.
  assert.equal(simulatedPerDecision(1, form.value), 12);
  assert.equal(simulatedPerDecision(2, form.value), 12 + 144);
  assert.equal(simulatedPerDecision(1, { ...form.value, divisions: 3 }), 24);
});
