// The presentation that all presenters' windows of a stage follow, and who may tell it.
import assert from "node:assert/strict";
import { beforeEach, test } from "node:test";
import { signal } from "@preact/signals";
import {
  followPresentation, presentation, tell, toggleBlank, toggleWhy, turnCode, turnPage,
} from "../../../static/features/presenter/presentation.js";
import { install } from "../../../static/js/features.js";
import { change, page, read } from "../../../static/js/page-state.js";
import { applyEvent, options } from "../../../static/js/store.js";
import { ALL, EXAMPLE } from "../../page/features.js";
import { makeRun, makeSceneLane, makeStage, OPTIONS } from "../../page/options.js";

/** @import { Presentation } from "../../../static/js/types.js" */

const START = makeStage().presentation;
/** What the server was told. @type {Presentation[]} */
let sent = [];
globalThis.fetch = (_, { body = "" } = {}) => {
  const { presentation: sentPresentation } = JSON.parse(String(body));
  sent.push(sentPresentation);
  return Promise.resolve(new Response(JSON.stringify(makeStage({ presentation: sentPresentation }))));
};
/** @type {import("@preact/signals").Signal<number | null>} */
const open = signal(null);
const cards = signal(["One", "Two", "Three"].map((title) => ({ title, text: title })));
const { fields } = ALL.find(({ name }) => name === "presenter") ?? {};
install([{
  ...EXAMPLE, fields, deck: { cards, number: open, open: (number) => { open.value = number; }, Question: () => null },
}]);
followPresentation();

const settle = () => new Promise((resolve) => {
  setTimeout(resolve, 5);
});

/** @param {Partial<Presentation>} shown */
const showCard = (shown, role = "operator") =>
  applyEvent("snapshot", { role, runs: [], stage: makeStage({ presentation: { ...START, ...shown } }), scene: null });

beforeEach(() => {
  options.value = OPTIONS;
  read({ search: "", hash: "" });
  open.value = null;
  showCard({});
  sent = [];
});

test("links present the page, or make it the remote", () => {
  read({ search: "?run=a&present", hash: "" });
  assert.deepEqual([page.isPresenting.value, page.isRemote.value], [true, false]);
  read({ search: "?present=&remote", hash: "" });
  assert.deepEqual([page.isPresenting.value, page.isRemote.value], [true, true]);
});

test("before it is told, no card is shown, and the code is large", () => {
  assert.deepEqual(presentation.value, { card: null, shows_why: false, is_blank: false, code: "large" });
});

test("cards are turned within the deck, and each begins without an explanation", async () => {
  turnPage(-1);
  turnPage(1);
  await settle();
  assert.deepEqual(sent, [{ ...START, card: 1 }]);
  showCard({ card: 1, shows_why: true });
  turnPage(-1);
  turnPage(1);
  await settle();
  assert.deepEqual(sent.at(-1), { ...START, card: 2 });
  showCard({ card: cards.value.length });
  turnPage(1);
  assert.equal(sent.length, 2);
});

test("the code is large, small or none; the rest is on or off", async () => {
  for (const [turn, changes] of /** @type {const} */ ([
    [turnCode, { code: "small" }], [turnCode, { code: "none" }], [turnCode, { code: "large" }],
    [toggleWhy, { shows_why: true }], [toggleBlank, { shows_why: true, is_blank: true }],
  ])) {
    turn();
    await settle();
    assert.deepEqual(presentation.value, { ...START, ...changes });
  }
});

test("only operators tell it", async () => {
  showCard({ card: 1 }, "spectator");
  turnPage(1);
  tell({ is_blank: true });
  await settle();
  assert.deepEqual(sent, []);
});

test("a page that is presented follows it, and other pages do not", () => {
  showCard({ card: 2 });
  assert.equal(open.value, null);
  change({ isPresenting: true });
  assert.deepEqual([open.value, page.tab.value, page.depth.value], [2, "board", "watch"]);
  showCard({ card: 3, shows_why: true });
  assert.deepEqual([open.value, page.tab.value], [3, "why"]);
});

test("a page that is presented no more is as deep as it was", () => {
  change({ depth: "study", tab: "gait" });
  change({ isPresenting: true });
  assert.deepEqual([page.tab.value, page.depth.value], ["board", "watch"]);
  change({ isPresenting: false });
  assert.deepEqual([page.tab.value, page.depth.value], ["gait", "study"]);
});

test("by the end of the first race the code is small, once", async () => {
  change({ isPresenting: true });
  const config = { steps: 50, lanes: [{ agent: "greedy" }] };
  const race = makeRun({ kind: "race", progress: { done: 50, total: 50 }, config });
  const showAt = (/** @type {number} */ time_s) => applyEvent("snapshot", {
    role: "operator", runs: [race], stage: makeStage({ run_id: race.id, phase: "showing" }),
    scene: {
      run_id: race.id, kind: "race", phase: "race", time_s, duration_s: 20, computed_s: 20, time_out_s: 16,
      ended: false, lanes: [makeSceneLane(time_s < 16 ? {} : { step: 50, done: true })],
    },
  });
  showAt(15);
  assert.deepEqual(sent, []);
  showAt(16);
  await settle();
  assert.deepEqual(sent.map(({ code }) => code), ["small"]);
  showAt(1);
  tell({ code: "large" });
  await settle();
  showAt(16);
  await settle();
  assert.deepEqual(sent.map(({ code }) => code), ["small", "large"], "who wants it large again has it");
});
