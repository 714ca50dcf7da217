// Asking the server for what is newest: one request at a time, and again only where that may help.
import assert from "node:assert/strict";
import { afterEach, beforeEach, mock, test } from "node:test";
import { signal } from "@preact/signals";
import { AGAIN_MS, askForNewest } from "../../static/js/api.js";

const PAUSE_MS = 300;

const key = signal("");
/** What was asked for, in order. @type {string[]} */
let requests = [];
/** How often the answer was forgotten. */
let forgotten = 0;
/** Statuses of the next answers, then 200. @type {number[]} */
let refusals = [];
/** Lets the request that is under way end. */
let answer = () => {};
let stop = () => {};

beforeEach(() => {
  mock.timers.enable({ apis: ["setTimeout"] });
  [key.value, requests, forgotten, refusals] = ["", [], 0, []];
  stop = askForNewest({
    key: () => key.value,
    ask: (requestKey) => new Promise((resolve, reject) => {
      requests.push(requestKey);
      const status = refusals.shift() ?? 200;
      answer = () => (status === 200 ? resolve() : reject(Object.assign(new Error("no"), { status })));
    }),
    forget: () => (forgotten += 1),
    pause_ms: () => PAUSE_MS,
  });
});

afterEach(() => {
  stop();
  mock.timers.reset();
});

/** Let the request end, and time pass after it. @param {number} wait_ms */
async function answered(wait_ms) {
  answer();
  await new Promise((resolve) => {
    setImmediate(resolve);
  });
  mock.timers.tick(wait_ms);
}

test("one request at a time, then one for the newest key after the pause", async () => {
  key.value = "1";
  key.value = "2";
  key.value = "3";
  assert.deepEqual(requests, ["1"]);
  await answered(PAUSE_MS - 1);
  assert.deepEqual(requests, ["1"]);
  mock.timers.tick(1);
  assert.deepEqual(requests, ["1", "3"]);
  await answered(10 * PAUSE_MS);
  assert.deepEqual(requests, ["1", "3"], "what is known is not asked for");
});

test("nothing is wanted: the answer is forgotten once, and asked for again when it is wanted again", async () => {
  assert.equal(forgotten, 0, "there was no answer");
  key.value = "1";
  await answered(PAUSE_MS);
  key.value = "";
  assert.equal(forgotten, 1);
  key.value = "1";
  assert.deepEqual(requests, ["1", "1"]);
  key.value = "";
  assert.equal(forgotten, 1, "a request is under way");
  await answered(PAUSE_MS);
  assert.deepEqual([requests.length, forgotten], [2, 2]);
});

test("after an error that may pass the newest key is asked for, later than after an answer", async () => {
  refusals = [503, 429, 503];
  key.value = "1";
  await answered(AGAIN_MS - 1);
  assert.deepEqual(requests, ["1"]);
  mock.timers.tick(1);
  assert.deepEqual(requests, ["1", "1"]);
  key.value = "2";
  await answered(AGAIN_MS);
  assert.deepEqual(requests, ["1", "1", "2"]);
  key.value = "";
  await answered(AGAIN_MS);
  assert.deepEqual([requests.length, forgotten], [3, 1], "the error is forgotten like an answer");
});

test("after an error that interrupts what was known, that is asked for anew", async () => {
  key.value = "1";
  await answered(PAUSE_MS);
  refusals = [503];
  key.value = "2";
  key.value = "1";
  await answered(AGAIN_MS);
  assert.deepEqual(requests, ["1", "2", "1"]);
});

test("an error that lasts counts as known", async () => {
  refusals = [404];
  key.value = "1";
  await answered(10 * AGAIN_MS);
  assert.deepEqual(requests, ["1"]);
  key.value = "2";
  assert.deepEqual(requests, ["1", "2"]);
});

test("nothing is asked for or forgotten after the end", async () => {
  key.value = "1";
  key.value = "2";
  stop();
  await answered(PAUSE_MS);
  key.value = "";
  assert.deepEqual([requests, forgotten], [["1"], 0]);
});
