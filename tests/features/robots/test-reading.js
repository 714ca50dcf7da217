// A robot that is read from a file: decisions by clicks, what is said of it, and where that stands in the picture.
import assert from "node:assert/strict";
import { test } from "node:test";
import { anglesIn } from "../../../static/features/robots/components/further-choices.js";
import {
  angleOf, asDecision, chosenFeet, clickedPart, decided, directionInWords, directionOf, footOf, offerInWords,
  wantedGroups, withFoot, withForward, withLegInNextGroup, wrongNumber,
} from "../../../static/features/robots/reading-choices.js";
import { lengthInWords } from "../../../static/features/robots/quantities.js";
import { readingInWords, robotInWords } from "../../../static/features/robots/reading-words.js";
import {
  arrowPoints, arrowTips, extentOf, nearestAngle, numberPoint, viewOf,
} from "../../../static/features/robots/sketch-geometry.js";
import { boxOf, columnsOf, lineEnd, TAG, tagsOf } from "../../../static/features/robots/tags.js";

const LEGS = [1, 2, 3, 4].map((leg) =>
  ({ leg, azimuth_deg: 90 * leg - 45, joints: [`hip${leg}`, `knee${leg}`], foot: `foot${leg}` }));
/** @type {import("../../../static/features/robots/reading.js").FoundRobot} */
const ROBOT = {
  name: "rex", gait: "trot", groups: [[1, 3], [2, 4]], legs: LEGS, mass_kg: 2.345, body_height_m: 0.0844,
  body_heights_m: [0.05, 0.12], forward_deg: 180, keyframes: [], reaches_grid: true,
};
const PARTS = [
  { name: "torso", leg: 0, foot: null, at_m: [0, 0, 0.1], low_m: [0, 0, 0.08] },
  { name: "thigh1", leg: 1, foot: null, at_m: [0.1, 0.1, 0.08], low_m: [0.1, 0.1, 0.05] },
  { name: "shank1", leg: 1, foot: "foot1", at_m: [0.15, 0.1, 0.04], low_m: [0.2, 0.1, 0] },
];
const FEET = [{ name: "foot1", leg: 1, at_m: [0.2, 0.1, 0.01], radius_m: 0.01 }];
/** @type {import("../../../static/features/robots/reading.js").Reading} */
const READING = {
  id: "a", file: "rex.urdf", document: null, documents: [], choices: {}, problem: null, robot: ROBOT,
  feet: FEET, arguments: {}, parts: PARTS, scene: "",
  notes: [
    { kind: "repair", topic: "meshes", text: "A mesh was left out.", parts: ["torso"], offer: null },
    { kind: "guess", topic: "forward", text: "It walks along −x.", parts: [], offer: { forward: "x" } },
    { kind: "guess", topic: "servos", text: "Torque.", parts: ["knee1"], offer: null },
    { kind: "guess", topic: "legs", text: "Feet.", parts: ["gone", "foot1"], offer: null },
  ],
};

test("forward is an axis of the torso where it is one, else an angle; groups by numbers are guessed anew", () => {
  assert.deepEqual([0, 90, 180, -180, 270, 450, 30].map(directionOf), ["x", "y", "-x", "-x", "-y", "y", 30]);
  assert.deepEqual(["x", "-y", 30, "45"].map(angleOf), [0, -90, 30, 45]);
  assert.deepEqual([180, -75].map(directionInWords), ["−x", "−75° from x"]);
  assert.deepEqual(withForward(-90), { forward: "-y", gait: null });
});

test("a foot is chosen and chosen no more, from those that were found on", () => {
  assert.deepEqual(chosenFeet({}, ROBOT), ["foot1", "foot2", "foot3", "foot4"]);
  assert.deepEqual([chosenFeet({ feet: ["a"] }, ROBOT), chosenFeet({}, null)], [["a"], []]);
  assert.deepEqual(withFoot(["a", "b"], "a"), { feet: ["b"], gait: null });
  assert.deepEqual(withFoot(["a"], "c"), { feet: ["a", "c"], gait: null });
  assert.deepEqual([undefined, null, ["a", "b", "c"]].map((feet) => wrongNumber(feet)), ["", "", ""]);
  assert.equal(wrongNumber([]), "Choose at least 3 feet; none so far.");
  assert.equal(wrongNumber(Array.from({ length: 13 }, String)), "Choose at most 12 feet; 13 so far.");
});

