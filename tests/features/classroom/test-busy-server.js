// A request that a busy server refuses for a while is made again by itself, and only then.
import assert from "node:assert/strict";
import { afterEach, beforeEach, mock, test } from "node:test";
import { waits, whenAdmitted } from "../../../static/features/classroom/room/busy-server.js";
import { joinRoom } from "../../../static/features/classroom/api.js";
import { RequestError } from "../../../static/js/api.js";

/** The server's answers, in their order: a status, and after how long to ask again. @type {[number, string?][]} */
let answers = [];
/** Keys and times of the requests [ms]. @type {{ key: string | null, at: number }[]} */
let requests = [];
globalThis.fetch = (_, options) => {
  const [status, retry] = answers.shift() ?? [201];
  requests.push({ key: new Headers(options?.headers).get("Idempotency-Key"), at: Date.now() });
  return Promise.resolve(new Response(JSON.stringify({ detail: "Too many; try again later" }), {
    status, headers: retry === undefined ? {} : { "Retry-After": retry },
  }));
};
const join = ({ longest_s = Infinity } = {}) =>
  whenAdmitted("join", () => joinRoom("ABCD2345", "my-key"), { longest_s });

beforeEach(() => {
  mock.timers.enable({ apis: ["setTimeout", "Date"] });
  [answers, requests] = [[], []];
});
afterEach(() => {
  mock.timers.reset();
  mock.restoreAll();
});

/** Let seconds pass, and answers come. @param {number} s */
async function pass(s) {
  for (let n = 0; n <= 10 * s; n += 1) {
    for (let turn = 0; turn < 3; turn += 1) {
      await new Promise((resolve) => {
        setImmediate(resolve);
      });
    }
    mock.timers.tick(100);
  }
}

test("it is made again with the same key when the answer says, and a while after that", async () => {
  answers = [[429, "1"], [503, "2"], [201]];
  const joined = join();
  await pass(0.5);
  assert.deepEqual(waits.value.join.words, "Many are asking the server at this moment.");
  await pass(12);
  await joined;
  assert.deepEqual(requests.map(({ key }) => key), ["my-key", "my-key", "my-key"]);
  const [first, second] = requests.slice(1).map(({ at }, n) => (at - requests[n].at) / 1000);
  assert.ok(first >= 1 && first <= 2.3 && second >= 2 && second <= 4.5, `${first} s, ${second} s`);
  assert.deepEqual(waits.value, {}, "nothing is waited for any more");
});

test("a class does not ask again at the same moment", async () => {
  const waited = [];
  for (const random of [0, 0.5, 0.99]) {
    mock.method(Math, "random", () => random);
    [answers, requests] = [[[429, "4"]], []];
    const joined = join();
    await pass(10);
    await joined;
    waited.push((requests[1].at - requests[0].at) / 1000);
  }
  assert.ok(waited[1] - waited[0] > 1.5 && waited[2] - waited[1] > 1.5, `${waited} s`);
});

test("a room that is full is told by the server's words, with the seconds that are left", async () => {
  answers = [[429, "60"]];
  const joined = join();
  await pass(0.5);
  const [before, { words }] = [waits.value.join.left_s, waits.value.join];
  assert.equal(words, "Too many; try again later.");
  await pass(10);
  assert.ok(before - waits.value.join.left_s >= 9);
  await pass(120);
  await joined;
  assert.equal(requests.length, 2);
});

test("what names no time is told at once, and what never ends at last", async () => {
  for (const answer of /** @type {[number, string?][]} */ ([[404], [429], [409], [503, "Wed, 21 Oct 2026"]])) {
    answers = [answer];
    await assert.rejects(join(), RequestError);
  }
  answers = [[429, "60"]];
  await assert.rejects(join({ longest_s: 10 }), RequestError, "what is full is no server that is busy");
  assert.equal(requests.length, 5);
  answers = Array.from({ length: 30 }, () => [429, "1"]);
  const refused = assert.rejects(join(), /Too many/);
  await pass(60);
  await refused;
  assert.equal(requests.length, 25);
});
