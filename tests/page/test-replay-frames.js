// Frames of a replay: whatever was shown before, after a jump the 3D view shows that moment.
import assert from "node:assert/strict";
import { test } from "node:test";
import { decode, SceneState } from "../../static/js/replay-frames.js";

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
