// The legs of the robots in the picture: where they are, which one was picked, and the menu that opens there. The 3D
// view projects the poses that it draws (viewer/legs.js), and tells of them in pixels of the picture.
import { computed, signal } from "@preact/signals";
import { page } from "./page-state.js";
import { scene } from "./store.js";

/** @import { Signal } from "@preact/signals" */

/** A point of the picture [px]. @typedef {{ x: number, y: number }} Point */
/** What was picked: a leg, from 1, the body, or the ground; of a lane, from 0. */
/** @typedef {Point & { lane: number, what: "leg" | "body" | "ground", leg: number | null }} Pick */

/** What was picked last, while its menu is open. @type {Signal<Pick | null>} */
export const picked = signal(null);
/** Whether the legs of the followed robot are numbered, to choose from. */
export const legsAreOpen = computed(() => legsOf.value !== null || picked.value !== null);
/** The lane whose legs are numbered; null where none are. @type {Signal<number | null>} */
export const legsOf = signal(null);
/** Where the legs of that lane are. @type {Signal<(Point & { leg: number })[]>} */
export const legPoints = signal([]);

/** The lane that the camera follows: of the leader where it follows that. */
const followedLane = () => {
  const lanes = scene.peek()?.lanes ?? [];
  const lane = Number(page.camera.peek()) - 1;
  return lanes[lane] ? lane : lanes.find(({ rank }) => rank === 1)?.lane ?? 0;
};

/** Number the legs of the robot that is followed. */
export const openLegs = () => {
  if (!scene.peek()?.lanes.length) return;
  picked.value = null;
  legsOf.value = followedLane();
};

export const closeLegs = () => {
  legsOf.value = null;
  picked.value = null;
  legPoints.value = [];
};

/** Open the menu of a leg that is numbered. @param {number} leg */
export function pickLeg(leg) {
  const point = legPoints.peek().find((candidate) => candidate.leg === leg);
  const lane = legsOf.peek();
  if (point && lane !== null) picked.value = { ...point, lane, what: "leg" };
}
