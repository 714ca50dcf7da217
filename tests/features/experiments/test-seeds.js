// Seeds of an experiment: its trials by setting, and the runs that were made of them.
import assert from "node:assert/strict";
import { afterEach, beforeEach, mock, test } from "node:test";
import { signal } from "@preact/signals";
import { pending } from "../../../static/js/actions.js";
import {
  followTrials, hasReplay, namesOf, problemOf, repeatable, seedsOf,
} from "../../../static/features/experiments/seeds.js";
import { applyEvent, connection, options } from "../../../static/js/store.js";
import { installOnly } from "../../page/features.js";
import { makeRun, OPTIONS } from "../../page/options.js";

/** @import { Run } from "../../../static/js/types.js" */

const EXPERIMENT = makeRun({ id: "e1", kind: "experiment" });
const TRIALS = ["tripod/sarsa#10", "tripod/sarsa#2", "tripod/sarsa/alpha=1#2"].map((key, n) => (
  { key, result: n === 1 ? null : { distances_m: [0.1, 0.2] } }
));

/** Requests by the last part of their address. @type {string[]} */
let requests = [];
/** Status with which the server refuses; 0 where it does not. */
let refusedWith = 0;
/** Pages of the list of runs. @type {object[][]} */
let pages = [[]];

/** @param {URL} address */
function answerTo({ pathname, searchParams }) {
  const name = pathname.split("/").at(-1) ?? "";
  requests.push(name);
  if (refusedWith) return new Response(JSON.stringify({ detail: "Busy." }), { status: refusedWith });
  if (name === "trials") return new Response(JSON.stringify({ trials: TRIALS }));
  assert.equal(searchParams.get("search"), "of experiment e1");
  const number = Number(searchParams.get("cursor") ?? 0);
  const next_cursor = number + 1 < pages.length ? String(number + 1) : null;
  return new Response(JSON.stringify({ items: pages[number], next_cursor }));
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

await installOnly("experiments");

beforeEach(() => {
  mock.timers.enable({ apis: ["setTimeout"] });
  globalThis.fetch = (address) => Promise.resolve(answerTo(new URL(String(address))));
  connection.value = "live";
  [requests, refusedWith, pages] = [[], 0, [[]]];
});

afterEach(() => mock.timers.reset());

test("seeds are those of their setting, in order, with the newest run that was made of each", async () => {
  const note = (/** @type {string} */ key) => `Mine.\nTrial ${key} of experiment e1. Again.`;
  const [first, second, other] = ["tripod/sarsa#10", "tripod/sarsa#10", "tripod/sarsa#1"]
    .map((key) => makeRun({ notes: note(key) }));
  pages = [[first], [second, other]];
  assert.equal(seedsOf("e1", "tripod/sarsa"), null);
  const stop = followTrials(() => EXPERIMENT);
  await pass(0);
  assert.deepEqual(
    seedsOf("e1", "tripod/sarsa")?.map(({ number, distance_m, run }) => [number, distance_m, run?.id]),
    [[2, null, undefined], [10, 0.2, second.id]],
  );
  applyEvent("run", { ...second, state: "running" });
  const [, { run }] = seedsOf("e1", "tripod/sarsa") ?? [];
  assert.equal(hasReplay(run), false);
  assert.equal(hasReplay(first), true);
  stop();
});

test("the trials of an experiment that runs are requested now and then, and once it has ended", async () => {
  const run = signal({ ...EXPERIMENT, state: /** @type {Run["state"]} */ ("running") });
  const proceed = (/** @type {number} */ done) => (run.value = { ...run.value, progress: { done, total: 500 } });
  const stop = followTrials(() => run.value);
  for (let done = 1; done < 9; done += 1) {
    proceed(done);
    await pass(2000);
  }
  assert.deepEqual(requests, ["trials", "runs", "trials"]);
  run.value = { ...run.value, state: "finished" };
  for (let n = 0; n < 3; n += 1) await pass(20_000);
  assert.deepEqual(requests.slice(3), ["trials"]);
  stop();
});

test("an error of theirs is told without hindering that a seed is run, and they are requested again", async () => {
  refusedWith = 503;
  const stop = followTrials(() => EXPERIMENT);
  await pass(0);
  assert.deepEqual([problemOf("e1"), pending.value.trials], ["Busy.", undefined]);
  refusedWith = 0;
  await pass(10_000);
  await pass(0);
  assert.equal(problemOf("e1"), null);
  assert.deepEqual(requests, ["trials", "trials", "runs"]);
  stop();
  connection.value = "reconnecting";
});

test("no single run repeats a practice in blocks", () => {
  const settings = [{ blocks: 1, n: 2 }, { blocks: 4, n: 2 }, { blocks: 0, n: 1 }, { blocks: 1, n: 0 }];
  assert.deepEqual(repeatable(/** @type {any} */ ({ settings })).map(({ blocks }) => blocks), [1, 0]);
});

test("searches that plan with different models have different names", () => {
  options.value = OPTIONS;
  const setting = { agent: "greedy", gait: "tripod", steps: 500, blocks: 0, n: 1 };
  const settings = [{ ...setting, key: "a" }, { ...setting, key: "b" }, { ...setting, key: "c", agent: "sarsa" }];
  const worlds = [{ key: "a", plans_with: "world" }, { key: "b", plans_with: "nominal" }];
  const repeated = repeatable(/** @type {any} */ ({ settings, worlds }));
  assert.deepEqual([...namesOf(repeated, ["steps"]).values()],
    ["Greedy, true model", "Greedy, nominal model", "sarsa"]);
});
