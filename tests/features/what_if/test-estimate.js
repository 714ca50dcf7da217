// Estimates of a start: asked once the form has come to rest, told only if it is long.
import assert from "node:assert/strict";
import { beforeEach, mock, test } from "node:test";
import { raceEstimate } from "../../../static/features/what_if/estimate.js";
import { setField } from "../../../static/js/form.js";
import { page } from "../../../static/js/page-state.js";
import { connection, options, role } from "../../../static/js/store.js";
import { OPTIONS } from "../../page/options.js";

mock.timers.enable({ apis: ["setTimeout"] });

/** @type {any[]} */
let requests = [];
let seconds = 0;
let status = 200;
globalThis.fetch = /** @type {any} */ ((/** @type {URL} */ { pathname }, /** @type {any} */ { body }) => {
  requests.push([pathname, JSON.parse(body).lanes[0].training.steps]);
  return Promise.resolve(new Response(JSON.stringify({ seconds, detail: "others wait" }), { status }));
});

async function rest() {
  mock.timers.tick(1000);
  for (let turn = 0; turn < 20; turn += 1) await Promise.resolve();
}

beforeEach(() => {
  options.value = OPTIONS;
  role.value = "operator";
  connection.value = "live";
  page.form.value = new URLSearchParams();
  requests = [];
});

test("a practice as by default is short, and nobody asks", async () => {
  await rest();
  assert.deepEqual(requests, []);
  assert.equal(raceEstimate.value, "");
});

test("a long one is asked about once it has come to rest, and told in words", async () => {
  seconds = 150;
  for (const steps of [5000, 50_000]) setField("steps", steps);
  await rest();
  assert.deepEqual(requests, [["/api/v1/races/estimate", 50_000]]);
  assert.equal(raceEstimate.value, "Takes about 3 min on this machine.");
  setField("steps", 60_000);
  assert.equal(raceEstimate.value, "", "that was another one");
  seconds = 12;
  await rest();
  assert.equal(raceEstimate.value, "", "it is short");
});

test("it is asked again while other estimates wait, unless the form has changed", async () => {
  [seconds, status] = [150, 429];
  setField("steps", 70_000);
  await rest();
  await rest();
  assert.equal(raceEstimate.value, "");
  setField("steps", 80_000);
  status = 200;
  await rest();
  await rest();
  assert.equal(raceEstimate.value, "Takes about 3 min on this machine.");
  assert.deepEqual(requests.map(([, steps]) => steps), [70_000, 70_000, 80_000]);
});

test("a form that is not valid, or of a spectator, is not asked about", async () => {
  role.value = "spectator";
  setField("steps", 50_000);
  await rest();
  assert.deepEqual(requests, []);
});
