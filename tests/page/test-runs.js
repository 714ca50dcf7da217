// The list of runs: filters, and which of the known runs are in its pages.
import assert from "node:assert/strict";
import { beforeEach, test } from "node:test";
import { clearFilters, filters, isFiltered, shownRuns } from "../../static/js/runs.js";
import { applyEvent } from "../../static/js/store.js";
import { makeRun } from "./options.js";

const STAGE = { run_id: null, next_run_id: null, playing: true, speed: 1, clock: "paper" };
const TRAINING = makeRun({ name: "Slow tripod", state: "finished" });
const RACE = makeRun({ kind: "race", name: "Final", state: "running", config: { lanes: [] } });
const UNKNOWN = { id: "damaged-1", kind: null, name: null, created_at: null, damaged: "its kind is lost" };

beforeEach(() => {
  clearFilters();
  applyEvent("snapshot", { runs: [TRAINING, RACE, UNKNOWN], stage: STAGE, scene: null, role: "operator" });
});

const shown = (/** @type {object} */ changes) => {
  filters.value = { ...filters.value, ...changes };
  return shownRuns.value.map(({ id }) => id);
};

test("filters combine, and a damaged run whose kind is lost is of every kind", () => {
  assert.equal(isFiltered.value, false);
  assert.deepEqual(new Set(shown({})), new Set([TRAINING.id, RACE.id, UNKNOWN.id]));
  assert.deepEqual(shown({ kind: "race" }), [UNKNOWN.id, RACE.id]);
  assert.deepEqual(shown({ state: "running" }), [RACE.id]);
  assert.equal(isFiltered.value, true);
  assert.deepEqual(shown({ kind: "training" }), []);
});

test("search finds a part of a name or an id, and folds A to Z only, as the server does", () => {
  assert.deepEqual(shown({ search: "TRIPOD" }), [TRAINING.id]);
  assert.deepEqual(shown({ search: RACE.id }), [RACE.id]);
  assert.deepEqual(shown({ search: "Ü" }), []);
});
