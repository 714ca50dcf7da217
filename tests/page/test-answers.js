// Answers that are kept in signals: one is asked for at a time, and told with why there is none.
import assert from "node:assert/strict";
import { mock, test } from "node:test";
import { signal } from "@preact/signals";
import { keepAnswer } from "../../static/js/api.js";

/** @import { Signal } from "@preact/signals" */
/** @import { Reply } from "../../static/js/api.js" */

const settled = () => new Promise((resolve) => {
  setImmediate(resolve);
});

test("one answer is asked for at a time, always the newest", async () => {
  mock.timers.enable({ apis: ["setTimeout"] });
  const key = signal("1");
  /** @type {Signal<Reply<string>>} */
  const reply = signal({ answer: null, error: null, again: false });
  /** @type {string[]} */
  const requests = [];
  const stop = keepAnswer(() => key.value, (request) => {
    requests.push(request);
    return Promise.resolve(`answer to ${request}`);
  }, reply, () => 0);
  key.value = "2";
  key.value = "3";
  await settled();
  assert.deepEqual([requests, reply.value.answer], [["1"], "answer to 1"]);
  mock.timers.tick(1000);
  await settled();
  assert.deepEqual([requests, reply.value.answer], [["1", "3"], "answer to 3"]);
  key.value = "";
  mock.timers.tick(1000);
  assert.equal(reply.value.answer, null);
  stop();
  key.value = "4";
  assert.deepEqual(requests, ["1", "3"]);
  mock.timers.reset();
});

test("a server that needs longer, or is out of order, is asked again, another refusal is not", async () => {
  mock.timers.enable({ apis: ["setTimeout"] });
  const key = signal("1");
  /** @type {Signal<Reply<string>>} */
  const reply = signal({ answer: null, error: null, again: false });
  const statuses = [429, 503, 409];
  /** @type {string[]} */
  const requests = [];
  const stop = keepAnswer(() => key.value, (request) => {
    requests.push(request);
    return Promise.reject(Object.assign(new Error("no"), { status: statuses[requests.length - 1] }));
  }, reply, () => 0);
  for (let round = 0; round < 5; round += 1) {
    await settled();
    assert.equal(reply.value.again, round < 1);
    mock.timers.tick(1000);
  }
  assert.deepEqual([requests.length, reply.value.error?.message], [3, "no"]);
  stop();
  mock.timers.reset();
});
