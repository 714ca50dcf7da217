// The first lesson: what happens on the page turns its cards, the race answers the vote, and it is kept.
import assert from "node:assert/strict";
import { beforeEach, test } from "node:test";
import lessons, {
  card, cardNumber, cards, closeLesson, followLesson, openCard, openLesson,
} from "../../../static/features/classroom/feature.js";
import { FIRST, vote, voteFor } from "../../../static/features/classroom/first-lesson.js";
import { keep, lessonProgress, restart } from "../../../static/features/classroom/lesson.js";
import { change, page, read } from "../../../static/js/page-state.js";
import { applyEvent, connection, options } from "../../../static/js/store.js";
import { explainingTab, setDepth } from "../../../static/js/workspace.js";
import { installOnly } from "../../page/features.js";
import { makeRun, makeSceneLane, makeStage, OPTIONS } from "../../page/options.js";

/** @import { Run } from "../../../static/js/types.js" */

await installOnly("classroom", "explanations");
options.value = OPTIONS;
followLesson();

const PRACTICE = makeRun({ id: "practice", state: "running", progress: { done: 140, total: 500 } });
const PRACTISED = { ...PRACTICE, state: /** @type {const} */ ("finished"), progress: { done: 500, total: 500 } };
const LANES = [{ agent: "learner", training_id: "practice" }, { agent: "greedy" }];
const RACE = makeRun({
  id: "race", kind: "race", progress: { done: 9, total: 9 }, config: { steps: 50, lanes: LANES, gait: "tripod" },
});
const OTHERS = makeRun({ id: "others", kind: "race", config: { ...RACE.config, lanes: [{ agent: "greedy" }] } });
/** What was requested: verb, path and body. @type {any[]} */
let requests = [];
globalThis.fetch = (address, request) => {
  const path = String(address).split("/api/v1/")[1];
  requests.push([request?.method ?? "GET", path, request?.body && JSON.parse(String(request.body))]);
  const started = { ...PRACTICE, id: "started", state: "queued" };
  return Promise.resolve(new Response(JSON.stringify(path === "trainings" ? started : RACE)));
};

/** @type {(runs: Run[], onStage: Run | null, scene: object | null, how?: any) => void} */
const show = (runs, onStage, scene, { role = "operator", origin = "started" } = {}) => applyEvent("snapshot", {
  role, runs, stage: makeStage({ run_id: onStage?.id ?? null, phase: onStage ? "showing" : "empty", origin }),
  scene: onStage && scene && { run_id: onStage.id, kind: onStage.kind, ended: false, playing: true, ...scene },
});

/** Show the practice at a step. @param {number} step @param {Run} [run] @param {string} [role] */
const practiseTo = (step, run = PRACTICE, role = "operator") => show([run], run, {
  phase: "training", time_s: step, duration_s: 500, computed_s: 140, time_out_s: null,
  ended: step >= 500, lanes: [makeSceneLane({ step, steps: 500, steps_made: step })],
}, { role });

/** Show the race at a time, with its time-out at 16 s, when Greedy is ahead. @param {number} time_s */
const raceTo = (time_s, role = "operator", origin = "started") => show([PRACTISED, RACE], RACE, {
  phase: "race", time_s, duration_s: 20, computed_s: 20, time_out_s: 16,
  lanes: [
    makeSceneLane({ rank: 2, step: 9, distance_m: 0.1 }),
    makeSceneLane({
      lane: 1, name: "Greedy", rank: 1, distance_m: 0.3, ...(time_s < 16 ? {} : { step: 50, done: true }),
    }),
  ],
}, { role, origin });

const test_ = (/** @type {number} */ step, /** @type {number} */ distance_m) =>
  applyEvent("evaluation", { run_id: "practice", step, episode: 0, epsilon: 0.9, distance_m });

const at = () => lessonProgress.value.at;
const label = () => card.value?.press?.label ?? null;
const press = () => card.value?.press?.run();

beforeEach(() => {
  requests = [];
  read({ search: "", hash: "" });
  setDepth("watch");
  show([], null, null);
  restart();
});

test("at the first visit the first card is open, and its button starts a practice that can be changed", async () => {
  assert.deepEqual([cardNumber.value, label()], [1, "Let it practise"]);
  await press();
  assert.deepEqual(requests.map(([method, path]) => `${method} ${path}`), ["POST trainings"]);
  assert.deepEqual([requests[0][2].agent, requests[0][2].pace], ["learner", 2]);
  assert.deepEqual([lessonProgress.value.practice, at()], ["started", "start"], "it comes on with the picture alone");
});

