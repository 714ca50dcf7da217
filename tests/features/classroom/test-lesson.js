// The first lesson: its cards, what they open of the page, and a prediction that is revealed at time-out.
import assert from "node:assert/strict";
import { beforeEach, test } from "node:test";
import {
  card, cardNumber, cards, closeLesson, openCard, openLesson, outcome, predict, predictable, prediction, turnCard,
} from "../../../static/features/classroom/lesson.js";
import { change, page, read } from "../../../static/js/page-state.js";
import { applyEvent, options } from "../../../static/js/store.js";
import { depth, setDepth } from "../../../static/js/workspace.js";
import { installOnly } from "../../page/features.js";
import { makeRun, makeSceneLane, makeStage, OPTIONS } from "../../page/options.js";

/** @import { Run } from "../../../static/js/types.js" */

await installOnly("classroom");
const firstOfAll = [cardNumber.value, card.value?.title];

const lanes = [{ agent: "learner" }, { agent: "greedy" }];
const [RACE, NEXT] = [1, 2].map((n) =>
  makeRun({ id: `race-${n}`, kind: "race", progress: { done: 9, total: 9 }, config: { steps: 50, lanes } }));

/** Show a race at a time, with its time-out at 16 s, when Greedy is ahead. @param {number} time_s @param {Run} race */
const showAt = (time_s, race = RACE, role = "operator") => applyEvent("snapshot", {
  role, runs: [race], stage: makeStage({ run_id: race.id, phase: "showing" }),
  scene: {
    run_id: race.id, kind: "race", phase: "race", time_s, duration_s: 20, computed_s: 20, time_out_s: 16, ended: false,
    lanes: [
      makeSceneLane({ rank: 2 }),
      makeSceneLane({ lane: 1, name: "Greedy", rank: 1, ...(time_s < 16 ? {} : { step: 50, done: true }) }),
    ],
  },
});

beforeEach(() => {
  options.value = OPTIONS;
  read({ search: "", hash: "" });
  setDepth("watch");
  showAt(1);
});

test("at the first visit the first card is open", () => {
  assert.deepEqual(firstOfAll, [1, "Moves"]);
});

test("cards are turned forward and back, and after the last the lesson is over for good", () => {
  openLesson();
  turnCard(1);
  assert.equal(page.card.value, 2);
  turnCard(-1);
  turnCard(-1);
  assert.equal(cardNumber.value, 1, "there is none before the first");
  openCard(cards.value.length);
  turnCard(1);
  assert.deepEqual([page.card.value, card.value], [null, null]);
  openLesson();
  assert.equal(cardNumber.value, 1);
  closeLesson();
  assert.equal(cardNumber.value, null);
});

test("a card opens of the page what it is about, and leaves all else as it is", () => {
  change({ run: "a", camera: "2", hidden: ["card"], view: "runs" });
  const number = cards.value.findIndex(({ state }) => state?.tab === "train") + 1;
  openCard(number);
  assert.deepEqual([page.view.value, page.tab.value, depth.value, cardNumber.value], ["race", "train", "try", number]);
  assert.deepEqual([page.run.value, page.camera.value, page.hidden.value], ["a", "2", []]);
});

test("who may start no runs has the cards that need none", () => {
  const all = cards.value.length;
  showAt(1, RACE, "spectator");
  assert.ok(cards.value.length < all);
  assert.ok(cards.value.every(({ isForOperators }) => !isForOperators));
  change({ card: all });
  assert.equal(cardNumber.value, null, "a link to a card that they do not have opens none");
});

test("a lesson can be hidden by a link, and the numbers of cards begin with 1", () => {
  change({ card: 2, hidden: ["card"] });
  assert.equal(card.value, null);
  assert.equal(cards.value[1].title, "Colours on the feet");
});

test("one lane is predicted, once, before the time-out; then it is told who was ahead", () => {
  assert.deepEqual(predictable.value.map(({ lane, title }) => [lane, title]), [[0, "Learner"], [1, "Greedy"]]);
  assert.deepEqual([prediction.value, outcome.value], [null, null]);
  predict(0);
  predict(1);
  assert.equal(prediction.value, 0);
  showAt(16);
  assert.deepEqual([prediction.value, outcome.value?.map(({ title }) => title)], [0, ["Greedy"]]);
});

test("a prediction is of one race, and none is made of a race that is decided", () => {
  showAt(1, NEXT);
  assert.equal(prediction.value, null);
  showAt(16, NEXT);
  predict(1);
  assert.equal(prediction.value, null);
});
