// The details beside the list: of which runs they are, the small curves of the list, and the same with several seeds.
import assert from "node:assert/strict";
import { beforeEach, mock, test } from "node:test";
import { change, page } from "../../static/js/page-state.js";
import {
  bestPointOf, closeDetails, commonGreedy, followDetails, isOfSelection, isOpenedGone, openDetails,
  subjects,
} from "../../static/js/run-details.js";
import { setSelected } from "../../static/js/run-selection.js";
import { followThumbnails, pointsOf } from "../../static/js/run-thumbnails.js";
import { applyEvent, connection, options } from "../../static/js/store.js";
import { makeRun, OPTIONS } from "./options.js";

const STAGE = { run_id: null, next_run_id: null, playing: true, speed: 1, clock: "paper" };
const { config } = makeRun({});
/** @type {(changes?: object, more?: object) => ReturnType<typeof makeRun>} */
const trained = (changes = {}, more = {}) => makeRun({ config: { ...config, ...changes }, ...more });

/** The requests so far: [last part of the path, ids]. @type {[string, string[]][]} */
let requests = [];
/** Status with which the next request is refused. */
let refusal = 0;

globalThis.fetch = /** @type {any} */ ((/** @type {URL} */ address) => {
  const ids = address.searchParams.getAll("id");
  requests.push([address.pathname.split("/").at(-1) ?? "", ids]);
  const [status, curves] = [refusal || 200, ids.map((id) => ({ id, steps: [50, 100], distances_m: [0.1, null] }))];
  refusal = 0;
  const body = ids.length ? { curves } : { evaluations: [], greedy_distance_m: null, best_known_m: null };
  return Promise.resolve(new Response(JSON.stringify(body), { status }));
});
mock.timers.enable({ apis: ["setTimeout"] });
options.value = OPTIONS;
followThumbnails();
followDetails();

/** Let answers come. */
async function pass() {
  for (let turn = 0; turn < 8; turn += 1) {
    await new Promise((resolve) => {
      setImmediate(resolve);
    });
  }
}

/** @param {ReturnType<typeof makeRun>[]} runs */
function know(...runs) {
  applyEvent("snapshot", { runs, stage: STAGE, scene: null, role: "operator" });
}

beforeEach(() => {
  connection.value = "connecting";
  change({ view: "race", selected: [], opened: null, isOverList: false });
  change({ grouping: "none", list: new URLSearchParams() });
  requests = [];
});

test("details are of the first run, of the one that was opened, or of all that are selected", () => {
  const [first, two, three] = [trained({ seed: 1 }), trained({ seed: 2 }), trained({ seed: 3 })];
  know(first, two, three);
  const shown = () => subjects.value.map(({ id }) => id);
  assert.deepEqual(shown(), [three.id]);
  openDetails(first.id);
  assert.deepEqual([shown(), page.isOverList.value], [[first.id], false]);
  setSelected(two.id, true);
  assert.deepEqual(shown(), [first.id]);
  setSelected(first.id, true);
  assert.deepEqual([shown(), isOfSelection.value], [[first.id, two.id], true], "by the seeds in which they differ");
  openDetails(three.id);
  assert.deepEqual(shown(), [three.id], "beside the selection");
  openDetails(two.id);
  assert.deepEqual(shown(), [first.id, two.id]);
  applyEvent("run-deleted", { id: two.id });
  assert.deepEqual(shown(), [first.id]);
  setSelected(first.id, false);
  openDetails(first.id);
  applyEvent("run-deleted", { id: first.id });
  assert.deepEqual([shown(), isOpenedGone.value], [[], true], "another's details would be taken for its own");
  openDetails(three.id);
  assert.deepEqual([shown(), isOpenedGone.value], [[three.id], false]);
  closeDetails();
  assert.equal(page.isOverList.value, false);
});

test("small curves come for as many runs at once as are answered, then with each evaluation", async () => {
  const runs = [trained({ seed: 1 }), trained({ seed: 2 }), trained({ seed: 3 })];
  know(...runs, makeRun({ kind: "race", name: "Final", config: { lanes: [] } }));
  change({ view: "runs" });
  connection.value = "live";
  await pass();
  const curves = () => requests.filter(([name]) => name === "curves").map(([, ids]) => ids);
  const [a, b, c] = runs.map(({ id }) => id);
  assert.deepEqual(curves(), [[c, b], [a]], "up to two runs at once here");
  assert.deepEqual(pointsOf(a), [[50, 0.1]], "what was not measured is no point");
  applyEvent("evaluation", { run_id: a, step: 150, distance_m: 0.3, epsilon: 0 });
  assert.deepEqual(pointsOf(a), [[50, 0.1], [150, 0.3]]);
  requests = [];
  const late = trained({ seed: 4 });
  refusal = 503;
  applyEvent("run", late);
  await pass();
  mock.timers.tick(3000);
  await pass();
  assert.deepEqual(curves(), [[late.id], [late.id]], "again after an error that may pass");
  connection.value = "reconnecting";
  requests = [];
  connection.value = "live";
  await pass();
  assert.equal(curves().flat().length, 4, "evaluations may have been missed");
});

test("figures of curves: the farthest point, and greedy’s distance where it is the same", () => {
  const [first, second] = [trained({}, { greedy_distance_m: 0.5 }), trained({}, { greedy_distance_m: 0.4 })];
  know(first, second);
  for (const [step, distance_m] of [[10, 0.2], [20, 0.4], [30, 0.1]]) {
    applyEvent("evaluation", { run_id: first.id, step, distance_m, epsilon: 0 });
  }
  assert.deepEqual([bestPointOf(first)?.step, bestPointOf(second)], [20, null]);
  assert.deepEqual([commonGreedy([first, first]), commonGreedy([first, second])], [0.5, null]);
});
