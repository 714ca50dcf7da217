// The table of a learner that values landings.
import assert from "node:assert/strict";
import { test } from "node:test";
import {
  landingOf, MAX_LANDINGS, pairsOfLanding, rankedLandings,
} from "../../../static/features/explanations/landings.js";

/** @import { StateTable } from "../../../static/js/types.js" */

const NAMES = ["home", "front left", "front right", "back left", "back right"];

/** @param {Record<number, [number, number]>} came value and visits by the index of the landing @param {number} pairs */
function shownOf(came, pairs = 3) {
  const landings = Array.from({ length: 5 ** pairs }, (_, index) => came[index] ?? [0, 0]);
  return /** @type {StateTable} */ (/** @type {unknown} */ ({
    pairs: [[1, 4], [2, 5], [3, 6]].slice(0, pairs),
    cell_names: NAMES,
    states: 5 ** pairs,
    first: 0,
    landings: { values: landings.map(([value]) => value), visits: landings.map(([, visits]) => visits) },
  }));
}

test("landings that came stand first, the best on top; the others follow in their order", () => {
  const ranked = rankedLandings(shownOf({ 7: [-0.002, 3], 31: [0.004, 1], 120: [0.001, 9] }));
  assert.deepEqual(ranked.slice(0, 5).map(({ index }) => index), [31, 120, 7, 0, 1]);
  assert.deepEqual(ranked[0], { index: 31, cells: [1, 1, 1], value: 0.004, visits: 1 });
  assert.equal(ranked.length, 125);
});

test("before the first step no landing has a value", () => {
  const ranked = rankedLandings(shownOf({}));
  assert.deepEqual(ranked[3].cells, [0, 0, 3]);
});

test("of very many landings the best are shown", () => {
  const came = { 15_000: /** @type {[number, number]} */ ([0.01, 1]) };
  const shown = { ...shownOf(came, 3), landings: { values: Array(15_625).fill(0), visits: Array(15_625).fill(0) } };
  shown.landings.visits[15_000] = 1;
  assert.equal(rankedLandings(shown).length, MAX_LANDINGS);
  assert.equal(rankedLandings(shown)[0].index, 15_000);
});

test("a step lands where its pair was put, with the others where they were", () => {
  assert.equal(landingOf({ observation: [0, 4, 2], action: [2, 1] }, shownOf({})), 0 * 25 + 4 * 5 + 1);
  assert.equal(pairsOfLanding(shownOf({})), 12);
});
