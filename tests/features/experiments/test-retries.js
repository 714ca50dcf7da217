// The summary of an experiment is requested again after an error that may pass.
import assert from "node:assert/strict";
import { beforeEach, mock, test } from "node:test";
import { followSummary, summary, summaryError } from "../../../static/features/experiments/runs.js";
import { page } from "../../../static/js/page-state.js";
import { applyEvent, connection, options } from "../../../static/js/store.js";
import { installOnly } from "../../page/features.js";
import { makeRun, OPTIONS } from "../../page/options.js";

const STAGE = { run_id: null, next_run_id: null, playing: true, speed: 1, clock: "paper" };

/** Statuses of the next answers, then 200. @type {number[]} */
let refusals = [];
/** Requests by the last part of their address. @type {string[]} */
let requests = [];

/** @type {Record<string, object>} */
const ANSWERS = {
  summary: { config: {}, settings: [] },
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
await installOnly("experiments");
followSummary();

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

test("the summary of an experiment", async () => {
  page.view.value = "experiments";
  await show({ kind: "experiment", config: {} }, 503);
  assert.equal(requests.filter((name) => name === "summary").length, 2);
  assert.deepEqual([summaryError.value, summary.value?.settings], [null, []]);
});

test("the summary of another experiment is requested at once, that of the same one after a pause", async () => {
  page.view.value = "experiments";
  const [first, other] = [1, 2].map(() => makeRun({ kind: "experiment", config: {} }));
  const summaries = () => requests.filter((name) => name === "summary").length;
  const tell = (/** @type {number} */ done) => applyEvent("summary", { run_id: first.id, done });
  page.report.value = first.id;
  applyEvent("snapshot", { runs: [first, other], stage: STAGE, scene: null, role: "operator" });
  tell(1);
  assert.equal(summaries(), 1);
  page.report.value = other.id;
  assert.equal(summaries(), 2);
  page.report.value = first.id;
  assert.equal(summaries(), 3);
  await pass();
  assert.equal(summaries(), 3);
  tell(2);
  assert.equal(summaries(), 4);
  page.report.value = null;
  await pass();
});
