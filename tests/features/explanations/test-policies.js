// The tables of two trainings: where their policies part, and how they are loaded.
import assert from "node:assert/strict";
import { afterEach, beforeEach, mock, test } from "node:test";
import { signal } from "@preact/signals";
import {
  askAgain, differencesOf, followTables, haveSameStates, tableOf,
} from "../../../static/features/explanations/policies.js";
import { connection, options } from "../../../static/js/store.js";
import { makeRun, OPTIONS } from "../../page/options.js";

beforeEach(() => (options.value = OPTIONS));

const GRID = { pairs: [[1, 4]], cells_m: /** @type {[number, number][]} */ ([[0, 0], [0, 1], [1, 0]]) };

/** A table of one pair on three cells: the best cell of each state, and whether the state was tried. */
const tableWith = (/** @type {number[]} */ best, /** @type {number[]} */ tries) => ({
  ...GRID, cell_names: ["home", "front", "back"], states: 3,
  values: best.map((cell) => [0, 1, 2].map((cellOfValue) => (cellOfValue === cell ? 0.05 : 0))),
  visits: tries.map((times) => [times, 0, 0]),
  best: best.map((cell) => /** @type {[number, number]} */ ([0, cell])),
});

test("policies differ where both have practised and their best moves are others", () => {
  const [first, other] = [tableWith([1, 2, 0], [3, 9, 0]), tableWith([2, 0, 1], [5, 4, 7])];
  const { different, compared: states, known } = differencesOf(first, other);
  assert.equal(states, 3);
  assert.deepEqual(known, { both: 2, one: 0, other: 1 });
  assert.deepEqual(different.map(({ index }) => index), [1, 0], "the most visited first");
  assert.deepEqual(different[0].bests.map(({ move, value, visits }) => [move, value, visits]), [
    [[0, 2], 0.05, 9], [[0, 0], 0.05, 4],
  ]);
  assert.equal(haveSameStates(first, other), true);
  assert.equal(haveSameStates(first, { ...other, pairs: [[2, 5]] }), false);
});

// ---- loading tables

/** Requests for tables: [training, step, first state]. @type {(string | null)[][]} */
let requests = [];
/** Steps that the server knows of. */
let newestStep = 0;
/** Status with which the server refuses; 0 where it does not. */
let refusedWith = 0;

/** Answers with two of three states at once. @param {URL} address */
function answerTo({ pathname, searchParams }) {
  const [step, first] = ["step", "first"].map((name) => searchParams.get(name));
  requests.push([pathname.split("/").at(-2) ?? "", step, first]);
  if (refusedWith) return new Response(JSON.stringify({ detail: "No." }), { status: refusedWith });
  const { values, visits, best, ...whole } = tableWith([1, 2, 0], [newestStep, 0, 0]);
  const range = [Number(first), Number(first) + 2];
  return new Response(JSON.stringify({
    ...whole, step: Number(step ?? newestStep), first: Number(first),
    values: values.slice(...range), visits: visits.slice(...range), best: best.slice(...range),
  }));
}

/** Let answers come, then let time pass. @param {number} ms */
async function pass(ms) {
  for (let turn = 0; turn < 5; turn += 1) {
    await new Promise((resolve) => {
      setImmediate(resolve);
    });
  }
  mock.timers.tick(ms);
}

/** Follow the table of a training that has done 10 steps. */
function followOne() {
  mock.timers.enable({ apis: ["setTimeout"] });
  globalThis.fetch = (address) => Promise.resolve(answerTo(new URL(String(address))));
  connection.value = "live";
  [requests, newestStep] = [[], 10];
  const run = signal(makeRun({ state: "running", progress: { done: 10, total: 100 } }));
  const stop = followTables(() => [run.value]);
  const proceed = (/** @type {number} */ done) => {
    newestStep = done;
    run.value = { ...run.value, progress: { ...run.value.progress, done } };
  };
  return { run, stop, proceed };
}

afterEach(() => mock.timers.reset());

test("the table of a training that runs is loaded now and then, all parts of one moment", async () => {
  const { run, stop, proceed } = followOne();
  assert.equal(tableOf(run.value), null);
  for (const done of [20, 30, 40]) proceed(done);
  await pass(2900);
  assert.deepEqual(requests.map(([, step, first]) => [step, first]), [[null, "0"], ["10", "2"]]);
  const { table } = tableOf(run.value) ?? {};
  assert.deepEqual(table?.visits.map(([times]) => times), [10, 0, 0]);
  await pass(200);
  assert.equal(tableOf(run.value)?.table, table, "the one before is shown until the next is whole");
  await pass(0);
  assert.equal(tableOf(run.value)?.table?.visits[0][0], 40);
  for (let n = 0; n < 5; n += 1) await pass(5000);
  assert.equal(requests.length, 4, "it has not changed since");
  stop();
});

test("a table that is refused for good is asked for once, another again", async () => {
  refusedWith = 409;
  const { run, stop, proceed } = followOne();
  for (const done of [20, 30]) {
    await pass(5000);
    proceed(done);
  }
  assert.deepEqual([requests.length, tableOf(run.value)?.problem], [1, "No."]);
  refusedWith = 503;
  askAgain();
  for (let n = 0; n < 3; n += 1) await pass(5000);
  assert.deepEqual([requests.length, tableOf(run.value)?.problem], [5, "No."]);
  refusedWith = 0;
  await pass(5000);
  await pass(5000);
  assert.equal(tableOf(run.value)?.table?.values.length, 3);
  stop();
});