test("a leg goes to the next group, and after the last one begins its own", () => {
  assert.deepEqual(withLegInNextGroup("trot", ROBOT.groups, 1),
    { gait: { right_leg: 1, left_leg: 2, groups: [[3], [1, 2, 4]] } });
  const parts = { right_leg: 3, left_leg: 4, groups: [[3], [1, 2, 4]] };
  assert.deepEqual(withLegInNextGroup(parts, parts.groups, 2).gait, { ...parts, groups: [[3], [1, 4], [2]] });
  assert.deepEqual(withLegInNextGroup(parts, [[3], [1, 4], [2]], 2).gait, { ...parts, groups: [[2, 3], [1, 4]] });
  assert.deepEqual(
    [wantedGroups({ gait: parts }, ROBOT), wantedGroups({ gait: "trot" }, ROBOT), wantedGroups({}, null)],
    [parts.groups, ROBOT.groups, []]);
});

test("a click on a node of the scene is one on its part, or on its foot", () => {
  assert.equal(clickedPart("/world/sketch/part/2", PARTS, [])?.leg, 1);
  assert.deepEqual(clickedPart("/world/sketch/foot/0", PARTS, FEET), { foot: "foot1", leg: 1 });
  const shank = { ...PARTS[2], foot: "shank1" };
  assert.deepEqual([footOf(shank, FEET), footOf(shank, []), footOf(PARTS[0], FEET)], ["foot1", "shank1", null]);
  assert.deepEqual(["/world/ground", "/world/sketch/part/9", "/world/sketch/foot/3"].map((node) =>
    clickedPart(node, PARTS, [])), [null, null, null]);
});

test("only what is decided is sent", () => {
  const choices = { forward: null, file: "", arguments: {}, scale: 0.001, feet: ["a"] };
  assert.deepEqual(decided(choices), { scale: 0.001, feet: ["a"] });
});

test("an offer says what it does", () => {
  assert.equal(offerInWords({ scale: 0.001 }), "Read it at 1:1,000");
  assert.equal(offerInWords({ scale: 10, up: "y" }), "Read it at 10:1, read it with y up");
  assert.equal(offerInWords({ gait: { groups: [[1, 4], [2, 3]] } }), "Group legs 1+4, 2+3");
  assert.equal(offerInWords({ gait: "trot" }), "Take these groups");
  assert.equal(offerInWords({ mass_kg: 0.5 }), "Weigh 500\u00a0g");
  assert.equal(offerInWords({ forward: "-x" }), "Walk along −x");
  assert.equal(offerInWords({ feet: ["a", "b", "c", "d"], gait: null }), "Take 4 feet: a, b and c…");
  assert.equal(offerInWords({ file: "urdf/b.urdf" }), "Read b.urdf instead");
  assert.equal(offerInWords({ body_height_m: 0.12, angle_unit: "deg" }), "Stand 120 mm high, read angles as degrees");
});

test("an offer that is taken is decided, and what depended on what it changes is guessed anew", () => {
  assert.deepEqual(asDecision({ scale: 0.001, feet: null }), { scale: 0.001 });
  assert.deepEqual(asDecision({ forward: "-x" }), { forward: "-x", gait: null });
  const { file, ...rest } = asDecision({ file: "b.xml" });
  assert.deepEqual([file, new Set(Object.values(rest))], ["b.xml", new Set([null])]);
});

test("angles are assignments, and others are told", () => {
  assert.deepEqual(anglesIn(" hip=0.3; knee=−1 "), { hip: 0.3, knee: -1 });
  for (const text of ["hip", "hip=", "=1", "a=1=2", "a=b"]) assert.throws(() => anglesIn(text), /joint=radians, not/);
});

test("a robot is told in a line, and a new reading in a sentence", () => {
  assert.equal(robotInWords(ROBOT), "4 legs · 2.35\u00a0kg · stands 84\u00a0mm high");
  assert.deepEqual([0.31, 3.14, 0.0021].map(lengthInWords), ["0.31\u00a0m", "3.1\u00a0m", "2.1\u00a0mm"]);
  assert.match(robotInWords({ ...ROBOT, mass_kg: 0.000095 }), /95\u00a0mg/);
  assert.equal(readingInWords(READING),
    "rex: 4 legs, forward along −x, groups 1+3, 2+4, stands 84\u00a0mm high, 3 guesses to confirm");
  assert.equal(readingInWords({ ...READING, robot: null, problem: "it has no legs" }),
    "This cannot be a robot yet: it has no legs");
});

