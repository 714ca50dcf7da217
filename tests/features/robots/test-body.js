// A body as it is edited: the picture's frame, mirror images, legs that come and go, and the robot that it makes.
import assert from "node:assert/strict";
import { test } from "node:test";
import {
  addLeg, changeAll, changeLeg, changeTorso, drawnLeg, extentOf, isBox, makeBox, mirrorOf, openBody, partsOf, removeLeg,
  robotOf, sharedPart,
} from "../../../static/features/robots/body.js";

/** @type {any} */
const SHARED = {
  coxa_m: 0.05, femur_m: 0.08, tibia_m: 0.13, torso_radius_m: 0.1, torso_length_m: null, torso_width_m: null,
};
/** @type {(angle: number, own?: object) => any} */
const legAt = (angle, fields = {}) => ({
  built: {
    x_m: 0.1 * Math.cos((angle * Math.PI) / 180), y_m: 0.1 * Math.sin((angle * Math.PI) / 180), z_m: 0, yaw_deg: angle,
    foot_out_m: 0.15, coxa_m: 0.05, femur_m: 0.08, tibia_m: 0.13, ...fields,
  },
});
/** @type {(angles: number[], groups: number[][], forward?: number) => any} */
const preview = (angles, groups, forward_deg = 90) => ({
  built: SHARED, legs: angles.map((angle) => legAt(angle)), forward_deg, gait: { right_leg: 1, left_leg: 2, groups },
});
const FOUR = preview([45, 135, 225, 315], [[1, 3], [2, 4]]);
const RING = preview([0, 60, 120, 180, 240, 300], [[1, 4], [2, 5], [3, 6]], 30);

test("a body that was opened makes the robot that was chosen, written out", () => {
  const body = openBody("dog", "trot", FOUR);
  const robot = /** @type {any} */ (robotOf(body));
  assert.equal(robot.preset, "dog");
  assert.deepEqual(robot.legs[0], { x_m: 0.070711, y_m: 0.070711, yaw_deg: 45, foot_out_m: 0.15 });
});

test("what was given of a leg stays as it was written, until that leg is changed", () => {
  const legs = [45, 135, 225, 315].map((azimuth_deg) => ({ azimuth_deg, radius_m: 0.1 }));
  const body = openBody({ preset: "stiff", legs, femur_m: 0.1 }, "trot", FOUR);
  const robot = /** @type {any} */ (robotOf(changeLeg(body, 2, { tibia_m: 0.2 }, null)));
  assert.deepEqual([robot.legs[0], robot.legs[3], robot.femur_m], [legs[0], legs[3], 0.1]);
  assert.deepEqual(robot.legs[1], { x_m: -0.070711, y_m: 0.070711, yaw_deg: 135, foot_out_m: 0.15, tibia_m: 0.2 });
});

test("in the picture the gait's forward direction is up", () => {
  const body = openBody("stiff", "left-right-origin", RING);
  const { x_m, y_m, yaw_deg, femur_m } = partsOf(body, 1);
  assert.deepEqual([x_m, y_m, yaw_deg, femur_m], [0.05, 0.086603, 60, 0.08]);
  const moved = changeLeg(body, 1, { x_m: 0.06 }, null);
  assert.deepEqual([partsOf(moved, 1).x_m, partsOf(moved, 1).y_m, partsOf(moved, 1).yaw_deg], [0.06, 0.086603, 60]);
  assert.deepEqual(partsOf(moved, 2), partsOf(body, 2));
});

test("a leg's mirror image moves and turns with it, and takes its lengths", () => {
  const body = openBody("dog", "trot", FOUR);
  assert.equal(mirrorOf(body, 1), 2);
  const moved = changeLeg(body, 1, { x_m: 0.05, yaw_deg: 20, femur_m: 0.1 }, 2);
  const image = partsOf(moved, 2);
  assert.deepEqual([image.x_m, image.y_m, image.yaw_deg, image.femur_m], [-0.05, 0.070711, 160, 0.1]);
  assert.deepEqual(partsOf(moved, 3), partsOf(body, 3));
});

