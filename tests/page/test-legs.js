// The legs in the picture: whose are numbered, and which one is picked.
import assert from "node:assert/strict";
import { beforeEach, test } from "node:test";
import { closeLegs, legPoints, legsAreOpen, legsOf, openLegs, picked, pickLeg } from "../../static/js/page.js";
import { page } from "../../static/js/page-state.js";
import { applyEvent } from "../../static/js/store.js";
import { makeSceneLane, makeStage } from "./options.js";

/** @param {object[]} lanes */
const show = (lanes) => applyEvent("snapshot", { runs: [], stage: makeStage(), scene: { kind: "race", lanes } });

beforeEach(() => {
  closeLegs();
  page.camera.value = "directed";
  show([makeSceneLane({ rank: 2 }), makeSceneLane({ lane: 1, rank: 1 })]);
});

test("the legs of the robot that the camera follows are numbered: of the leader, or of a lane", () => {
  openLegs();
  assert.deepEqual([legsOf.value, legsAreOpen.value], [1, true]);
  page.camera.value = "1";
  openLegs();
  assert.equal(legsOf.value, 0);
  page.camera.value = "free";
  openLegs();
  assert.equal(legsOf.value, 1);
});

test("without robots there are none", () => {
  show([]);
  openLegs();
  assert.equal(legsAreOpen.value, false);
});

test("a leg is picked where it is in the picture, once that is known", () => {
  openLegs();
  pickLeg(3);
  assert.equal(picked.value, null);
  legPoints.value = [{ leg: 3, x: 40, y: 60 }];
  pickLeg(3);
  assert.deepEqual(picked.value, { leg: 3, x: 40, y: 60, lane: 1, what: "leg" });
  openLegs();
  assert.equal(picked.value, null, "another is chosen");
  closeLegs();
  assert.deepEqual([legsOf.value, legPoints.value], [null, []]);
});
