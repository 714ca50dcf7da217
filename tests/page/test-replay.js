// A replay of the page's own: what it asks the server for, and what it draws.
import assert from "node:assert/strict";
import { afterEach, test } from "node:test";
import { view } from "../../static/js/page.js";
import {
  closeReplay, drawIn, openReplay, playReplay, replayProblem, replayTime, seekReplay, tick,
} from "../../static/js/replay.js";

const PLAN = {
  run_id: "a", kind: "race", complete: true, duration_s: 4, recorded_s: [[0, 4]], step_ends_s: [[1, 2, 3, 4]],
  marks: [], frame_s: 1 / 30, segment_frames: 64, lowest_level: -3, highest_level: 7,
};

/** A frame as the server encodes it. @param {number} time_s */
function encoded(time_s) {
  const frame = { time_s, follow: { leader: [0, time_s], 2: [1, time_s] }, scene: null, messages: [] };
  const head = new TextEncoder().encode(JSON.stringify({ lengths: [], world: "/world", frames: [frame] }));
  const data = new Uint8Array(4 + head.length);
  new DataView(data.buffer).setUint32(0, head.length, true);
  data.set(head, 4);
  return data;
}

/** Requests, by the last part of the address. @type {string[]} */
let asked = [];
/** Answers to requests for moments. @type {(time_s: number) => Response} */
let moment = (time_s) => new Response(encoded(time_s));

/** @param {URL} address */
function answerTo({ pathname, searchParams }) {
  asked.push(/** @type {string} */ (pathname.split("/").at(-1)));
  if (pathname.endsWith("/replay")) return new Response(JSON.stringify(PLAN));
  if (pathname.endsWith("/scene")) return new Response(encoded(0));
  return moment(Number(searchParams.get("time_s")));
}
globalThis.fetch = (address) => Promise.resolve(answerTo(new URL(String(address))));
globalThis.history.pushState = () => {};

let now = 0;
/** Let so many pictures pass. @param {number} pictures */
async function wait(pictures) {
  for (let n = 0; n < pictures; n += 1) {
    tick((now += 16));
    await new Promise((resolve) => {
      setImmediate(resolve);
    });
  }
}

afterEach(() => {
  closeReplay();
  asked = [];
  moment = (time_s) => new Response(encoded(time_s));
});

test("a held replay asks for each moment once", async () => {
  await openReplay("a", { time_s: 1, isPlaying: false });
  await wait(20);
  seekReplay(2);
  await wait(20);
  assert.deepEqual(asked, ["replay", "scene", "moment", "moment"]);
});

test("a server that does not answer is not asked again at each picture", async () => {
  moment = () => new Response("{}", { status: 503 });
  await openReplay("a", { time_s: 1, isPlaying: false });
  await wait(60);
  assert.equal(asked.filter((one) => one === "moment").length, 1);
  assert.equal(replayProblem.value, null, "it may come back");
});

test("a run that was deleted meanwhile is told, and asked for no more", async () => {
  await openReplay("a", { time_s: 1, isPlaying: false });
  await wait(5);
  moment = () => new Response(JSON.stringify({ detail: "There is no run." }), { status: 404 });
  seekReplay(2);
  await wait(60);
  assert.equal(replayProblem.value, "There is no run.");
  assert.equal(asked.filter((one) => one === "moment").length, 2);
});

test("a held replay follows another robot at once", async () => {
  /** @type {any[]} */
  const drawn = [];
  drawIn((messages) => drawn.push(...messages));
  await openReplay("a", { time_s: 3, isPlaying: false });
  await wait(5);
  view.value = "2";
  await wait(2);
  assert.deepEqual(drawn.at(-1), { type: "SetPositionMessage", name: "/world", position: [-1, -3, 0], owner: "" });
  view.value = "leader";
});

test("played again at its end it begins anew", async () => {
  await openReplay("a", { time_s: 4, isPlaying: false });
  playReplay(true);
  assert.equal(replayTime.value, 0);
  playReplay(false);
});
