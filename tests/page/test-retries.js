// What the page follows is requested again after an error that may pass, and not after one that lasts.
import assert from "node:assert/strict";
import { beforeEach, mock, test } from "node:test";
import { page } from "../../static/js/page-state.js";
import { followTimeline, timeline, timelineProblem } from "../../static/js/race.js";
import { applyEvent, connection, options } from "../../static/js/store.js";
import { curve, followCurves, trainingsInView } from "../../static/js/training.js";
import { makeRun, OPTIONS } from "./options.js";

const STAGE = { run_id: null, next_run_id: null, playing: true, speed: 1, clock: "paper" };

/** Statuses of the next answers, then 200. @type {number[]} */
let refusals = [];
/** Requests by the last part of their address. @type {string[]} */
let requests = [];

/** @type {Record<string, object>} */
const ANSWERS = {
  timeline: { clock: "paper", lanes: [] },
  curve: { evaluations: [{ step: 10, distance_m: 0.1 }], greedy_distance_m: null, best_known_m: null },
};

/** @param {URL} address */
function answerTo({ pathname }) {
  const name = pathname.split("/").at(-1) ?? "";
  requests.push(name);
  const status = refusals.shift() ?? 200;
  return new Response(JSON.stringify(status === 200 ? ANSWERS[name] ?? makeRun({ id: name }) : {}), { status });
}
globalThis.fetch = (address) => Promise.resolve(answerTo(new URL(String(address))));
mock.timers.enable({ apis: ["setTimeout"] });
followTimeline();
followCurves(trainingsInView);

beforeEach(() => {
  [options.value, connection.value, page.view.value] = [OPTIONS, "live", "race"];
  applyEvent("snapshot", { runs: [], stage: STAGE, scene: null, role: "operator" });
  requests = [];
});

async function pass() {
  for (let round = 0; round < 3; round += 1) {
    for (let turn = 0; turn < 4; turn += 1) {
      await new Promise((resolve) => {
        setImmediate(resolve);
      });
    }
    mock.timers.tick(3000);
  }
}

/** Put a run on stage, the first requests about which are refused. */
async function show(/** @type {object} */ changes, /** @type {number[]} */ ...statuses) {
  const run = makeRun({ progress: { done: 100, total: 100 }, ...changes });
  refusals = statuses;
  applyEvent("snapshot", { runs: [run], stage: { ...STAGE, run_id: run.id }, scene: null, role: "operator" });
  await pass();
}

const RACE = { kind: "race", config: { steps: 50, lanes: [] } };

test("the timeline of a race", async () => {
  await show(RACE, 503, 503);
  assert.deepEqual([requests, timeline.value?.lanes], [["timeline", "timeline", "timeline"], []]);
  assert.equal(timelineProblem.value, null);
  requests = [];
  await show(RACE, 409);
  assert.deepEqual([requests, timeline.value], [["timeline"], null]);
  assert.equal(timelineProblem.value, "The server answered 409.");
  await show(RACE);
  assert.equal(timelineProblem.value, null);
});

test("the curve of a training, and the training that it continues", async () => {
  await show({}, 503);
  assert.deepEqual([requests, curve.value?.points.length], [["curve", "curve"], 2]);
  requests = [];
  await show({ config: { steps: 10, continue_from: "earlier" } }, 404, 503);
  assert.deepEqual(requests, ["curve", "earlier", "earlier", "curve", "curve"], "at last the curves of both");
});
