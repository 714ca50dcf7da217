// The directed camera: the first shot is cut to, and the next ones are flown to, unless other robots are shown.
import assert from "node:assert/strict";
import { readFileSync } from "node:fs";
import { test } from "node:test";
import { runInThisContext } from "node:vm";
import "./browser.js";

/** A vector of three.js as far as the camera needs it; the run's frame is that of the scene here. */
class Vector {
  constructor(x = 0, y = 0, z = 0) {
    this.set(x, y, z);
  }

  set(/** @type {number} */ x, /** @type {number} */ y, /** @type {number} */ z) {
    Object.assign(this, { x, y, z });
    return this;
  }

  clone() {
    return new Vector(...this.toArray());
  }

  copy(/** @type {Vector} */ other) {
    return this.set(...other.toArray());
  }

  applyMatrix4() {
    return this;
  }

  distanceTo(/** @type {Vector} */ other) {
    return Math.hypot(...this.toArray().map((part, axis) => part - other.toArray()[axis]));
  }

  /** @returns {[number, number, number]} */
  toArray() {
    const { x, y, z } = /** @type {any} */ (this);
    return [x, y, z];
  }
}

const IDENTITY = { clone: () => IDENTITY, invert: () => IDENTITY };

/** The script, with a robot to show: `show` sends a shot, `pass` lets time pass and returns where the camera is. */
function directed() {
  /** @type {Record<string, ((event: object) => void)[]>} */
  const listeners = {};
  /** @type {((now: number) => void)[]} */
  let due = [];
  let root = "/world/run";
  let now = 0;
  const target = new Vector();
  const camera = {
    position: new Vector(2, -3, 1), fov: 30, isPerspectiveCamera: true, lookAt: () => {},
    updateProjectionMatrix: () => {}, updateMatrixWorld: () => {},
  };
  const viewer = {
    camera, canvas: { clientWidth: 1280, clientHeight: 720 }, scene: { onBeforeRender: () => {} },
    nodeRefFromName: { "/world/run": { matrixWorld: IDENTITY }, "/world/next": { matrixWorld: IDENTITY } },
    cameraControl: {
      getTarget: () => target.clone(),
      setLookAt: (/** @type {number[]} */ ...[, , , x, y, z]) => target.set(x, y, z),
    },
  };
  const robot = { lane: 0, at: [0, 0, 0.1] };
  const robots = {
    root: () => root, robots: () => [robot], ghostPoints: () => [],
    pointsOf: () => [[-0.2, -0.2, 0], [0.2, 0.2, 0], [0.2, -0.2, 0.2], [-0.2, 0.2, 0.2]],
  };
  const { shots } = /** @type {any} */ (globalThis).hexapodsViewer;
  const window = { __viserMutable: viewer, hexapodsViewer: { robots, shots, labels: { height: () => 20 } } };
  const source = readFileSync(new URL("../../static/viewer/camera.js", import.meta.url), "utf-8");
  runInThisContext(`(function (window, addEventListener, requestAnimationFrame) {${source}\n})`)(
    window, (/** @type {string} */ type, /** @type {any} */ listener) => (listeners[type] ??= []).push(listener),
    (/** @type {(now: number) => void} */ step) => due.push(step),
  );
  return {
    show: (/** @type {string} */ shot, /** @type {string} */ next = root) => {
      root = next;
      listeners["hexapods:show"].forEach((listener) => listener({ detail: { shot } }));
    },
    pass: (seconds = 1 / 60) => {
      for (const end = now + 1000 * seconds; now < end - 1e-6;) {
        now += 1000 / 60;
        const steps = due;
        due = [];
        steps.forEach((step) => step(now));
      }
      viewer.scene.onBeforeRender();
      return camera.position.clone();
    },
  };
}

const FLIGHT_S = 4;
/** Between two pictures nothing flies as far [m]. */
const CUT_M = 0.3;

runInThisContext(readFileSync(new URL("../../static/viewer/shots.js", import.meta.url), "utf-8"));

test("the first shot is there at once, and already the next one is flown to", () => {
  const { show, pass } = directed();
  show("start");
  const first = pass();
  assert.ok(first.distanceTo(pass(FLIGHT_S)) < CUT_M);
  for (const shot of ["race", "start"]) {
    const before = pass();
    show(shot);
    assert.ok(before.distanceTo(pass()) < CUT_M, shot);
    assert.ok(before.distanceTo(pass(FLIGHT_S)) > CUT_M, shot);
  }
});

test("other robots are cut to, and so is the photo finish of a race", () => {
  const { show, pass } = directed();
  show("start");
  const start = pass(FLIGHT_S);
  show("race", "/world/next");
  const race = pass();
  assert.ok(start.distanceTo(race) > CUT_M);
  assert.ok(race.distanceTo(pass(FLIGHT_S)) < CUT_M);
  show("finish");
  const finish = pass();
  assert.ok(finish.distanceTo(pass(FLIGHT_S)) < CUT_M);
});
