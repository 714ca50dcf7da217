// The server's clock, and a stream of events that is opened again, replaced, and made up for by snapshots.
import assert from "node:assert/strict";
import { afterEach, beforeEach, mock, test } from "node:test";
import { signal } from "@preact/signals";
import { isPolling, openEvents, ServerClock } from "../../static/js/events.js";

// ---- the clock

test("the server's clock is known by the message that was least late", () => {
  const clock = new ServerClock();
  clock.note(100, 1000.3);
  clock.note(101, 1001.05);
  clock.note(102, 1002.9);
  assert.equal(clock.at(1010).toFixed(2), "109.95");
});

test("what a message has said counts for a minute, since clocks drift", () => {
  const clock = new ServerClock();
  clock.note(100, 1000);
  for (let s = 1; s <= 59; s += 1) clock.note(100 + s, 1000.2 + s);
  assert.equal(clock.at(1059.2).toFixed(2), "159.20");
  clock.note(161, 1061.2);
  assert.equal(clock.at(1061.2).toFixed(2), "161.00");
  assert.ok(clock.delays.length <= 2, "few messages are kept");
});

test("a server that was started anew has another clock, a late snapshot has not", () => {
  const clock = new ServerClock();
  clock.note(5000, 1000);
  clock.note(5010, 1011.5, true);
  assert.equal(clock.at(1011.5).toFixed(2), "5011.50");
  clock.note(3, 1020, true);
  assert.equal(clock.at(1020).toFixed(2), "3.00");
  clock.note(7000, 1030);
  assert.equal(clock.at(1030).toFixed(2), "7000.00", "one that is ahead is believed at once");
});

// ---- the stream

/** @type {Source[]} */
let sources = [];
class Source {
  /** @param {string} address */
  constructor(address) {
    this.address = address;
    this.isClosed = false;
    /** @type {() => void} */
    this.onerror = () => {};
    /** @type {Map<string, (event: { data: string }) => void>} */
    this.listeners = new Map();
    sources.push(this);
  }

  /** @param {string} name @param {(event: { data: string }) => void} listener */
  addEventListener(name, listener) { this.listeners.set(name, listener); }
  close() { this.isClosed = true; }
  /** @param {string} name @param {object} data */
  send(name, data = {}) { if (!this.isClosed) this.listeners.get(name)?.({ data: JSON.stringify(data) }); }
}
Object.assign(globalThis, { EventSource: Source });

const address = signal("http://page.test/api/v1/events?picture=true");
/** What was told: states, and names of events; `+` of a snapshot while the connection held. @type {string[]} */
let told = [];
/** Answers to polls; null: none comes. @type {object | null} */
let polled = null;
/** @type {string[]} */
let polls = [];
globalThis.fetch = (url) => {
  polls.push(String(url));
  return polled ? Promise.resolve(new Response(JSON.stringify(polled))) : Promise.reject(new Error("away"));
};
/** @type {() => void} */
let close = () => {};
/** What the page does when the browser tells something, by its name. @type {Map<string, () => void>} */
const listeners = new Map();
for (const target of [globalThis, globalThis.document]) {
  Object.assign(target, {
    addEventListener: (/** @type {string} */ type, /** @type {() => void} */ act) => listeners.set(type, act),
  });
}
const newest = () => sources[sources.length - 1];

beforeEach(() => {
  mock.timers.enable({ apis: ["setTimeout", "setInterval", "Date"] });
  [sources, told, polls, polled] = [[], [], [], null];
  address.value = "http://page.test/api/v1/events?picture=true";
  const onEvent = (/** @type {string} */ name, /** @type {any} */ _, /** @type {boolean} */ isContinued) =>
    told.push(name + (name === "snapshot" && isContinued ? "+" : ""));
  close = openEvents(["snapshot", "stage", "clock"], onEvent, (state) => told.push(state),
    () => ({ stream: address.value, snapshot: "http://page.test/api/v1/events/snapshot" }));
});
afterEach(() => {
  close();
  mock.timers.reset();
});

/** Let time pass, and answers come. @param {number} ms */
async function pass(ms) {
  for (let left = ms; left >= 0; left -= 500) {
    mock.timers.tick(Math.min(left, 500));
    for (let n = 0; n < 3; n += 1) {
      await new Promise((resolve) => {
        setImmediate(resolve);
      });
    }
  }
}

