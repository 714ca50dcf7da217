// A replay of the page's own: what it asks the server for, and what it draws.
import assert from "node:assert/strict";
import { afterEach, test } from "node:test";
import { problems, setStage, showOnStage } from "../../static/js/actions.js";
import { page } from "../../static/js/page-state.js";
import {
  closeReplay, drawIn, endTime, followPlayer, openReplay, playback, playReplay, position, replayProblem, seekReplay,
  setReplaySpeed, tick,
} from "../../static/js/player.js";
import { applyEvent } from "../../static/js/store.js";
import { encoded } from "./frames.js";
import { makeRun } from "./options.js";

const PLAN = {
  run_id: "a", kind: "race", complete: true, duration_s: 4, recorded_s: [[0, 4]], step_ends_s: [[1, 2, 3, 4]],
  marks: [], frame_s: 1 / 30, segment_frames: 64, lowest_level: -3, highest_level: 7,
};

/** Requests, by the last part of the address. @type {string[]} */
let requests = [];
/** Answers to requests for moments. @type {(time_s: number) => Response} */
let moment = (time_s) => new Response(encoded(time_s));
/** The run as it is recorded now. @type {Partial<typeof PLAN>} */
let recorded = {};
/** Answers to requests for plans. @type {(clock: string) => Response | Promise<Response>} */
let plan = recordedPlan;
function recordedPlan() {
  return new Response(JSON.stringify({ ...PLAN, ...recorded }));
}
/** Answer to a change of the stage. */
let stageAnswer = new Response("null");

/** @type {(level: number, number: number) => Response} */
function segment(level, number) {
  const { recorded_s: [[, end]], frame_s, segment_frames } = { ...PLAN, ...recorded };
  const times = Array.from({ length: segment_frames }, (_, n) => (number * segment_frames + n) * frame_s * 2 ** level);
  const shown = times.filter((time) => time <= end);
  return shown.length ? new Response(encoded(...shown)) : new Response("{}", { status: 404 });
}

/** @param {URL} address */
function answerTo({ pathname, searchParams }) {
  const [level, last] = pathname.split("/").slice(-2);
  requests.push(last);
  if (pathname.endsWith("/stage")) return stageAnswer;
  if (pathname.endsWith("/replay")) return plan(searchParams.get("clock") ?? "");
  if (pathname.endsWith("/scene")) return new Response(encoded(0));
  if (pathname.includes("/segments/")) return segment(Number(level), Number(last));
  return moment(Number(searchParams.get("time_s")));
}
globalThis.fetch = (address) => Promise.resolve(answerTo(new URL(String(address))));
globalThis.requestAnimationFrame = () => 0;
followPlayer();

/** Messages that the 3D view got. @type {Record<string, any>[]} */
const drawn = [];
drawIn((messages) => drawn.push(...messages));

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
  requests = [];
  recorded = {};
  plan = recordedPlan;
  moment = (time_s) => new Response(encoded(time_s));
});

test("a held replay asks for each moment once", async () => {
  await openReplay("a", { time_s: 1, isPlaying: false });
  await wait(20);
  seekReplay(2);
  await wait(20);
  assert.deepEqual(requests, ["replay", "scene", "moment", "moment"]);
});

test("a server that does not answer is not asked again at each picture", async () => {
  moment = () => new Response("{}", { status: 503 });
  await openReplay("a", { time_s: 1, isPlaying: false });
  await wait(60);
  assert.equal(requests.filter((name) => name === "moment").length, 1);
  assert.equal(replayProblem.value, null, "it may come back");
});

test("a run that was deleted meanwhile is told, and asked for no more", async () => {
  await openReplay("a", { time_s: 1, isPlaying: false });
  await wait(5);
  moment = () => new Response(JSON.stringify({ detail: "There is no run." }), { status: 404 });
  seekReplay(2);
  await wait(60);
  assert.equal(replayProblem.value, "There is no run.");
  assert.equal(requests.filter((name) => name === "moment").length, 2);
});

test("a replay ends when its run is deleted elsewhere, and says so", async () => {
  await openReplay("a", { time_s: 1, isPlaying: false });
  await wait(5);
  applyEvent("run-deleted", { id: "b" });
  assert.equal(replayProblem.value, null);
  applyEvent("run-deleted", { id: "a" });
  assert.equal(replayProblem.value, "This run was deleted. It can be replayed no more.");
  assert.equal(drawn.at(-1)?.type, "RemoveSceneNodeMessage", "its robots are gone too");
  requests = [];
  await wait(20);
  assert.deepEqual(requests, []);
  // Imported again it can be opened again.
  applyEvent("run", makeRun({ id: "a" }));
  await openReplay("a");
  assert.equal(replayProblem.value, null);
});

