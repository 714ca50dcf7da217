// Robots as forms, links and runs have them.
import assert from "node:assert/strict";
import { test } from "node:test";
import { OPTIONS } from "./options.js";
import {
  builtPart, customRobotInWords, formRobot, linkedText, numberOfLegs, offered, presetOf, unlinked,
} from "../../static/js/robots.js";

const ID = "0123456789abcdef";
const [STIFF, DOG] = OPTIONS.robots;
const REX = {
  ...DOG, name: ID, title: "Rex", id: ID, robot: { id: ID, name: "Rex" },
  body: /** @type {const} */ ({ preset: "stiff", femur_m: 0.09 }),
};
const ROBOTS = [STIFF, DOG, REX];

test("a stored robot is known by its id, with all that is known of it", () => {
  assert.equal(formRobot({ id: ID, name: "Rex" }), ID);
  assert.equal(presetOf({ id: ID, name: "Rex" }), ID);
  assert.equal(numberOfLegs(ID, ROBOTS), 4);
  assert.equal(numberOfLegs({ id: ID, name: "Rex", friction: 0.5 }, ROBOTS), 4);
  assert.equal(builtPart(ID, "friction", ROBOTS), 1);
  assert.equal(customRobotInWords({ id: ID, name: "Rex" }), null);
  assert.equal(customRobotInWords({ id: ID, name: "Rex", friction: 0.5 }), "custom: Rex, friction 0.5");
});

test("a link has a stored body by value, too, and takes that where it is not stored", () => {
  const text = linkedText(ID, ROBOTS);
  assert.deepEqual(JSON.parse(text ?? ""), { id: ID, name: "Rex", body: REX.body });
  assert.equal(unlinked(JSON.parse(text ?? ""), ROBOTS), ID);
  assert.deepEqual(unlinked(JSON.parse(text ?? ""), [STIFF, DOG]), REX.body);
  assert.equal(linkedText("stiff", ROBOTS), null);
  assert.equal(linkedText(ID, [STIFF, { ...REX, body: null }]), null);
  assert.equal(unlinked("stiff", ROBOTS), "stiff");
});

test("hidden robots are offered only where they are chosen", () => {
  const robots = [STIFF, { ...REX, hidden: true }];
  assert.deepEqual(offered(robots, ["stiff"]).map(({ title }) => title), ["Stiff"]);
  assert.deepEqual(offered(robots, [ID]).map(({ title }) => title), ["Stiff", "Rex"]);
});
