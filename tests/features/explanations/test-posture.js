// The state that was chosen with a click: which move a cell in the scene is, and what becomes of the ghost.
import assert from "node:assert/strict";
import { afterEach, beforeEach, test } from "node:test";
import {
  chosenState, chooseState, followChosenState, giveUpState, moveAt, whyNoGhost,
} from "../../../static/features/explanations/posture.js";
import { clickedCell, drawHere } from "../../../static/js/page.js";
import { sceneCount } from "../../../static/js/picture.js";
import { chosenLane, chosenMoment } from "../../../static/features/explanations/steps.js";
import { applyEvent, options, scene } from "../../../static/js/store.js";
import { makeRun, OPTIONS } from "../../page/options.js";

/** @import { Message } from "../../../static/js/replay-frames.js" */

const GRID = {
  pairs: [[1, 4], [2, 5], [3, 6]], cell_names: ["home", "front left", "front right", "back left", "back right"],
  cells_m: /** @type {[number, number][]} */ ([]),
};
const STAGE = { run_id: null, next_run_id: null, playing: true, speed: 1, clock: "paper" };
const NODE = "/world/run/lane1/grid/posture";

/** @type {Message[]} */
let drawn = [];
/** @type {URL[]} */
let requests = [];
let stop = () => {};
const { fetch } = globalThis;

/** An encoding of a ghost's messages, as app/viewer/replay_frames.py makes it. @param {Message[]} messages */
function encoded(messages) {
  const head = new TextEncoder().encode(JSON.stringify({ lengths: [], frames: [{ time_s: 0, messages }] }));
  const data = new Uint8Array(4 + head.length);
  new DataView(data.buffer).setUint32(0, head.length, true);
  data.set(head, 4);
  return new Response(data);
}

/** Show a step of a race of two lanes, the second of which has learned. @param {string} id @param {number} time_s */
function show(id, time_s) {
  const action_values = time_s > 0 ? { ...GRID, lane: 1, current: [4, 0, 2] } : null;
  const lanes = [{ step: 5, steps: 50 }, { step: 6, steps: 50 }];
  scene.value = /** @type {any} */ ({ run_id: id, kind: "race", phase: "race", time_s, lanes, action_values });
}

/** Put a race on stage. */
function stageRace() {
  const race = makeRun({ kind: "race", config: { steps: 50, lanes: [{ agent: "greedy" }, { agent: "learner" }] } });
  applyEvent("snapshot", { runs: [race], stage: { ...STAGE, run_id: race.id }, scene: null });
  show(race.id, 3.5);
  return race;
}

const settled = () => new Promise((resolve) => {
  setTimeout(resolve);
});

beforeEach(() => {
  options.value = OPTIONS;
  chosenMoment.value = null;
  chosenLane.value = null;
  [drawn, requests] = [[], []];
  drawHere.value = (messages) => drawn.push(...messages);
  globalThis.fetch = (address) => {
    requests.push(new URL(String(address)));
    return Promise.resolve(encoded([{ type: "FrameMessage", name: NODE, props: {} }]));
  };
  stop = followChosenState();
});
afterEach(() => {
  stop();
  globalThis.fetch = fetch;
});

test("a cell of a foot grid is a move of its lane, by its number in its batch", () => {
  const node = "/world/run/lane2/grid/others/fills";
  assert.deepEqual(moveAt({ node, instance: 0 }, GRID), { lane: 2, move: [0, 1] });
  assert.deepEqual(moveAt({ node, instance: 11 }, GRID), { lane: 2, move: [2, 4] }, "leg 3");
  assert.deepEqual(moveAt({ node, instance: 23 }, GRID), { lane: 2, move: [2, 4] }, "its partner, leg 6");
  assert.deepEqual(moveAt({ node: "/world/run/lane0/grid/home/fills", instance: 4 }, GRID), { lane: 0, move: [1, 0] });
  assert.equal(moveAt({ node, instance: 24 }, GRID), null);
  assert.equal(moveAt({ node: "/world/run/robots/3", instance: 0 }, GRID), null);
});

test("a chosen state is drawn in the 3D view until it is given up", async () => {
  const race = stageRace();
  chooseState([0, 3, 1], [2, 2]);
  await settled();
  assert.match(requests[0].pathname, new RegExp(`/runs/${race.id}/replay/posture$`));
  assert.deepEqual(Object.fromEntries(requests[0].searchParams), {
    lane: "1", cells: "0,3,1", time_s: "3.5", clock: "paper",
  });
  assert.deepEqual(drawn.map(({ type }) => type), ["FrameMessage"]);
  show(race.id, 3.7);
  await settled();
  assert.equal(requests.length, 1, "the grid carries the ghost along");
  giveUpState();
  assert.deepEqual(drawn.at(-1), { type: "RemoveSceneNodeMessage", name: NODE, owner: "" });
});

test("a ghost goes with its run, its lane, the scene that it is in, and the panel", async () => {
  const leavings = [
    () => stageRace(), () => (chosenLane.value = 0), () => (drawHere.value = () => {}), () => (sceneCount.value += 1),
    () => stop(),
  ];
  for (const leave of leavings) {
    stageRace();
    chosenLane.value = null;
    chooseState([0, 0, 0], [0, 1]);
    await settled();
    assert.ok(chosenState.value);
    leave();
    assert.equal(chosenState.value, null);
  }
});

test("there is no ghost without a foot grid or a 3D view", async () => {
  const race = stageRace();
  show(race.id, 0);
  chosenLane.value = 1;
  chooseState([0, 0, 0], [0, 1]);
  await settled();
  assert.match(String(whyNoGhost.value), /before the first step/);
  assert.deepEqual(requests, []);
  show(race.id, 1);
  await settled();
  assert.equal(requests.length, 1);
  drawHere.value = null;
  assert.match(String(whyNoGhost.value), /not loaded/);
});

test("a cell clicked in the scene is that move in the present state, of the lane it is on", () => {
  const race = stageRace();
  chosenMoment.value = { run_id: race.id, lane: 1, step: 2 };
  const cell = { node: "/world/run/lane1/grid/others/fills", instance: 5 };
  clickedCell.value = { ...cell, run_id: "another" };
  assert.equal(chosenState.value, null);
  clickedCell.value = { ...cell, run_id: race.id };
  const expected = { run_id: race.id, lane: 1, cells: [4, 0, 2], move: [1, 2], from: "scene" };
  assert.deepEqual(chosenState.value, expected);
  assert.equal(chosenMoment.value, null, "it follows the stage");
  assert.equal(clickedCell.value, null);
  assert.deepEqual(requests, []);
});