test("a held replay follows another robot at once", async () => {
  await openReplay("a", { time_s: 3, isPlaying: false });
  await wait(5);
  page.camera.value = "2";
  await wait(2);
  assert.deepEqual(drawn.at(-1), { type: "SetPositionMessage", name: "/world", position: [-1, -3, 0], owner: "" });
  page.camera.value = "directed";
});

test("played again at its end it begins anew", async () => {
  await openReplay("a", { time_s: 4, isPlaying: false });
  playReplay(true);
  assert.equal(position.value, 0);
  playReplay(false);
});

/** Number of requests for plans. */
const plansAsked = () => requests.filter((name) => name === "replay").length;

test("a run that still computes is played as far as it has come, until it ends", async () => {
  recorded = { complete: false, recorded_s: [[0, 1]] };
  await openReplay("a");
  await wait(200);
  assert.equal(position.value, 1, "it waits for more");
  recorded = { complete: false, recorded_s: [[0, 3]] };
  await wait(200);
  assert.equal(position.value, 3);
  assert.equal(endTime.value, 3);
  assert.ok(drawn.at(-1)?.position[0] < -2.9, "the newest frame is drawn");
  recorded = { complete: true, recorded_s: [[0, 3.5]] };
  await wait(200);
  assert.equal(position.value, 3.5);
  const before = plansAsked();
  assert.ok(before <= 12, `about one plan a second, not ${before}`);
  await wait(200);
  assert.equal(plansAsked(), before, "it computes no more");
  playReplay(true);
  assert.equal(position.value, 0, "it has ended");
});

test("a run that still computes has a longer time bar while it is held at the end", async () => {
  recorded = { complete: false, recorded_s: [[0, 1]] };
  await openReplay("a", { time_s: 1, isPlaying: false });
  await wait(5);
  recorded = { complete: false, recorded_s: [[0, 3]] };
  await wait(70);
  assert.deepEqual([endTime.value, position.value], [3, 1]);
});

test("no frame is requested beyond the last, however close", async () => {
  // As a sum of steps, which can be a little less than a product: the frame of 6.4 s begins a segment.
  recorded = { complete: false, recorded_s: [[0, 6.4 - 1e-12]] };
  setReplaySpeed(1);
  await openReplay("a", { time_s: 7 });
  await wait(10);
  setReplaySpeed(2);
  assert.equal(replayProblem.value, null);
});

/** Clock → lets its plan come. @type {Record<string, () => void>} */
const arrive = {};
/** A network on which plans come when the test lets them. @type {(clock: string) => Promise<Response>} */
const slowPlan = (clock) => new Promise((resolve) => {
  arrive[clock] = () => resolve(recordedPlan());
});
/** Let answers that have come be read. */
const settle = () => wait(3);

for (const order of [["wall", "free"], ["free", "wall"]]) {
  test(`of clocks that are chosen quickly the last one times the race: ${order} arrive`, async () => {
    await openReplay("a", { time_s: 2.5, isPlaying: false, clock: "paper" });
    plan = slowPlan;
    setStage({ clock: "wall" });
    setStage({ clock: "free" });
    plan = recordedPlan;
    for (const request of order) {
      arrive[request]();
      await settle();
    }
    assert.equal(playback.value?.clock, "free");
    assert.equal(position.value, 2, "at the end of the same step");
  });
}

test("a clock whose plan comes after the replay was left does not open it again", async () => {
  await openReplay("a", { clock: "paper" });
  plan = slowPlan;
  setStage({ clock: "wall" });
  closeReplay();
  plan = recordedPlan;
  arrive.wall();
  await settle();
  assert.equal(page.run.value, null);
});

test("a clock whose plan cannot be had leaves the clock and the moment as they were", async () => {
  await openReplay("a", { time_s: 2.5, isPlaying: false, clock: "paper" });
  plan = () => new Response(JSON.stringify({ detail: "The server is busy." }), { status: 503 });
  await setStage({ clock: "wall" });
  assert.equal(problems.value.stage?.message, "The server is busy.");
  assert.deepEqual([playback.value?.clock, position.value], ["paper", 2.5]);
  setStage({ speed: 2 });
  assert.equal(problems.value.stage, null);
});

test("a replay stays open until the server shows another run on the stage", async () => {
  const run = makeRun({});
  await openReplay("a");
  stageAnswer = new Response(JSON.stringify({ detail: "It has no recording." }), { status: 409 });
  await showOnStage(run);
  assert.deepEqual([problems.value[run.id]?.message, page.run.value], ["It has no recording.", "a"]);
  stageAnswer = new Response("null");
  const shown = showOnStage(run);
  assert.equal(page.run.value, "a");
  await shown;
  assert.equal(page.run.value, null);
});
