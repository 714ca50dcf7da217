// Export of the selected runs, and import of files.
import assert from "node:assert/strict";
import { beforeEach, test } from "node:test";
import { exported } from "../../../static/features/archives/export.js";
import { importFiles, imports } from "../../../static/features/archives/imports.js";
import { clearSelection, selectAll, setSelected } from "../../../static/js/run-selection.js";
import { applyEvent, options } from "../../../static/js/store.js";
import { makeRun, OPTIONS } from "../../page/options.js";

const STAGE = { run_id: null, next_run_id: null, playing: true, speed: 1, clock: "paper" };
const TRAINING = makeRun({ name: "Slow tripod", state: "finished" });
const RACE = makeRun({ kind: "race", name: "Final", state: "running", config: { lanes: [] } });
const UNKNOWN = { id: "damaged-1", kind: null, name: null, created_at: null, damaged: "its kind is lost" };

beforeEach(() => {
  options.value = OPTIONS;
  clearSelection();
  applyEvent("snapshot", { runs: [TRAINING, RACE, UNKNOWN], stage: STAGE, scene: null, role: "operator" });
});

test("the selected runs that have ended are exported, unless they are more than an archive has", () => {
  selectAll();
  assert.equal(exported.value.count, 1, "one is at work, and one is damaged");
  assert.match(exported.value.address ?? "", new RegExp(`runs/export\\?id=${TRAINING.id}$`));
  [makeRun({}), makeRun({})].forEach((run) => applyEvent("run", run));
  selectAll();
  assert.deepEqual([exported.value.count, exported.value.address], [3, null]);
  clearSelection();
  setSelected(RACE.id, true);
  assert.deepEqual([exported.value.count, exported.value.address], [0, null]);
});

/** @type {(answer: (address: string, request: any) => [number, object]) => void} */
const answerBy = (answer) => {
  globalThis.fetch = /** @type {any} */ ((/** @type {URL} */ address, /** @type {any} */ request) => {
    const [status, body] = answer(String(address), request);
    return Promise.resolve(new Response(JSON.stringify(body), { status }));
  });
};

test("each file tells what came of it, and a large one is not even sent", async () => {
  const sent = /** @type {string[]} */ ([]);
  answerBy((address, { body }) => {
    sent.push(new URL(address).pathname);
    return body.name === "bad.zip" ? [422, { detail: "It is no archive." }] : [201, { items: [TRAINING, RACE] }];
  });
  const big = new File([new Uint8Array(2 ** 20 + 1)], "big.zip");
  await importFiles([new File(["a"], "two.zip"), new File(["b"], "bad.zip"), big]);
  assert.deepEqual(imports.value.map(({ name, state }) => [name, state]), [
    ["two.zip", "done"], ["bad.zip", "refused"], ["big.zip", "refused"],
  ]);
  assert.deepEqual(imports.value.map(({ words }) => words), [
    "has brought 2 runs.", "It is no archive.", "The file has 2 MiB; the most is 1 MiB here.",
  ]);
  assert.equal(sent.length, 2);
});