test("a leg on the axis is its own image and stays there; one without an image has none", () => {
  const body = openBody("stiff", "one-by-one", preview([90, 210, 330, 20], [[1], [2], [3], [4]]));
  assert.deepEqual([1, 2, 4].map((leg) => mirrorOf(body, leg)), [1, 3, null]);
  const moved = changeLeg(body, 1, { x_m: 0.05, y_m: 0.12 }, 1);
  assert.deepEqual([partsOf(moved, 1).x_m, partsOf(moved, 1).y_m], [0, 0.12]);
  assert.equal(changeLeg(body, 1, { x_m: 0.05 }, 1), body);
});

test("all legs at once take a robot's number, and lose their own", () => {
  const body = changeLeg(openBody("dog", "trot", FOUR), 1, { femur_m: 0.2 }, null);
  const robot = /** @type {any} */ (robotOf(changeAll(body, "femur_m", 0.11)));
  assert.equal(robot.femur_m, 0.11);
  assert.ok(robot.legs.every((/** @type {object} */ leg) => !("femur_m" in leg)));
  const out = changeAll(body, "foot_out_m", 0.12);
  assert.deepEqual(out.legs.map(({ parts }) => parts.foot_out_m), [0.12, 0.12, 0.12, 0.12]);
});

test("a round torso becomes a box as long and as wide", () => {
  const body = openBody("stiff", "trot", FOUR);
  assert.equal(isBox(body), false);
  const box = makeBox(body);
  assert.deepEqual([isBox(box), sharedPart(box, "torso_length_m")], [true, 0.2]);
  assert.equal(sharedPart(changeTorso(box, { torso_length_m: 0.3 }), "torso_length_m"), 0.3);
});

test("a leg is drawn from its mount to its foot, and the picture has room for all", () => {
  const body = openBody("dog", "trot", FOUR);
  const { mount, coxa, foot } = drawnLeg(body, 1);
  assert.deepEqual([mount, coxa, foot].map(([x]) => Number(x.toFixed(3))), [0.071, 0.106, 0.177]);
  assert.ok(extentOf(body) > 0.177);
});

test("a pair is added at the sides of a long body; legs are numbered from the front right one", () => {
  const long = preview([61, 119, 241, 299], [[1, 3], [2, 4]]);
  const { body, leg } = addLeg(openBody("dog", "trot", long), true, 12);
  assert.equal(body.legs.length, 6);
  assert.equal(leg, 6);
  assert.deepEqual([partsOf(body, 6).y_m, partsOf(body, 3).y_m], [0, 0]);
  assert.ok(partsOf(body, 6).x_m > 0 && partsOf(body, 3).x_m < 0);
  assert.deepEqual([body.gait, body.own.groups], ["trot", [[1, 4], [2, 5], [3, 6]]]);
});

test("a single leg goes into the widest gap; in front it moves forward to its neighbours", () => {
  const wide = preview([20, 160, 200, 340], [[1, 3], [2, 4]]);
  const { body, leg } = addLeg(openBody("dog", "trot", wide), false, 12);
  assert.equal(leg, 2);
  assert.deepEqual(body.gait, { right_leg: 1, left_leg: 3, groups: [[1, 4], [3, 5], [2]] });
});

test("where there is room for one leg only, none is added with an image", () => {
  const { body } = addLeg(openBody("dog", "trot", FOUR), true, 5);
  assert.equal(body.legs.length, 5);
});

test("a leg that is removed leaves its group, and takes its image along", () => {
  const body = openBody("stiff", "left-right-origin", RING);
  const five = removeLeg(body, 4, null);
  assert.deepEqual([five.legs.length, five.gait, five.own.groups],
    [5, "left-right-origin", [[1], [2, 4], [3, 5]]]);
  const four = removeLeg(body, 1, 2);
  const groups = [[3], [4], [2, 1]].map((group) => group.toSorted());
  assert.deepEqual(four.own, { right_leg: 1, left_leg: 2, groups });
  assert.ok(partsOf(four, 1).x_m > 0);
});
