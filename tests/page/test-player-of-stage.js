// The run on stage as a page plays it: what it asks the server for beside what is pushed, and what it draws.
import assert from "node:assert/strict";
import { mock, test } from "node:test";
import { drawIn, followPlayer, position, tick } from "../../static/js/player.js";
import { unpack } from "../../static/js/replay-frames.js";
import { applyEvent, connection, scene } from "../../static/js/store.js";
import { encoded, pushed } from "./frames.js";
import { makeStage } from "./options.js";

const SEGMENT_FRAMES = 64;
/** Requests, by the last part of the address. @type {string[]} */
let requests = [];

/** @param {URL} address */
function answerTo({ pathname, searchParams }) {
  const [level, last] = pathname.split("/").slice(-2);
  requests.push(last);
  if (pathname.endsWith("/moment")) return new Response(encoded(Number(searchParams.get("time_s"))));
  if (!pathname.includes("/segments/")) return new Response(encoded(0));
  const first = SEGMENT_FRAMES * Number(last);
  const times = Array.from({ length: SEGMENT_FRAMES }, (_, n) => ((first + n) * 2 ** Number(level)) / 30);
  return new Response(encoded(...times));
}
globalThis.fetch = (address) => Promise.resolve(answerTo(new URL(String(address))));
globalThis.requestAnimationFrame = () => 0;

let now = 0;
mock.method(performance, "now", () => now);
followPlayer();
/** Messages that the 3D view got. @type {Record<string, any>[]} */
const drawn = [];
drawIn((messages) => drawn.push(...messages));

/** Let so many pictures pass, and answers come. @param {number} pictures */
async function wait(pictures) {
  for (let n = 0; n <= pictures; n += 1) {
    if (n > 0) tick((now += 16));
    for (let turn = 0; turn < 3; turn += 1) {
      await new Promise((resolve) => {
        setImmediate(resolve);
      });
    }
  }
}

/** Time of the server's clock now [s]: that of this page. */
const server_s = () => now / 1000;

/**
 * Let the stage show a run from a moment on.
 * @param {number} time_s
 * @param {number} [rate]
 * @param {any} [changes]
 */
function stageShows(time_s, rate = 0, { sent_s = server_s(), computed_s = 4, ...changes } = {}) {
  const playhead = { at_s: server_s(), points: [[0, time_s]], rate, computed_s, duration_s: null, time_out_s: 3 };
  applyEvent("stage", makeStage({
    run_id: "a", phase: "showing", playing: rate > 0, sent_s, playhead: /** @type {any} */ (playhead), ...changes,
  }));
}

/**
 * Push frames, or the one of a moment.
 * @param {number} first
 * @param {number} count
 * @param {any} [changes]
 */
async function push(first, count, { level = 1, time_s = null, ...changes } = {}) {
  const times = Array.from({ length: count }, (_, n) => ((first + n) * 2 ** level) / 30);
  const data = await pushed(...(time_s === null ? times : [time_s]));
  applyEvent("piece", {
    run_id: "a", clock: "paper", version: "1", level, first, time_s, sent_s: -1, playhead: {}, data, ...changes,
  });
  await unpack(data);
  await wait(0);
}
/** Where the leader is drawn, which is at its time [s]. */
const drawn_s = () => -drawn.findLast(({ type }) => type === "SetPositionMessage")?.position[0];

/** Begin anew with the stage, as when the page is opened. @param {() => void} show */
async function follow(show) {
  stageShows(0, 0, { run_id: null, version: null, computed_s: 0 });
  await wait(2);
  requests = [];
  show();
  await wait(2);
}

test("an empty stage shows the start line", async () => {
  stageShows(1, 0);
  await wait(3);
  requests = [];
  stageShows(0, 0, { run_id: null, version: null, computed_s: 0 });
  await wait(3);
  assert.deepEqual(requests, ["start-line"]);
});

test("a page that begins asks for what the stage shows at once, and for the next second", async () => {
  await follow(() => stageShows(2, 2));
  await wait(8);
  assert.deepEqual(requests, ["scene", "0"]);
  assert.ok(Math.abs(drawn_s() - position.value) < 0.25, `${drawn_s()} at ${position.value}`);
  await wait(30);
  assert.ok(drawn_s() > 2.9, "it moves at the stage's rate");
});

