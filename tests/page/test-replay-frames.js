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

test("arrays are read from behind the JSON, each with memory of its own", () => {
  const head = JSON.stringify({
    lengths: [3, 8],
    frames: [{ time_s: 1, follow: {}, scene: null, messages: [
      { type: "A", colors: { __binary_index: 0, dtype: "|u1" }, props: { at: { __binary_index: 1, dtype: "<f4" } } },
    ] }],
  });
  const bytes = new Uint8Array(400);
  new DataView(bytes.buffer).setUint32(0, head.length, true);
  bytes.set(new TextEncoder().encode(head), 4);
  const first = Math.ceil((4 + head.length) / 8) * 8;
  bytes.set([1, 2, 3], first);
  bytes.set(new Uint8Array(new Float32Array([0.5, -2]).buffer), first + 8);
  const [{ messages: [message] }] = decode(bytes.buffer).frames;

  assert.deepEqual(message.colors, new Uint8Array([1, 2, 3]));
  assert.deepEqual(message.props.at, new Float32Array([0.5, -2]));
  assert.equal(message.props.at.buffer.byteLength, 8);
});
