// A room's page without a server: drawn answers, scores in words, settings within a card's bounds.
import assert from "node:assert/strict";
import { beforeEach, test } from "node:test";
import {
  afterKey, drawn, HIGHEST_M, inWords, KNOTS, knotsOf, LOWEST_M, pointAt, stepsOf,
} from "../../../static/features/classroom/room/chart.js";
import { chosenSettings, givenInWords } from "../../../static/features/classroom/room/allowed-settings.js";
import { answerInWords, draftOf, KINDS, scoreInWords } from "../../../static/features/classroom/room/questions.js";
import { axisOf } from "../../../static/features/classroom/room/scores.js";
import { withPresses } from "../../../static/features/classroom/room/teaching.js";
import { options } from "../../../static/js/store.js";
import { OPTIONS } from "../../page/options.js";

/** @import { Ask, LessonCard, ResultEntry } from "../../../static/js/types.js" */

test("a step that both an event and an answer have counts once", () => {
  /** @param {number} step */
  const praised = (step) => ({ step, plus: 1, minus: 0, value: 1 });
  const both = withPresses([praised(0), praised(2)], [praised(2), praised(3), praised(1)]);
  assert.deepEqual(both.map(({ step }) => step), [0, 1, 2, 3]);
});

beforeEach(() => (options.value = OPTIONS));

/** @type {(ask: Partial<Ask>) => Ask} */
const makeAsk = (ask) =>
  ({ kind: "number", text: "How far?", choices: [], minimum: null, maximum: null, unit: "m", ...ask });

/** @type {(score: object, prediction?: any) => ResultEntry} */
const entry = (score, prediction = 0.4) => ({
  seed: 0, name: "Keen Ant", is_own: true, prediction, run: null, gain: null,
  score: { is_right: null, share: null, quantile: null, error: null, ...score },
});

// ---- the chart

test("a touch is a point within the chart, to the step and the centimetre", () => {
  assert.deepEqual(pointAt(0, 0, 300), [0, HIGHEST_M]);
  assert.deepEqual(pointAt(0.5, 1, 300), [150, LOWEST_M]);
  assert.deepEqual(pointAt(2, -1, 300), [300, HIGHEST_M], "beyond it is at its edge");
  assert.equal(inWords([150, 0.3]), "0.30\u00a0m after 150 steps");
});

test("the steps are those of the card's practice", () => {
  assert.equal(stepsOf({ state: { form: { steps: "250" } } }), 250);
  assert.equal(stepsOf({}), 500);
});

test("a stroke draws the points that it passes, and leaves those that it does not", () => {
  const first = drawn(null, [0, 0], [0, 0], 800);
  assert.deepEqual(first, Array.from({ length: KNOTS }, () => 0), "the first touch gives all its height");
  const half = drawn(first, [0, 0], [400, 0.4], 800);
  assert.deepEqual(half.slice(0, 5), [0, 0.1, 0.2, 0.3, 0.4]);
  assert.deepEqual(half.slice(5), [0, 0, 0, 0]);
  assert.deepEqual(drawn(half, [400, 0.4], [0, 0], 800), half, "back along the same stroke nothing changes");
});

test("keys choose a point of the curve and move it, within the chart", () => {
  const right = afterKey("ArrowRight", null, 0);
  assert.deepEqual(right, { heights: null, chosen: 1 });
  assert.equal(afterKey("ArrowLeft", null, 0)?.chosen, 0);
  assert.equal(afterKey("ArrowRight", null, KNOTS - 1)?.chosen, KNOTS - 1);
  assert.equal(afterKey("ArrowUp", null, 2)?.heights?.[2], 0.02);
  const top = Array.from({ length: KNOTS }, () => HIGHEST_M);
  assert.equal(afterKey("PageUp", top, 0)?.heights?.[0], HIGHEST_M);
  assert.equal(afterKey("a", null, 0), null);
  assert.deepEqual([knotsOf(300)[0], knotsOf(300).at(-1), knotsOf(300).length], [0, 300, KNOTS]);
});