test("what is pushed is drawn and not asked for", async () => {
  await follow(() => stageShows(2, 2));
  await push(0, 32);
  await push(32, 64);
  requests = [];
  await wait(60);
  assert.deepEqual(requests, []);
  assert.ok(drawn_s() > 3.5);
});

test("a stage that holds is drawn at the very moment: as it is pushed, else as it is asked for soon", async () => {
  await follow(() => stageShows(2, 2));
  await push(0, 64);
  requests = [];
  stageShows(2.345);
  await push(0, 1, { level: null, first: null, time_s: 2.345 });
  await wait(30);
  assert.deepEqual([requests, drawn_s(), position.value], [[], 2.345, 2.345]);
  stageShows(1.23);
  await wait(2);
  assert.equal(drawn_s(), 1.2, "the nearest frame comes first");
  await wait(25);
  assert.deepEqual([requests, drawn_s()], [["moment"], 1.23]);
  assert.deepEqual([scene.value?.time_s, scene.value?.playing], [1.23, false]);
});

test("at the photo finish the page is told of it", async () => {
  await follow(() => stageShows(3));
  await wait(25);
  assert.deepEqual([scene.value?.phase, scene.value?.shown_speed, scene.value?.time_out_s], ["photo-finish", 0, 3]);
});

test("another version of the run is shown once its frames and its scene are there, without flicker", async () => {
  await follow(() => stageShows(2, 1));
  await push(0, 64);
  requests = [];
  stageShows(2.2, 1, { version: "2" });
  await wait(3);
  assert.deepEqual(requests, ["scene"]);
  assert.ok(drawn_s() >= 2);
  const before = drawn.length;
  await push(0, 64, { version: "2" });
  await wait(3);
  assert.deepEqual(requests, ["scene"]);
  assert.deepEqual(drawn.slice(before).filter(({ type }) => type === "RemoveSceneNodeMessage"), []);
});

test("a network that stalls leaves the last picture, and then the page is where the stage is", async () => {
  await follow(() => stageShows(0, 1));
  await push(0, 8);
  const answer = globalThis.fetch;
  globalThis.fetch = () => new Promise(() => {});
  await wait(80);
  const held_s = drawn_s();
  assert.ok(held_s < 0.6, "no frame is drawn that is not there");
  assert.ok(Math.abs(position.value - held_s) < 0.1, "the bar stays with the picture");
  globalThis.fetch = answer;
  await push(8, 40);
  await wait(2);
  assert.ok(Math.abs(drawn_s() - (80 + 4) * 0.016) < 0.2, `${drawn_s()}`);
});

test("while the server is away the last picture of the stage stays", async () => {
  await follow(() => stageShows(1, 2));
  await push(0, 64);
  await wait(4);
  connection.value = "reconnecting";
  const last_s = drawn_s();
  await wait(20);
  assert.equal(drawn_s(), last_s);
  connection.value = "live";
  await wait(2);
  assert.ok(drawn_s() > last_s + 0.3);
});

test("a page that is not seen draws nothing, and is told the figures all the same", async () => {
  await follow(() => stageShows(1, 2));
  await push(0, 64);
  await wait(4);
  Object.assign(globalThis.document, { hidden: true });
  const [count, before_s] = [drawn.length, scene.value?.time_s ?? NaN];
  await wait(40);
  assert.equal(drawn.length, count);
  assert.ok((scene.value?.time_s ?? NaN) > before_s);
  Object.assign(globalThis.document, { hidden: false });
  await wait(1);
  assert.ok(Math.abs(drawn_s() - position.value) < 0.2);
});

test("of a run that has recorded nothing the page is told its start, until there is a frame", async () => {
  await follow(() => stageShows(0, 0, { computed_s: 0, phase: "live" }));
  await wait(3);
  assert.deepEqual([requests, scene.value?.label, scene.value?.time_s], [["scene"], "A", 0]);
  stageShows(1, 0);
  await push(0, 1, { level: null, first: null, time_s: 1 });
  await wait(2);
  assert.equal(scene.value?.time_s, 1);
});

test("what is late of a run that is computed is waited for longer", async () => {
  await follow(() => stageShows(1, 1, { live: true }));
  await push(0, 16);
  requests = [];
  await wait(60);
  assert.deepEqual(requests, []);
  await wait(60);
  assert.deepEqual(requests, ["1"]);
});
