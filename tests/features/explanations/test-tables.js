// The tables of the learners of a race as maps, to be looked at side by side.
import assert from "node:assert/strict";
import { beforeEach, test } from "node:test";
import { applyEvent, options, scene } from "../../../static/js/store.js";
import { mapOf, trainedLanes } from "../../../static/features/explanations/tables.js";
import { makeRun, makeSceneLane, OPTIONS } from "../../page/options.js";

/** @import { StateTable } from "../../../static/js/types.js" */

beforeEach(() => (options.value = OPTIONS));

/** Two groups on two cells. @param {object} changes @returns {StateTable} */
const table = (changes) => /** @type {any} */ ({
  step: 9, pairs: [[1, 2], [3, 4]], cells_m: [[0, 0], [0, 0.02]], cell_names: ["home", "front"], states: 2, first: 0,
  values: [[null, 0.5, null, 0], [0.1, null, null, -0.2]], visits: [[null, 3, null, 0], [1, null, null, 2]],
  best: [[0, 1], [0, 0]], landings: null, ...changes,
});

test("a map has the values that were tried, and tells those that were not from moves that there are not", () => {
  const map = mapOf(table({}));
  assert.deepEqual(map.rows, [[null, 0.5, null, null], [0.1, null, null, -0.2]]);
  assert.deepEqual(map.legal, [[false, true, false, true], [true, false, false, true]]);
  assert.deepEqual([map.tried, map.all, map.kind, map.low, map.high], [3, 4, "moves", -0.2, 0.5]);
});

test("of landings there is one value in a row", () => {
  const map = mapOf(table({ landings: { values: [0.3, 0, -0.1], visits: [2, 0, 1] } }));
  assert.deepEqual(map.rows, [[0.3], [null], [-0.1]]);
  assert.deepEqual([map.tried, map.all, map.kind, map.low, map.high], [2, 3, "landings", -0.1, 0.3]);
  const empty = mapOf(table({ landings: { values: [0], visits: [0] } }));
  assert.deepEqual([empty.tried, empty.low, empty.high], [0, 0, 0]);
});

test("the tables are those of the lanes that have practised", () => {
  const lanes = [{ agent: "learner", training_id: "t1" }, { agent: "greedy" }, { agent: "learner", training_id: "t2" }];
  const race = makeRun({ kind: "race", progress: { done: 9, total: 9 }, config: { steps: 3, lanes } });
  const stage = { run_id: race.id, next_run_id: null, playing: true, speed: 1, clock: "paper" };
  applyEvent("snapshot", { runs: [race], stage, scene: null });
  const shown = { run_id: race.id, kind: "race", phase: "race", lanes: [makeSceneLane({})], action_values: null };
  scene.value = /** @type {any} */ (shown);
  assert.deepEqual(trainedLanes.value.map(({ training_id }) => training_id), ["t1", "t2"]);
});
