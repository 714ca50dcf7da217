// Frames of a replay: whatever was shown before, after a jump the 3D view shows that moment.
import assert from "node:assert/strict";
import { test } from "node:test";
import {
  approached, decode, Follower, momentOf, nextStep, SceneState, shotOf, unpack,
} from "../../static/js/replay-frames.js";

/** @import { Message } from "../../static/js/replay-frames.js" */

/** @type {Record<string, [string, string, string]>} */
const LIFECYCLES = {
  MeshMessage: ["scene", "create", "name"],
  RemoveSceneNodeMessage: ["scene", "remove", "name"],
  SceneNodeUpdateMessage: ["scene", "update_dict", "name"],
  SetPositionMessage: ["scene", "update_simple", "name"],
};
const create = (/** @type {string} */ name, props = {}) => ({ type: "MeshMessage", name, props });
const update = (/** @type {string} */ name, /** @type {object} */ updates) =>
  ({ type: "SceneNodeUpdateMessage", name, updates });
const place = (/** @type {string} */ name, /** @type {number} */ x) =>
  ({ type: "SetPositionMessage", name, position: [x, 0, 0] });
const remove = (/** @type {string} */ name) => ({ type: "RemoveSceneNodeMessage", name });

/** State of a browser after messages: properties by node, as viser's client keeps them. */
class Browser {
  constructor() {
    /** @type {Map<string, object>} */
    this.nodes = new Map();
  }

  /** @param {Message[]} messages */
  take(messages) {
    for (const { type, name, props, updates, position } of messages) {
      if (type === "MeshMessage") this.nodes.set(name, { ...props });
      else if (type === "RemoveSceneNodeMessage") {
        const gone = [...this.nodes.keys()].filter((node) => node === name || node.startsWith(`${name}/`));
        gone.forEach((node) => this.nodes.delete(node));
      } else if (this.nodes.has(name)) {
        Object.assign(/** @type {object} */ (this.nodes.get(name)), updates ?? { position });
      }
    }
    return this;
  }

  get picture() {
    return Object.fromEntries([...this.nodes].sort(([a], [b]) => a.localeCompare(b)));
  }
}

const START = [create("/robot", { color: "red" }), create("/flag", { visible: false }), create("/robot/name")];
const scene = (start = START) => new SceneState({
  frames: [{ time_s: 0, messages: start, follow: {}, scene: null }], lifecycles: LIFECYCLES,
});

test("a jump back takes back what changed since, and only that", () => {
  const state = scene();
  const browser = new Browser().take(state.restart());
  browser.take(state.jump([place("/robot", 5), update("/flag", { visible: true })]));
  browser.take(state.follow([create("/ghost"), create("/ghost/leg"), remove("/robot/name")]));
  const sent = state.jump([place("/robot", 1)]);

  assert.deepEqual(browser.take(sent).picture, new Browser().take([...START, place("/robot", 1)]).picture);
  assert.deepEqual(sent.filter(({ type, name }) => type === "MeshMessage" && name === "/robot"), []);
});

test("after any jumps and steps a browser shows the moment", () => {
  let seed = 7;
  const random = (/** @type {number} */ n) => (seed = (seed * 16807) % 2147483647) % n;
  const names = ["/robot", "/flag", "/robot/name", "/ghost", "/ghost/leg"];
  /** A message that can come after others. @param {Message[]} before */
  const next = (before) => {
    const name = names[random(names.length)];
    const kind = random(6);
    const parent = name.slice(0, name.lastIndexOf("/"));
    if (parent && !(parent in new Browser().take(before).picture)) return create(parent);
    if (kind === 0 || !(name in new Browser().take(before).picture)) return create(name, { color: random(3) });
    if (kind === 1) return remove(name);
    if (kind === 2) return update(name, { color: random(9) });
    if (kind === 3) return update(name, { visible: random(2) });
    return place(name, random(9));
  };
  for (let run = 0; run < 300; run += 1) {
    const state = scene();
    const browser = new Browser().take(state.restart());
    /** @type {Message[]} */
    let moment = [...START];
    for (let step = 0; step < 8; step += 1) {
      const isJump = random(3) > 0;
      if (isJump) moment = [...START];
      /** @type {Message[]} */
      const messages = [];
      for (let count = random(6); count > 0; count -= 1) messages.push(next([...moment, ...messages]));
      moment.push(...messages);
      browser.take(isJump ? state.jump(messages) : state.follow(messages));
      assert.deepEqual(browser.picture, new Browser().take(moment).picture, `run ${run}, step ${step}`);
    }
  }
});

/**
 * An encoding: size of the JSON, JSON, packed poses, blocks of arrays, each aligned to 8 bytes.
 * @type {(head: object, packed: number[], blocks: Uint8Array[]) => ArrayBuffer}
 */
