// The lesson that is made on the page: its cards, what it takes of the page, and what is sent.
import assert from "node:assert/strict";
import { beforeEach, test } from "node:test";
import {
  addCard, begin, changeCard, changeLesson, chosen, chosenCard, discard, documentOf, draft, moveCard, pageAsState,
  removeCard, toSend,
} from "../../../static/features/classroom/lessons/draft.js";
import { paragraphs } from "../../../static/features/classroom/lessons/markdown.js";
import { isShown, linked } from "../../../static/features/classroom/lesson.js";
import { linesOf, numberOf } from "../../../static/js/parse.js";
import { asTexts, change, read } from "../../../static/js/page-state.js";
import { installOnly } from "../../page/features.js";
import { setDepth } from "../../../static/js/workspace.js";

await installOnly("classroom", "explanations", "gait_analysis", "what_if");

beforeEach(() => {
  read({ search: "", hash: "" });
  setDepth("watch");
  read({ search: "", hash: "" });
  begin();
});

const titles = () => draft.value?.cards.map(({ title }) => title);

test("cards are added after the one that is edited, moved and removed, and one is left", () => {
  changeCard({ title: "a" });
  addCard();
  changeCard({ title: "b" });
  chosen.value = 0;
  addCard();
  changeCard({ title: "c" });
  assert.deepEqual([titles(), chosen.value], [["a", "c", "b"], 1]);
  moveCard(1);
  moveCard(1);
  assert.deepEqual([titles(), chosen.value], [["a", "b", "c"], 2]);
  removeCard();
  removeCard();
  removeCard();
  assert.deepEqual([titles(), chosenCard.value?.title], [["a"], "a"]);
  discard();
  assert.equal(draft.value, null);
});

test("a card takes the page as it is, without what the room says", () => {
  change({
    form: new URLSearchParams("alpha=0.5&seed=3&disturb=limp:legs%3D1&disturb=slope:degrees%3D8"), tab: "train",
    camera: "2", hidden: ["panel"],
  });
  assert.deepEqual(pageAsState(), {
    depth: "try", tab: "train", camera: "2", hidden: ["panel"],
    form: { alpha: "0.5", disturb: ["limp:legs=1", "slope:degrees=8"] },
  });
});

test("what a card took is the page's form again", () => {
  const texts = asTexts({
    alpha: 0.5, lanes: ["greedy", "beam"], disturb: ["limp:legs=1", "slope:degrees=8"], settings: { gamma: 0.9 },
  });
  assert.equal(String(texts), String(new URLSearchParams([
    ["alpha", "0.5"], ["lanes", "greedy,beam"], ["disturb", "limp:legs=1"], ["disturb", "slope:degrees=8"],
    ["gamma", "0.9"],
  ])));
});

test("only what was written is sent", () => {
  changeLesson({ title: " Luck ", aims: [], language: "" });
  changeCard({ title: " ", text: "How far?", ask: null, go: null, may: { alpha: {} } });
  changeCard({ reveal: { text: "", answer: "" } });
  assert.deepEqual(toSend(/** @type {any} */ (draft.value)), {
    title: "Luck", cards: [{ text: "How far?", may: { alpha: {} } }],
  });
  changeCard({ reveal: { text: "Luck.", answer: null } });
  assert.equal(toSend(/** @type {any} */ (draft.value)).cards[0].reveal, "Luck.");
  changeCard({ reveal: { text: "", answer: 25 } });
  assert.deepEqual(toSend(/** @type {any} */ (draft.value)).cards[0].reveal, { text: "", answer: 25 });
});

test("a lesson of the server is edited without what it adds", () => {
  const view = /** @type {any} */ ({
    id: "x", is_built_in: true, html: [], title: "Luck", language: "en", aims: [],
    cards: [{ title: null, text: "How far?", state: { depth: "try", form: null }, may: {}, ask: null }],
  });
  assert.deepEqual(documentOf(view), {
    title: "Luck", language: "en", cards: [{ text: "How far?", state: { depth: "try" }, may: {} }],
  });
});

test("how long a lesson is, for whom, and its question before and after are kept and sent", () => {
  const before = { kind: "choice", text: "Who?", choices: ["a", "b"], right: "a" };
  const view = /** @type {any} */ ({
    id: "x", title: "Luck", language: "en", minutes: 45, ages: "from 12", aims: ["Wait"], before, after: null,
    cards: [{ text: "Look." }],
  });
  const written = documentOf(view);
  assert.deepEqual(toSend(written), {
    title: "Luck", language: "en", minutes: 45, ages: "from 12", aims: ["Wait"], before, cards: [{ text: "Look." }],
  });
  assert.equal(toSend({ ...written, before: null, after: /** @type {any} */ (before) }).after, undefined,
    "what is asked after is compared with what was asked before");
});

test("lines and numbers are read as they are typed", () => {
  assert.deepEqual(linesOf(" a \n\n b"), ["a", "b"]);
  assert.deepEqual(["0,5", " ", "x", "-1"].map(numberOf), [0.5, null, null, -1]);
});

test("the preview knows paragraphs, lists, strong, emphasis and code", () => {
  const [first, list] = paragraphs("How **far** or *not*\n`x`?\n\n- one\n- two");
  assert.deepEqual(first.parts.map(({ kind, text }) => `${kind} ${text}`),
    ["text How ", "strong far", "text  or ", "em not", "text  ", "code x", "text ?"]);
  assert.deepEqual([list.kind, list.items.map(([{ text }]) => text)], ["list", ["one", "two"]]);
});

test("a linked lesson hides the tabs that its card does not show", () => {
  assert.ok(isShown("why"));
  linked.value = /** @type {any} */ ({ id: "x", cards: [{ show: ["board", "train"] }, { show: null }] });
  assert.deepEqual(["board", "why"].map(isShown), [true, false]);
  change({ card: 2 });
  assert.ok(isShown("why"));
  linked.value = null;
});
