// The options are asked for until they come, and again when stored robots have changed since.
import assert from "node:assert/strict";
import { mock, test } from "node:test";
import { applyEvent, followOptions, isLockedOut, options } from "../../static/js/store.js";
import { OPTIONS } from "./options.js";

/** Requests that are not answered yet. @type {((answer: Response) => void)[]} */
const waiting = [];
globalThis.fetch = () => new Promise((resolve) => {
  waiting.push(resolve);
});
mock.timers.enable({ apis: ["setTimeout"] });

const settled = () => new Promise((resolve) => {
  setImmediate(resolve);
});

/** Answer the oldest request. @type {(status: number, robotsVersion?: number) => Promise<void>} */
async function answer(status, robotsVersion = 0) {
  assert.equal(waiting.length, 1);
  waiting.shift()?.(new Response(JSON.stringify({ ...OPTIONS, robots_version: robotsVersion }), { status }));
  await settled();
}

test("options follow the stored robots", async () => {
  let firsts = 0;
  followOptions(() => (firsts += 1));
  await answer(503);
  assert.deepEqual([firsts, options.value, waiting.length], [0, null, 0]);
  mock.timers.tick(500);

  // The robots change while the answer is on its way, which was written before.
  applyEvent("snapshot", { runs: [], robots_version: 5 });
  applyEvent("robots", { count: 1, version: 6 });
  await answer(200, 5);
  assert.deepEqual([firsts, options.value?.robots_version, waiting.length], [1, 5, 0]);
  mock.timers.tick(1000);
  await answer(200, 6);
  assert.equal(options.value?.robots_version, 6);

  // They change between the answer and the first words of a new stream; a stream that knows nothing new asks nothing.
  applyEvent("snapshot", { runs: [], robots_version: 6 });
  await settled();
  assert.equal(waiting.length, 0);
  applyEvent("snapshot", { runs: [], robots_version: 7 });
  await settled();
  await answer(500);
  mock.timers.tick(500);
  await answer(200, 7);
  assert.deepEqual([firsts, options.value?.robots_version, waiting.length], [1, 7, 0]);
});

test("a server that wants a token locks the page out until it answers", async () => {
  applyEvent("robots", { count: 1, version: 8 });
  await settled();
  await answer(401);
  assert.equal(isLockedOut.value, true);
  mock.timers.tick(500);
  await answer(200, 8);
  assert.equal(isLockedOut.value, false);
});
