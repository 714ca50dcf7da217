// The list of runs: filters, and which of the known runs are in its pages.
import assert from "node:assert/strict";
import { beforeEach, test } from "node:test";
import { page } from "../../static/js/page-state.js";
import {
  clearFilters, filters, isFiltered, knownTags, setFilters, shownRuns,
} from "../../static/js/run-list.js";
import {
  clearSelection, deletable, deleteSelected, selectAll, selected, setSelected,
} from "../../static/js/run-selection.js";
import { problems } from "../../static/js/actions.js";
import { applyEvent, options } from "../../static/js/store.js";
import { makeRun, OPTIONS } from "./options.js";

const STAGE = { run_id: null, next_run_id: null, playing: true, speed: 1, clock: "paper" };
const TRAINING = makeRun({ name: "Slow tripod", state: "finished" });
const RACE = makeRun({ kind: "race", name: "Final", state: "running", config: { lanes: [] } });
const UNKNOWN = { id: "damaged-1", kind: null, name: null, created_at: null, damaged: "its kind is lost" };

beforeEach(() => {
  options.value = OPTIONS;
  page.list.value = new URLSearchParams();
  clearSelection();
  applyEvent("snapshot", { runs: [TRAINING, RACE, UNKNOWN], stage: STAGE, scene: null, role: "operator" });
});

const shown = (/** @type {object} */ changes) => {
  setFilters(changes);
  return shownRuns.value.map(({ id }) => id);
};

test("filters combine, and a damaged run whose kind is lost is of every kind", () => {
  assert.equal(isFiltered.value, false);
  assert.deepEqual(new Set(shown({})), new Set([TRAINING.id, RACE.id, UNKNOWN.id]));
  assert.deepEqual(shown({ kind: "race" }), [RACE.id, UNKNOWN.id]);
  assert.deepEqual(shown({ state: "running" }), [RACE.id]);
  assert.equal(isFiltered.value, true);
  assert.deepEqual(shown({ kind: "training" }), []);
});

test("search finds a part of a name or an id, and folds A to Z only, as the server does", () => {
  assert.deepEqual(shown({ search: "TRIPOD" }), [TRAINING.id]);
  assert.deepEqual(shown({ search: RACE.id }), [RACE.id]);
  assert.deepEqual(shown({ search: "Ü" }), []);
});

/** @type {(rank: number, finished_distance_m: number) => object} */
const lane = (rank, finished_distance_m) => ({ clocks: { paper: { rank, finished_distance_m } } });

test("the order is the server's: A to Z alike, the longest first, and at last what has no distance", () => {
  const [far, near, won] = [
    makeRun({ name: "beta", result: { distance_m: 0.5 } }),
    makeRun({ name: "Alpha", result: { distance_m: 0.1 } }),
    makeRun({ name: "Beta", kind: "race", config: { lanes: [] }, result: { lanes: [lane(2, 0.9), lane(1, 0.3)] } }),
  ];
  applyEvent("snapshot", { runs: [TRAINING, far, near, won], stage: STAGE, scene: null, role: "operator" });
  const order = (/** @type {string} */ sort) => shown({ sort });
  assert.deepEqual(order("newest"), [won.id, near.id, far.id, TRAINING.id]);
  assert.deepEqual(order("oldest"), [TRAINING.id, far.id, near.id, won.id]);
  assert.deepEqual(order("name"), [near.id, won.id, far.id, TRAINING.id]);
  assert.deepEqual(order("distance"), [far.id, won.id, near.id, TRAINING.id]);
});

test("tags filter as a whole, and are searched in parts, like notes", () => {
  const tagged = makeRun({ tags: ["Ice", "limp"], notes: "slips\nat µ 0.4" });
  applyEvent("run", tagged);
  applyEvent("run", makeRun({ tags: ["ice"] }));
  assert.equal(shown({ tag: "ICE" }).length, 2);
  assert.deepEqual(shown({ tag: "lim" }), []);
  assert.deepEqual(shown({ tag: "", search: "lim" }), [tagged.id]);
  assert.deepEqual(shown({ search: "0.4" }), [tagged.id]);
  assert.deepEqual(knownTags.value, ["Ice", "limp"]);
});

test("the address has what is chosen, and a link opens the same list", () => {
  assert.equal(String(page.list.value), "");
  setFilters({ kind: "race", tag: "µ & co", sort: "name" });
  const query = String(page.list.value);
  assert.equal(query, "kind=race&tag=%C2%B5+%26+co&sort=name");
  page.list.value = new URLSearchParams();
  assert.equal(filters.value.sort, "newest");
  page.list.value = new URLSearchParams(query);
  assert.deepEqual(filters.value, { kind: "race", state: "", search: "", tag: "µ & co", sort: "name" });
  clearFilters();
  assert.equal(String(page.list.value), "sort=name", "the order is no filter");
});

test("a range is selected from the run before, and nothing is done with what is not shown", () => {
  const more = [makeRun({}), makeRun({}), makeRun({})];
  more.forEach((run) => applyEvent("run", run));
  const chosen = () => selected.value.map(({ id }) => id);
  setSelected(more[2].id, true);
  setSelected(more[0].id, true, true);
  assert.deepEqual(chosen(), more.map(({ id }) => id).reverse());
  setSelected(more[1].id, false);
  assert.deepEqual(chosen(), [more[2].id, more[0].id]);
  selectAll();
  assert.equal(selected.value.length, 6);
  assert.equal(deletable.value.length, 5, "all but the race that runs");
  shown({ kind: "training" });
  setSelected(UNKNOWN.id, false);
  setFilters({ search: "tripod" });
  assert.deepEqual(chosen(), [TRAINING.id]);
});

/** @type {(answer: (address: string, request: any) => [number, object]) => void} */
const answerBy = (answer) => {
  globalThis.fetch = /** @type {any} */ ((/** @type {URL} */ address, /** @type {any} */ request) => {
    const [status, body] = answer(String(address), request);
    return Promise.resolve(new Response(JSON.stringify(body), { status }));
  });
};

test("what is deleted goes, and what is kept is told with its reason", async () => {
  const kept = [{ id: UNKNOWN.id, reason: "a race waits for it" }];
  answerBy(() => [200, { deleted: [TRAINING.id], kept, restorable_until: null }]);
  setSelected(TRAINING.id, true);
  setSelected(UNKNOWN.id, true);
  await deleteSelected();
  assert.deepEqual(shown({}), [RACE.id, UNKNOWN.id]);
  assert.equal(problems.value.selection?.message, "Not deleted: a race waits for it.");
  assert.deepEqual(selected.value.map(({ id }) => id), [UNKNOWN.id], "it stays selected");
});