test("its practice, its first test and a test after the change of α each bring their card", () => {
  keep({ practice: "practice", isMine: true });
  practiseTo(1);
  assert.deepEqual([at(), label()], ["tries", "Explain this step"]);
  test_(50, 0.04);
  assert.equal(at(), "tries", "the picture is not there yet");
  practiseTo(50);
  assert.deepEqual([at(), card.value?.title, label()], ["test", "First test: 0.04\u00a0m.", "Set α to 0.9"]);
  press();
  assert.deepEqual([at(), card.value?.title], ["changed", "α is 0.3."]);
  const changed = { ...PRACTICE, changes: [{ step: 60, settings: { alpha: 0.9 } }] };
  practiseTo(99, /** @type {Run} */ (changed));
  assert.deepEqual([at(), card.value?.title], ["changed", "α is 0.9 from step 60."]);
  test_(100, 0.14);
  practiseTo(100, /** @type {Run} */ (changed));
  assert.deepEqual([at(), card.value?.title], ["newest", "Newest test: 0.14\u00a0m, before 0.04\u00a0m."]);
});

test("a step that is read is not taken away by what happens; on leaving it the lesson goes on", () => {
  change({ tab: "why" });
  keep({ at: "step", practice: "practice", isMine: true });
  practiseTo(100);
  test_(50, 0.04);
  assert.equal(at(), "step");
  change({ tab: "board" });
  assert.equal(at(), "test");
});

test("the vote is made before the race, and is beside its outcome at the photo finish", async () => {
  keep({ at: "vote", practice: "practice", isMine: true });
  practiseTo(500, PRACTISED);
  assert.deepEqual([card.value?.press, explainingTab.value], [null, null], "nothing else is asked meanwhile");
  voteFor("learner");
  assert.deepEqual([at(), card.value?.title, label()], ["ready", "Your vote: Learner.", "Start the race"]);
  await press();
  assert.deepEqual(requests[0][2].lanes, LANES);
  raceTo(1);
  assert.equal(at(), "race");
  voteFor("greedy");
  assert.equal(vote.value, "greedy", "until it is decided it can be changed");
  raceTo(16);
  assert.deepEqual([at(), label()], ["finish", "Why?"]);
  assert.match(card.value?.title ?? "", /^Greedy wins/);
  assert.match(card.value?.text ?? "", /^Your vote: Greedy\. .*\?$/);
  voteFor("learner");
  assert.equal(vote.value, "greedy");
  raceTo(2);
  press();
  assert.match(card.value?.text ?? "", /Greedy: .* steps of /, "a replay does not take the answer away");
});

test("what happened while the page was away or hidden is made up for", () => {
  keep({ at: "ready", practice: "practice", race: "race", isMine: true, vote: "greedy" });
  closeLesson();
  raceTo(16);
  assert.deepEqual([card.value, at()], [null, "ready"]);
  openLesson();
  assert.equal(at(), "finish");
});

test("where the picture is of another run, or another tab is open, the press mends that first", () => {
  keep({ at: "changed", practice: "practice", isMine: true });
  practiseTo(60);
  assert.equal(label(), "Practise faster");
  change({ depth: "try", tab: "world" });
  assert.equal(label(), "To the board");
  press();
  assert.equal(page.tab.value, "board");
  show([PRACTICE, OTHERS], OTHERS, { phase: "race", time_s: 1, lanes: [] });
  assert.equal(label(), "Show the practice");
});

test("a practice that was stopped goes on, or the lesson begins again", () => {
  keep({ at: "changed", practice: "practice", isMine: true });
  practiseTo(60, { ...PRACTICE, state: "interrupted", can_resume: true });
  assert.deepEqual([card.value?.title, label()], ["The training was interrupted.", "Go on"]);
  practiseTo(60, { ...PRACTICE, state: "stopped", can_resume: false });
  press();
  assert.equal(at(), "start");
});

test("a practice that is over before α was changed is practised again", async () => {
  keep({ at: "test", practice: "practice", isMine: true });
  practiseTo(500, PRACTISED);
  assert.equal(label(), "Practise again");
  await press();
  assert.deepEqual([at(), requests.length], ["start", 1]);
});

