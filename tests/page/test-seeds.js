// Seeds of an experiment: its trials by setting, and the runs that were made of them.
import assert from "node:assert/strict";
import { test } from "node:test";
import { hasReplay, loadTrials, repeatable, seedsOf } from "../../static/js/experiments/seeds.js";
import { applyEvent } from "../../static/js/store.js";
import { makeRun } from "./options.js";

const EXPERIMENT = makeRun({ id: "e1", kind: "experiment" });
const TRIALS = ["tripod/sarsa#10", "tripod/sarsa#2", "tripod/sarsa/alpha=1#2"].map((key, n) => (
  { key, result: n === 1 ? null : { distances_m: [0.1, 0.2] } }
));

test("seeds are those of their setting, in order, with the newest run that was made of each", async () => {
  const note = (/** @type {string} */ key) => `Mine.\nTrial ${key} of experiment e1. Again.`;
  const [first, second, other] = ["tripod/sarsa#10", "tripod/sarsa#10", "tripod/sarsa#1"]
    .map((key) => makeRun({ notes: note(key) }));
  globalThis.fetch = /** @type {any} */ ((/** @type {URL} */ { pathname }) => Promise.resolve(new Response(
    JSON.stringify(pathname.endsWith("/trials") ? { trials: TRIALS } : { items: [first, second, other] }),
  )));
  assert.equal(seedsOf("e1", "tripod/sarsa"), null);
  await loadTrials(EXPERIMENT);
  assert.deepEqual(
    seedsOf("e1", "tripod/sarsa")?.map(({ number, distance_m, run }) => [number, distance_m, run?.id]),
    [[2, null, undefined], [10, 0.2, second.id]],
  );
  applyEvent("run", { ...second, state: "running" });
  const [, { run }] = seedsOf("e1", "tripod/sarsa") ?? [];
  assert.equal(hasReplay(run), false);
  assert.equal(hasReplay(first), true);
});

test("no single run repeats a practice in blocks", () => {
  const settings = [{ blocks: 1, n: 2 }, { blocks: 4, n: 2 }, { blocks: 0, n: 1 }, { blocks: 1, n: 0 }];
  assert.deepEqual(repeatable(/** @type {any} */ (settings)).map(({ blocks }) => blocks), [1, 0]);
});