const encoded = (head, packed, blocks) => {
  const json = new TextEncoder().encode(JSON.stringify({ ...head, lengths: blocks.map(({ length }) => length) }));
  const bytes = [...new Uint8Array(new Uint32Array([json.length]).buffer), ...json, ...packed];
  for (const block of blocks) {
    while (bytes.length % 8) bytes.push(0);
    bytes.push(...block);
  }
  return new Uint8Array(bytes).buffer;
};
const frameOf = (/** @type {any[]} */ ...messages) => ({ time_s: 1, follow: {}, scene: null, messages });

test("another version of the scene is shown by what differs alone, from the next moment on", () => {
  const state = scene();
  const browser = new Browser().take(state.restart());
  browser.take(state.jump([place("/robot", 5), create("/ghost")]));
  const renamed = [create("/robot", { color: "red" }), create("/flag", { visible: true }), create("/robot/plate")];
  state.rebase({ frames: [{ time_s: 0, messages: renamed, follow: {}, scene: null }] });
  const sent = state.jump([place("/robot", 5)]);

  assert.deepEqual(browser.take(sent).picture, new Browser().take([...renamed, place("/robot", 5)]).picture);
  const made = sent.filter(({ type }) => type === "MeshMessage").map(({ name }) => name);
  assert.deepEqual(made, ["/flag", "/robot/plate"]);
});

// ---- the moment that is shown

const HEAD = { at_s: 100, rate: 2, computed_s: 50, duration_s: null, time_out_s: null };
/** @type {[number, number][]} */
const POINTS = [[0, 4], [1, 6], [4, 6], [5, 8]];

test("the picture goes in straight lines between the points of the playhead, then at its rate", () => {
  const at = (/** @type {number} */ server_s) => Object.values(momentOf({ ...HEAD, points: POINTS }, server_s));
  assert.deepEqual([99, 100, 100.5, 102, 104.5, 107].map(at),
    [[4, 2], [4, 2], [5, 2], [6, 0], [7, 2], [12, 2]]);
  assert.deepEqual(momentOf({ ...HEAD, rate: 0, points: [[0, 4]] }, 130), { time_s: 4, rate: 0 });
  assert.deepEqual(momentOf({ ...HEAD, points: [[0, 4], [1, 5], [1, 30]] }, 101), { time_s: 30, rate: 2 },
    "a gap of the recording is left out");
});

test("a small error is made up for a tenth faster or slower, a large one and one of a held picture at once", () => {
  assert.equal(approached(10, 10.5, 2, 0.1).toFixed(3), "10.220");
  assert.equal(approached(10, 10.1, 2, 0.1).toFixed(3), "10.180");
  assert.equal(approached(10, 10.2, 2, 0.1), 10.2);
  assert.equal(approached(10, 14, 2, 0.1), 14);
  assert.equal(approached(10, 9.9, 0, 0.1), 9.9);
  assert.equal(approached(NaN, 3, 2, 0.1), 3);
});

test("the next step is that of the lane that is followed, or of any", () => {
  const plan = /** @type {any} */ ({ step_ends_s: [[1, 3], [2, 4]] });
  assert.deepEqual([nextStep(plan, 1, 1, 1), nextStep(plan, NaN, 1, 1), nextStep(plan, 0, 3, 1)], [2, 2, null]);
  assert.deepEqual([nextStep(plan, 1, 4, -1), nextStep(plan, NaN, 1, -1)], [2, 0]);
});

test("a camera that follows nothing leaves the world where it is", () => {
  const [follower, state] = [new Follower(), scene()];
  const frame = { time_s: 0, messages: [], follow: { leader: [1, 2], 2: [3, 4] }, scene: null };
  const centred = (/** @type {string} */ view) => follower.centring(state, /** @type {any} */ (frame), view, Infinity);
  assert.deepEqual(centred("leader").position, [-1, -2, 0]);
  assert.deepEqual(centred("2").position, [-3, -4, 0]);
  assert.deepEqual(centred("free").position, [-3, -4, 0]);
  assert.deepEqual(centred("directed").position, [-1, -2, 0]);
});

