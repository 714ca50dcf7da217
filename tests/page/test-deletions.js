// Undo of a deletion: offered in a message and in the list, over a reload of the page, until the server lets go.
import assert from "node:assert/strict";
import { beforeEach, test } from "node:test";
import { deletions, forgetDeletion, refusals, restore, tellDeleted } from "../../static/js/deletions.js";
import { toastMessage } from "../../static/js/page.js";
import { deleteRun, deleteRuns } from "../../static/js/run-deletions.js";
import { applyEvent, isGone, requestRun, runs } from "../../static/js/store.js";
import { makeRun } from "./options.js";

const HOUR_MS = 3600 * 1000;
const inAnHour = () => new Date(Date.now() + HOUR_MS).toISOString();
/** @type {string[]} */
let requests = [];

/** @type {(answer: (method: string, path: string) => [number, object]) => void} */
const answerBy = (answer) => {
  requests = [];
  globalThis.fetch = /** @type {any} */ ((/** @type {URL} */ address, /** @type {any} */ { method }) => {
    const path = String(address).split("/api/v1/")[1];
    requests.push(`${method} ${path}`);
    const [status, body] = answer(method, path);
    return Promise.resolve(new Response(JSON.stringify(body), { status }));
  });
};

beforeEach(() => {
  deletions.value.forEach(forgetDeletion);
  toastMessage.value = null;
});

test("what is deleted can be restored, by the message and by the list", async () => {
  const run = makeRun({ name: "Heron" });
  applyEvent("run", run);
  answerBy((method) => (method === "DELETE"
    ? [200, { deleted: [run.id], kept: [], restorable_until: inAnHour() }] : [200, run]));
  await deleteRun(run);
  assert.deepEqual([isGone(run.id), toastMessage.value?.words], [true, "Deleted “Heron”."]);
  assert.deepEqual(deletions.value.map(({ ids, words }) => [ids, words]), [[[run.id], "“Heron”"]]);
  await toastMessage.value?.action?.run();
  applyEvent("run", run);
  assert.deepEqual(requests, [`DELETE runs?id=${run.id}`, `POST runs/${run.id}/restore`]);
  assert.deepEqual([isGone(run.id), runs.value.has(run.id), deletions.value], [false, true, []]);
  assert.equal(toastMessage.value?.words, "Restored “Heron”.");
});

test("several are restored together, and what was kept is told", async () => {
  const all = [makeRun({}), makeRun({}), makeRun({})];
  const ids = all.map(({ id }) => id);
  answerBy((method, path) => (method === "DELETE"
    ? [200, { deleted: ids.slice(0, 2), kept: [{ id: ids[2], reason: "it runs" }], restorable_until: inAnHour() }]
    : [200, all.find(({ id }) => path.includes(id)) ?? {}]));
  const { deleted, reasons } = await deleteRuns(all);
  assert.deepEqual([deleted, reasons, deletions.value[0].words], [ids.slice(0, 2), ["it runs"], "2 runs"]);
  assert.equal(await restore(deletions.value[0], requestRun), true);
  assert.deepEqual(requests.slice(1), ids.slice(0, 2).map((id) => `POST runs/${id}/restore`));
});

test("where it is too late, that is told and no more is offered", async () => {
  const run = makeRun({ name: "Heron" });
  answerBy((method) => (method === "DELETE" ? [200, { deleted: [run.id], kept: [], restorable_until: inAnHour() }]
    : [404, { detail: "there is no run; what was deleted can be restored for 1 h" }]));
  await deleteRun(run);
  await toastMessage.value?.action?.run();
  assert.match(toastMessage.value?.words ?? "", /restored for 1 h/);
  assert.match(refusals.value.runs, /restored for 1 h/);
  assert.deepEqual(deletions.value, []);
});

test("nothing is offered of what is gone at once, nor once its time is over", async () => {
  const run = makeRun({ name: "Heron" });
  answerBy(() => [200, { deleted: [run.id], kept: [], restorable_until: null }]);
  await deleteRun(run);
  assert.equal(toastMessage.value?.words, "Deleted “Heron” for good: the disk is full.");
  assert.equal(toastMessage.value?.action, undefined);
  answerBy(() => [200, { deleted: [run.id], kept: [], restorable_until: new Date(Date.now() - 1).toISOString() }]);
  await deleteRun(run);
  assert.deepEqual(deletions.value, []);
});

test("of each kind the newest are offered, in their list alone where a dialog is above the message", () => {
  const tell = (/** @type {string} */ kind, /** @type {string} */ id) =>
    tellDeleted(kind, { deleted: [id], kept: [], restorable_until: inAnHour() }, id, null);
  tell("robots", "Rex");
  for (let number = 1; number <= 6; number += 1) tell("lessons", `Lesson ${number}`);
  assert.equal(toastMessage.value, null);
  assert.deepEqual(deletions.value.map(({ words }) => words).toSorted(),
    ["Lesson 2", "Lesson 3", "Lesson 4", "Lesson 5", "Lesson 6", "Rex"]);
});

test("what stands in the way of an undo is told, and it can be tried again", async () => {
  const taken = "there is a robot named 'Rex' by now; give that one another name, and restore this one again";
  let status = 409;
  let shown = 0;
  answerBy(() => [status, { detail: taken }]);
  tellDeleted("robots", { deleted: ["abc"], kept: [], restorable_until: inAnHour() }, "“Rex”", null);
  const [deletion] = deletions.value;
  const take = async (/** @type {() => Promise<unknown>} */ send) => {
    await send();
    shown += 1;
  };
  assert.equal(await restore(deletion, take), false);
  assert.match(refusals.value.robots, /give that one another name/);
  assert.deepEqual(deletions.value, [deletion]);
  status = 200;
  assert.equal(await restore(deletion, take), true);
  assert.deepEqual(requests, ["POST robots/abc/restore", "POST robots/abc/restore"]);
  assert.deepEqual([shown, refusals.value.robots, deletions.value], [1, "", []]);
});