// ---- answers and scores

test("an answer is told in the unit of its question", () => {
  assert.equal(answerInWords(makeAsk({}), 0.456), "0.46\u00a0m");
  assert.equal(answerInWords(makeAsk({ unit: "states" }), 25), "25\u00a0states");
  assert.equal(answerInWords(makeAsk({ kind: "choice" }), "Yes"), "Yes");
  assert.equal(draftOf({ text: "", ask: makeAsk({}) }, 0), undefined, "nothing was typed yet");
});

test("a score is told against all seeds, or against the answer of the lesson", () => {
  assert.equal(scoreInWords(entry({ is_right: true }), makeAsk({})), "You were right.");
  assert.equal(scoreInWords(entry({ is_right: false, error: 5 }), makeAsk({ unit: "states" })),
    "That was not it. It is 5 states off.");
  assert.equal(scoreInWords(entry({ quantile: 0.25, error: 0.08 }), makeAsk({})),
    "25 % of all robots went less far than you said; you were 8\u00a0cm from the typical one.");
  assert.equal(scoreInWords(entry({ quantile: 0.25, error: 8 }), makeAsk({ unit: "cm" })),
    "25 % of all robots went less far than you said; you were 8\u00a0cm from the typical one.");
  assert.equal(scoreInWords(entry({ share: 0.5 }, "greedy"), makeAsk({ kind: "choice" })),
    "Greedy won in 50 % of all races.");
  assert.equal(scoreInWords(entry({ error: 0.1 }, []), makeAsk({ kind: "curve" })),
    "On average you were 10\u00a0cm from the typical curve.");
});

test("predictions stand on the axis of the distances only if they are distances", () => {
  const { choice, number } = KINDS;
  assert.deepEqual(number.metresOf?.(makeAsk({ unit: "cm" }), [40, null, "x"]), [0.4]);
  assert.equal(number.metresOf?.(makeAsk({ unit: "states" }), [25]), null);
  assert.equal(choice.metresOf, undefined);
  assert.deepEqual(choice.tally?.(makeAsk({ choices: ["a", "b"] }), ["b", "b", "c"]), [["a", 0], ["b", 2]]);
  assert.equal(axisOf([-0.1, 0.5]).low, -0.1);
  assert.ok(axisOf([-0.1, 0.5]).high > 0.5);
});

// ---- settings within the bounds of a card

const [NAME, SETTING] = Object.entries(OPTIONS.agents.find((agent) => agent.learns)?.settings ?? {})
  .find(([, setting]) => setting.is_number) ?? [];

test("a setting begins with the value of the card's form, and else with its default", () => {
  const agent = OPTIONS.agents.find(({ learns }) => learns)?.name;
  assert.ok(NAME && SETTING);
  /** @type {(form: object) => LessonCard} */
  const card = (form) => ({ text: "", state: { form: { agent, ...form } }, may: { [NAME]: {} } });
  assert.deepEqual(chosenSettings(card({}), 0), { [NAME]: SETTING.default });
  assert.deepEqual(chosenSettings(card({ [NAME]: 0.25 }), 0), { [NAME]: 0.25 });
  assert.deepEqual(chosenSettings(card({ [NAME]: "0.25" }), 0), { [NAME]: 0.25 }, "as it was typed on the page");
  assert.deepEqual(chosenSettings(card({ settings: { [NAME]: 0.35 } }), 0), { [NAME]: 0.35 });
  assert.equal(givenInWords({ [NAME]: 0.25 }, card({})),
    `${SETTING.symbol ?? SETTING.title.toLowerCase()}\u00a00.25`);
});

test("of names the first that the card allows is chosen, where its form names none", () => {
  const [first, second] = OPTIONS.gaits.map(({ name }) => name);
  const may = /** @type {LessonCard["may"]} */ ({ gait: { choices: [second, first] } });
  assert.deepEqual(chosenSettings({ text: "", may }, 0), { gait: second });
  assert.deepEqual(chosenSettings({ text: "", may, state: { form: { gait: first } } }, 0), { gait: first });
});