test("the shot goes with the race: the start line until the first step is made, the race, its end", () => {
  const of = (/** @type {string} */ kind, /** @type {string} */ phase, /** @type {number[]} */ steps) =>
    ({ kind, phase, lanes: steps.map((step) => ({ step })) });
  const shots = (/** @type {ReturnType<typeof of> | null} */ figures, target = "directed") => shotOf(figures, target);
  assert.deepEqual(shots(null), { shot: "start", lane: null });
  assert.deepEqual(shots(of("idle", "start-line", [0, 0])), { shot: "start", lane: null });
  assert.deepEqual(shots(of("race", "race", [1, 1])), { shot: "start", lane: null });
  assert.deepEqual(shots(of("race", "waiting", [2, 1])), { shot: "race", lane: null });
  assert.deepEqual(shots(of("race", "photo-finish", [50, 36])), { shot: "finish", lane: null });
  assert.deepEqual(shots(of("race", "finished", [50, 50])), { shot: "finish", lane: null });
  assert.deepEqual(shots(of("training", "evaluation", [20])), { shot: "practice", lane: null });
});

test("a robot that is followed has a close shot, a free camera none", () => {
  const race = { kind: "race", phase: "race", lanes: [{ step: 3 }, { step: 2 }] };
  assert.deepEqual(shotOf(race, "2"), { shot: "close", lane: 1 });
  assert.deepEqual(shotOf(race, "3"), { shot: "race", lane: null });
  assert.deepEqual(shotOf(race, "free"), { shot: null, lane: null });
  assert.deepEqual(shotOf({ ...race, kind: "training", lanes: [{ step: 3 }] }, "1"), { shot: "practice", lane: null });
});

test("frames that are pushed as text are those that are fetched", async () => {
  const head = new TextEncoder().encode(JSON.stringify({ lengths: [], frames: [{ time_s: 2, messages: [] }] }));
  const bytes = new Uint8Array(4 + head.length);
  new DataView(bytes.buffer).setUint32(0, head.length, true);
  bytes.set(head, 4);
  const stream = new Blob([bytes]).stream().pipeThrough(new CompressionStream("gzip"));
  const packed = await new Response(stream).arrayBuffer();
  assert.deepEqual(await unpack(btoa(String.fromCharCode(...new Uint8Array(packed)))), decode(bytes.buffer));
});

test("arrays are read from behind the JSON, each with memory of its own", () => {
  const data = encoded({
    arrays: [0, 1, 1],
    frames: [frameOf(
      { type: "A", colors: { __binary_index: 0, dtype: "|u1" }, props: { at: { __binary_index: 1, dtype: "<f4" } } },
      { type: "B", props: { at: { __binary_index: 2, dtype: "<f4" } } },
    )],
  }, [], [new Uint8Array([1, 2, 3]), new Uint8Array(new Float32Array([0.5, -2]).buffer)]);
  const [{ messages: [message, twin] }] = decode(data).frames;

  assert.deepEqual(message.colors, new Uint8Array([1, 2, 3]));
  assert.deepEqual(message.props.at, new Float32Array([0.5, -2]));
  assert.deepEqual(twin.props.at, message.props.at);
  assert.equal(message.props.at.buffer.byteLength, 8);
  assert.notEqual(twin.props.at.buffer, message.props.at.buffer);
});

test("poses are the sums of differences, each array with memory of its own", () => {
  const step = 2 ** -13;
  const poses = {
    step,
    planes: 3,
    series: [[2, 3], [3, 1]],
    tracks: [
      { message: update("/a", {}), property: "batched_positions", series: 0 },
      { message: update("/b", {}), property: "batched_positions", series: 0 },
      { message: { type: "SetPositionMessage", name: "/c" }, property: "position", series: 1 },
    ],
  };
  // Zigzag codes of 100000, -1, 0 | -3, 300, 2^22 | -8, 8192, 0.
  const codes = [200000, 1, 0, 5, 600, 2 ** 23, 15, 16384, 0];
  const packed = [0, 8, 16].flatMap((shift) => codes.map((code) => (code >> shift) & 255));
  const other = { type: "RemoveSceneNodeMessage", name: "/d" };
  const frames = [frameOf(0, 1, 2), frameOf(other, 0, 1), frameOf(1, 0)];
  const data = encoded({ poses, arrays: [], frames }, packed, []);
  const [first, second, third] = decode(data).frames.map(({ messages }) => messages);
  const buffers = first.slice(0, 2).map(({ updates }) => updates.batched_positions.buffer);
  const move = (/** @type {string} */ name, /** @type {number[]} */ steps) =>
    update(name, { batched_positions: new Float32Array(steps.map((count) => count * step)) });

  assert.deepEqual(first, [
    move("/a", [100000, -3]), move("/b", [100000, -3]),
    { type: "SetPositionMessage", name: "/c", position: [-8 * step, 1, 0] },
  ]);
  assert.deepEqual(second, [other, move("/a", [99999, 297]), move("/b", [99999, 297])]);
  assert.deepEqual(third, [move("/b", [99999, 2 ** 22 + 297]), move("/a", [99999, 2 ** 22 + 297])]);
  assert.notEqual(buffers[0], buffers[1]);
});