// ---- places

const EXTENT = { radius_m: 0.5, height_m: 0.2, rims_m: /** @type {[number, number][]} */ ([]) };

test("the extent of a scene is that of its parts, and changes little with small changes", () => {
  const mesh = (/** @type {string} */ name, /** @type {number[]} */ vertices) =>
    ({ type: "MeshMessage", name, props: { vertices: new Float32Array(vertices) } });
  const messages = [mesh("/world/sketch/part/0", [0.3, 0.4, 0.1, 0, 0, 0.196]), mesh("/world/sketch/table", [9, 9, 9])];
  const frames = [{ time_s: 0, messages, follow: {}, scene: null }];
  const { rims_m, ...extent } = extentOf({ frames });
  assert.deepEqual(extent, { radius_m: 0.5, height_m: 0.2 });
  assert.deepEqual(rims_m.map(([radius]) => radius > 0.1), [false, false, false, true, false, false]);
  assert.equal(extentOf({ frames: [] }).radius_m, 0.01);
  assert.deepEqual(viewOf(EXTENT), { centre_m: [0, 0, 0.1], rims_m: [[0.68, 0]] });
});

test("the arrow lies on the ground in its direction, and is dragged to the nearest of 24", () => {
  const [tip] = arrowPoints(EXTENT, 0);
  assert.ok(Math.abs(tip[0]) < 1e-9 && tip[1] > 0.6 && tip[2] === 0);
  const [left] = arrowPoints(EXTENT, 90);
  assert.ok(left[0] < -0.6 && Math.abs(left[1]) < 1e-9);
  const tips = arrowTips(EXTENT);
  assert.deepEqual([tips.length, tips[6].angle_deg, tips[18].angle_deg], [24, 90, -90]);
  const places = tips.map(({ angle_deg, point: [x, y] }) => ({ angle_deg, place: { x: 100 * x, y: -100 * y } }));
  assert.equal(nearestAngle({ x: -70, y: 4 }, places), 90);
  assert.equal(nearestAngle({ x: 0, y: 0 }, [{ angle_deg: 0, place: null }]), null);
  assert.deepEqual(numberPoint([0.3, 0.4, 0], EXTENT).map((value) => Number(value.toFixed(3))), [0.33, 0.44, 0]);
});

test("guesses are tags at what they are about: bodies, joints, feet, or their topic's place", () => {
  const tags = tagsOf(READING, EXTENT);
  assert.deepEqual(tags.map(({ index, title, at_m }) => [index, title, at_m]), [
    [1, "Forward", [0, 0.5, 0]], [2, "Servos", [0.15, 0.1, 0.04]], [3, "Feet", [0.2, 0.1, 0.01]],
  ]);
});

test("tags stand beside the robot, on the side of what they are about, and never on each other", () => {
  const size = { width: 900, height: 400 };
  const places = [[200, 100], [700, 300], [300, 50], [650, 90], [250, 200], [220, 350], null]
    .map((place) => place && { x: place[0], y: place[1] });
  const columns = columnsOf(places, size);
  assert.deepEqual(columns[2], { side: "left", row: 0 });
  assert.equal(columns[1]?.side, "right");
  const boxes = columns.flatMap((column) => (column ? [boxOf(column, size)] : []));
  assert.equal(boxes.length, places.length);
  for (const [n, { left, top }] of boxes.entries()) {
    assert.ok(left >= 0 && left + TAG.width <= size.width && top + TAG.height <= size.height - TAG.bottom);
    assert.ok(left + TAG.width < 300 || left > 600, "the middle is the robot's");
    assert.ok(boxes.every((other, m) => m === n || other.left !== left || Math.abs(other.top - top) >= TAG.height));
  }
  assert.equal(lineEnd({ side: "left", row: 0 }, size).x, TAG.edge + TAG.width);
  const low = columnsOf(places, { width: 900, height: 150 });
  assert.deepEqual(low.filter((column) => column !== null).length, 2, "those without room are in the list alone");
});
