// Camera plans: all points are in the picture, as large as its margins allow, from the side that hides no robot.
import assert from "node:assert/strict";
import { readFileSync } from "node:fs";
import { test } from "node:test";
import { runInThisContext } from "node:vm";

// A script of the 3D view, which is no module.
runInThisContext(readFileSync(new URL("../../static/viewer/shots.js", import.meta.url), "utf-8"));
const { shots } = /** @type {any} */ (globalThis).hexapodsViewer;

const NO_MARGINS = { left: 0, top: 0, right: 0, bottom: 0 };
const SIZES = [[1280, 720], [1920, 1080], [390, 232], [390, 700], [320, 232]];
const SHOTS = ["start", "race", "finish", "practice", "close"];

/** A robot of a size at a place, as points around it. @type {(x: number, y: number, radius?: number) => number[][]} */
const robot = (x, y, radius = 0.28) => Array.from({ length: 8 }, (_, n) => (Math.PI * n) / 4).flatMap((angle) => [
  [x + radius * Math.cos(angle), y + radius * Math.sin(angle), 0],
  [x + 0.7 * radius * Math.cos(angle), y + 0.7 * radius * Math.sin(angle), 0.6 * radius],
]).concat([[x, y, 0.93 * radius]]);

/** @typedef {{ width: number, height: number }} Size */

/** Points in pixels of the picture of a camera that was solved. */
/** @type {(points: number[][], direction: any, size: Size, margins: typeof NO_MARGINS) => number[][]} */
function picture(points, direction, { width, height }, margins) {
  const tangents = shots.tangentsOf(direction.fov, { width, height }, margins);
  const { target, distance } = shots.solve(points, direction, tangents);
  const { left: wide, top: high } = shots.tangentsOf(direction.fov, { width, height }, NO_MARGINS);
  return shots.seenFrom(points, direction, target, distance).map((/** @type {number[]} */ [x, y]) =>
    [((1 + x / wide) * width) / 2, ((1 - y / high) * height) / 2]);
}

const RACE = [[-0.62, 0.36], [0, 0.47], [0.62, 0.11]];

test("from every angle of every shot all points are within the margins, and meet two that are opposite", () => {
  const places = RACE;
  for (const [width, height] of SIZES) {
    for (const shot of SHOTS) {
      for (let angle = 0; angle < shots.anglesOf(shot); angle += 1) {
        const points = places.flatMap(([x, y]) => robot(x, y));
        const direction = shots.directionOf(shot, angle, { width, height }, places);
        const margins = { left: 12, top: 40, right: 20, bottom: 30 };
        const seen = picture(points, direction, { width, height }, margins);
        const [xs, ys] = [0, 1].map((axis) => seen.map((point) => point[axis]));
        const free = [
          Math.min(...xs) - margins.left, width - margins.right - Math.max(...xs),
          Math.min(...ys) - margins.top, height - margins.bottom - Math.max(...ys),
        ];
        const about = `${shot} ${angle} at ${width} × ${height}: ${free}`;
        assert.ok(Math.min(...free) > -1e-6, about);
        const [across, down] = [Math.max(free[0], free[1]), Math.max(free[2], free[3])];
        assert.ok(Math.min(across, down) < 1e-6, about);
      }
    }
  }
});

test("robots of any size fill the same part of the picture", () => {
  const size = { width: 1280, height: 720 };
  const direction = shots.directionOf("race", 0, size, RACE);
  const widthOf = (/** @type {number} */ scale) => {
    const points = RACE.flatMap(([x, y]) => robot(scale * x, scale * y, 0.28 * scale));
    const xs = picture(points, direction, size, NO_MARGINS).map(([x]) => x);
    return Math.max(...xs) - Math.min(...xs);
  };
  assert.ok(Math.abs(widthOf(1) - widthOf(0.05)) < 1e-6);
  assert.ok(Math.abs(widthOf(1) - widthOf(20)) < 1e-6);
});

test("the camera is on the side of the robots that lag, of the front too, and on the right where all are level", () => {
  const size = { width: 1280, height: 720 };
  const azimuths = (/** @type {number[][]} */ places) =>
    [0, 1].map((angle) => Math.sign(shots.directionOf("race", angle, size, places).azimuth));
  assert.deepEqual(azimuths([[-0.6, 0.4], [0, 0.3], [0.6, 0]]), [1, -1]);
  assert.deepEqual(azimuths([[-0.6, 0], [0, 0.3], [0.6, 0.4]]), [-1, 1]);
  assert.deepEqual(azimuths([[-0.6, 0], [0, 0], [0.6, 0]]), [1, 1]);
});

test("a picture that is higher than wide has angles of its own, and many robots are seen from higher up", () => {
  const of = (/** @type {number[]} */ [width, height], count = 3) =>
    shots.directionOf("race", 0, { width, height }, Array.from({ length: count }, (_, n) => [n, 0]));
  assert.deepEqual(of([1280, 720]), { azimuth: 34, elevation: 18, fov: 30 });
  assert.deepEqual(of([800, 600]), { azimuth: 45, elevation: 18, fov: 30 });
  assert.deepEqual(of([390, 700]), { azimuth: 77, elevation: 34, fov: 30 });
  assert.deepEqual(of([1280, 720], 8), { azimuth: 40, elevation: 22, fov: 30 });
});

test("the distance for a target is that of the solution, and more for a target beside it", () => {
  const size = { width: 1280, height: 720 };
  const points = RACE.flatMap(([x, y]) => robot(x, y));
  const direction = shots.directionOf("race", 0, size, RACE);
  const tangents = shots.tangentsOf(direction.fov, size, NO_MARGINS);
  const { target, distance } = shots.solve(points, direction, tangents);
  assert.ok(Math.abs(shots.distanceFor(points, direction, tangents, target) - distance) < 1e-9);
  assert.ok(shots.distanceFor(points, direction, tangents, [target[0] + 0.1, target[1], target[2]]) > distance);
});

test("a camera's place and its direction are each told from the other", () => {
  const direction = { azimuth: -35, elevation: 22, fov: 30 };
  const { azimuth, elevation } = shots.directionFrom(shots.positionOf([1, 2, 0.1], 3, direction), [1, 2, 0.1]);
  assert.ok(Math.abs(azimuth + 35) < 1e-9 && Math.abs(elevation - 22) < 1e-9);
});

test("where margins leave nothing, a part of the picture is still for the robots", () => {
  const size = { width: 320, height: 100 };
  const margins = { left: 0, top: 90, right: 0, bottom: 60 };
  const tangents = shots.tangentsOf(30, size, margins);
  assert.ok(tangents.top + tangents.bottom > 0.1 * Math.tan(Math.PI / 12));
});