/** The page sleeps: time passes, and its timers do not. @param {number} ms */
const sleep = (ms) => mock.timers.setTime(Date.now() + ms);

test("the connection is live with the first snapshot, and stays so while anything comes", async () => {
  newest().send("snapshot");
  await pass(14_000);
  newest().send("clock");
  await pass(14_000);
  assert.deepEqual(told, ["connecting", "snapshot", "live", "clock"]);
  assert.deepEqual([sources.length, polls], [1, []]);
});

test("a stream that is cut is made up for at once, and said to be away only if that fails", async () => {
  newest().send("snapshot");
  polled = { stage: null };
  newest().onerror();
  await pass(0);
  assert.deepEqual(told.slice(3), ["snapshot+", "live"]);
  assert.deepEqual(polls, ["http://page.test/api/v1/events/snapshot"]);
  polled = null;
  await pass(2000);
  assert.equal(told.at(-1), "reconnecting");
  assert.ok(sources.length > 1, "the stream is tried again meanwhile");
  newest().send("snapshot");
  const count = polls.length;
  await pass(20_000);
  assert.deepEqual([told.slice(-2), polls.length], [["snapshot", "live"], count], "no poll beside the stream");
});

test("a stream that brings nothing is made up for by snapshots: a proxy may hold it back", async () => {
  polled = { stage: null };
  await pass(4000);
  assert.deepEqual(told, ["connecting", "snapshot", "live"]);
  assert.ok(isPolling.value, "which is said");
  await pass(2000);
  assert.deepEqual(told.slice(3), ["snapshot+", "live"]);
  await pass(200_000);
  assert.ok(sources.length < 12, "as the server writes into what is held back, it is tried more and more seldom");
  assert.equal(told.at(-1), "live");
  for (let s = 0; newest().isClosed && s < 60; s += 1) await pass(1000);
  newest().send("snapshot");
  assert.equal(isPolling.value, false);
});

for (const type of ["visibilitychange", "resume", "pageshow"]) {
  test(`after a sleep it is connected anew and asked for news at once, by ${type}`, async () => {
    newest().send("snapshot");
    polled = { stage: null };
    const [stale] = sources;
    sleep(75_000);
    listeners.get(type)?.();
    await pass(0);
    assert.deepEqual([stale.isClosed, sources.length, polls.length], [true, 2, 1]);
    assert.deepEqual(told.slice(3), ["reconnecting", "snapshot", "live"]);
    newest().send("snapshot");
    assert.deepEqual(told.slice(6), ["snapshot+", "live"]);
    listeners.get(type)?.();
    assert.equal(sources.length, 2, "once");
  });
}

test("a sleep of which nothing is told is seen by a late timer, and what was sent before it is old", async () => {
  newest().send("snapshot");
  sleep(75_000);
  await pass(1000);
  assert.equal(sources.length, 2);
  newest().send("snapshot");
  sleep(75_000);
  newest().send("stage");
  assert.deepEqual([sources.length, told.includes("stage")], [3, false]);
});

test("a page that was hidden and has heard all goes on; another network is another connection", async () => {
  newest().send("snapshot");
  await pass(9000);
  newest().send("clock");
  await pass(9000);
  listeners.get("visibilitychange")?.();
  assert.equal(sources.length, 1);
  listeners.get("online")?.();
  assert.equal(sources.length, 2);
});

test("a stream that falls silent is opened again", async () => {
  newest().send("snapshot");
  await pass(25_000);
  assert.ok(sources[0].isClosed);
  await pass(500);
  assert.equal(sources.length, 2);
});

test("another stream takes the place of the open one, which is no break", () => {
  newest().send("snapshot");
  address.value = "http://page.test/api/v1/events?picture=false";
  assert.deepEqual(sources.map(({ isClosed }) => isClosed), [true, false]);
  newest().send("snapshot");
  assert.deepEqual(told, ["connecting", "snapshot", "live", "snapshot+", "live"]);
});

test("once closed nothing is told, and nothing asked for", async () => {
  newest().send("snapshot");
  close();
  await pass(60_000);
  assert.deepEqual([told.length, sources.length, polls], [3, 1, []]);
});