test("who may start nothing votes while there is nothing, watches what there is, and changes nothing", () => {
  show([], null, null, { role: "spectator" });
  assert.equal(card.value?.press, null);
  voteFor("greedy");
  assert.equal(at(), "start");
  practiseTo(1, PRACTICE, "spectator");
  assert.equal(at(), "tries");
  test_(50, 0.04);
  practiseTo(50, PRACTICE, "spectator");
  assert.deepEqual([at(), label()], ["test", "See its newest test"]);
  raceTo(1, "spectator");
  assert.equal(at(), "race", "it has voted before");
  raceTo(16, "spectator");
  assert.equal(at(), "finish");
  assert.ok(!cards.value.some(({ title }) => title.startsWith("α is")));
  assert.equal(requests.length, 0);
});

test("who comes while a race is on is asked for a vote until its time-out", () => {
  raceTo(3, "spectator");
  assert.deepEqual([at(), lessonProgress.value.race], ["vote", null]);
  voteFor("learner");
  assert.deepEqual([at(), lessonProgress.value.race], ["race", "race"]);
});

test("an ended race is there for a spectator from its practice on", () => {
  raceTo(16, "spectator", "restored");
  assert.deepEqual([at(), label()], ["start", "Watch it practise"]);
  press();
  assert.deepEqual([lessonProgress.value.practice, page.run.value], ["practice", "practice"]);
});

test("who may start runs and finds the practice of others follows it, and does not change it", () => {
  practiseTo(60);
  test_(50, 0.04);
  assert.deepEqual([at(), lessonProgress.value.isMine], ["test", false]);
  assert.equal(label(), "See its newest test");
});

test("the last card leads to what the page can do, and the lesson is over until it is asked for", () => {
  keep({ at: "turn", practice: "practice" });
  press();
  assert.deepEqual([card.value, page.tab.value, page.depth.value], [null, "train", "try"]);
  openLesson();
  assert.equal(cardNumber.value, 1);
});

test("a link opens a card, and can hide it; what the browser keeps may be damaged", () => {
  read({ search: "?card=99", hash: "" });
  assert.deepEqual([cardNumber.value, page.card.value], [FIRST.length, null]);
  read({ search: "?hidden=card", hash: "" });
  assert.equal(card.value, null);
  openCard(2);
  assert.deepEqual([cardNumber.value, page.hidden.value], [2, []]);
  keep({ at: "nonsense" });
  assert.equal(cardNumber.value, 1);
});

test("the menu hides the lesson and brings it back", () => {
  const row = lessons.menu?.at(-1);
  const words = () => (typeof row?.title === "function" ? row.title() : row?.title);
  assert.equal(words(), "Hide the lesson");
  row?.run?.();
  assert.deepEqual([card.value, words()], [null, "The first lesson"]);
  row?.run?.();
  assert.equal(cardNumber.value, 1);
});

test("while the server is away the card says so, and holds what is to be pressed", () => {
  practiseTo(1, PRACTICE, "spectator");
  connection.value = "reconnecting";
  assert.deepEqual([card.value?.title, card.value?.press?.isHeld], ["It tries moves.", true]);
  assert.match(card.value?.text ?? "", /^The server is away\./);
  connection.value = "live";
  assert.match(card.value?.text ?? "", /^At random/);
});

test("of a practice that a crash has ended a spectator watches what there is, and of a race another one", () => {
  const crashed = { ...PRACTICE, state: /** @type {const} */ ("interrupted"), can_resume: true };
  keep({ at: "tries", practice: "practice" });
  practiseTo(60, /** @type {Run} */ (crashed), "spectator");
  assert.deepEqual([card.value?.title, label()], ["First test: 0.04\u00a0m.", "See its newest test"]);
  keep({ at: "race", race: "race", vote: "greedy" });
  const cut = /** @type {Run} */ ({ ...RACE, state: "interrupted" });
  show([cut, { ...OTHERS, progress: { done: 9, total: 9 } }], cut, {
    phase: "race", time_s: 3, time_out_s: null, lanes: [makeSceneLane({ step: 2 })],
  }, { role: "spectator" });
  assert.deepEqual([card.value?.title, label()], ["The race was interrupted.", "Back to the start"]);
  press();
  assert.deepEqual([at(), label()], ["ready", "Watch the race"]);
});
