// How the robot that is read is seen: what a click on it does, whether it turns, and where what stands over the picture
// is.
import { computed, effect, signal, untracked } from "@preact/signals";
import { clickedNode, inspection, isPhone, places, turnedByHand } from "../../js/page.js";
import {
  angleOf, chosenFeet, clickedPart, footOf, inTurn, wantedGroups, withFoot, withForward, withLegInNextGroup,
  wrongNumber,
} from "./reading-choices.js";
import { choices, decide, extent, reading, readingAnnounced, refusal } from "./reading.js";
import { arrowPoints, arrowTips, numberPoint, viewOf } from "./sketch-geometry.js";
import { LEAST_WIDTH, marginsFor, tagsOf } from "./tags.js";

/** @import { Signal } from "@preact/signals" */
/** @import { Tag } from "./tags.js" */

const KEY_TURN_DEG = 15;

/** What a click on a leg changes. @type {Signal<"groups" | "feet">} */
export const clickMode = signal("groups");
/** Whether the turntable turns by itself. */
export const isTurning = signal(false);
/** Whether a pointer or the focus is in the picture: what moves is hard to meet. */
export const isMet = signal(false);
/** The size of the picture [px]. */
export const pictureSize = signal({ width: 0, height: 0 });
/** The guess that is shown in the list. @type {Signal<number | null>} */
export const shownNote = signal(null);
/** While the arrow is dragged, its angle from the forward that was read [°]. @type {Signal<number | null>} */
export const draggedAngle = signal(null);
/** By how much the page has turned the picture [°]. */
const turned_deg = signal(0);

// ---- what is shown

/** The forward direction that was read [°], from x of the torso; x where none is known. */
const readForward = computed(() => reading.value?.robot?.forward_deg ?? 0);
/** The forward direction that is wanted [°]. */
export const wantedForward = computed(() => {
  if (draggedAngle.value !== null) return inTurn(readForward.value + draggedAngle.value);
  const { forward } = choices.value;
  return forward === null || forward === undefined ? readForward.value : angleOf(forward);
});

/** The feet that are chosen, by name. */
export const feetChosen = computed(() => chosenFeet(choices.value, reading.value?.robot ?? null));

/** The groups that are wanted. */
export const groups = computed(() => wantedGroups(choices.value, reading.value?.robot ?? null));

/** The number of a leg's group, from 0. @param {number} leg */
export const groupOf = (leg) => groups.value.findIndex((legs) => legs.includes(leg));

/** What can be a foot, each once: feet first. */
export const possibleFeet = computed(() => {
  const { feet = [], parts = [] } = reading.value ?? {};
  const links = parts.flatMap((part) => {
    const name = footOf(part, feet);
    return name === null ? [] : [{ name, leg: part.leg, at_m: part.low_m }];
  });
  const all = [...feet, ...links];
  return all.filter(({ name }, n) => all.findIndex((other) => other.name === name) === n);
});

/** The feet of its legs. */
export const legFeet = computed(() => (reading.value?.robot ? reading.value.feet.filter(({ leg }) => leg > 0) : []));

/** @type {import("@preact/signals").ReadonlySignal<Tag[]>} */
export const tags = computed(() => (reading.value ? tagsOf(reading.value, extent.value) : []));

/** Whether there is room for tags beside the robot. */
export const hasRoomForTags = computed(() => !isPhone.value && pictureSize.value.width >= LEAST_WIDTH);

/** The points of what stands over the picture, by what they are of. */
const layers = computed(() => ({
  arrow: arrowPoints(extent.value, wantedForward.value - readForward.value),
  tips: arrowTips(extent.value).map(({ point }) => point),
  numbers: legFeet.value.map(({ at_m }) => numberPoint(at_m, extent.value)),
  feet: possibleFeet.value.map(({ at_m }) => at_m),
  tags: tags.value.map(({ at_m }) => at_m),
}));

/** @typedef {"arrow" | "tips" | "numbers" | "feet" | "tags"} Layer */
/** @typedef {Record<Layer, ({ x: number, y: number } | null)[]>} LayerPlaces */

/** Where they are in the picture; null until the 3D view has told of as many. */
/** @type {import("@preact/signals").ReadonlySignal<LayerPlaces | null>} */
export const layerPlaces = computed(() => {
  const entries = Object.entries(layers.value);
  const { points } = places.value;
  if (points.length !== entries.reduce((count, [, list]) => count + list.length, 0)) return null;
  let at = 0;
  return /** @type {LayerPlaces} */ (Object.fromEntries(entries.map(([name, list]) => {
    at += list.length;
    return [name, points.slice(at - list.length, at)];
  })));
});

const lists = { count: 0 };

/** Keep the 3D view at what is read, until the function that is returned is called. */
export function followInspecting() {
  isTurning.value = !matchMedia("(prefers-reduced-motion: reduce)").matches;
  [shownNote.value, draggedAngle.value, turned_deg.value] = [null, null, 0];
  clickMode.value = "groups";
  let before = /** @type {{ document: string | null, forward: number } | null} */ (null);
  const stops = [
    // The scene turns with another forward; the camera goes along, so that the robot stays as it is seen.
    effect(() => {
      const read = reading.value;
      const now = read?.robot ? { document: read.document, forward: read.robot.forward_deg } : null;
      untracked(() => {
        if (before && now && now.document === before.document) turned_deg.value -= inTurn(now.forward - before.forward);
        before = now ?? before;
        if (read && !read.robot && read.feet.length) clickMode.value = "feet";
      });
    }),
    effect(() => {
      const points = Object.values(layers.value).flat();
      lists.count += 1;
      inspection.value = reading.value && {
        world: "/world", ...viewOf(extent.value), points, of: lists.count, isTurning: isTurning.value && !isMet.value,
        turned_deg: turned_deg.value, margins_px: marginsFor(tags.value.length, pictureSize.value),
      };
    }),
    effect(() => {
      if (turnedByHand.value) isTurning.value = false;
    }),
    effect(() => {
      const node = clickedNode.value;
      if (node) untracked(() => click(node.node));
    }),
  ];
  return () => {
    stops.forEach((stop) => stop());
    inspection.value = null;
    clickedNode.value = null;
    turnedByHand.value = 0;
  };
}

// ---- what a person does

/** Turn the picture by a step. @param {1 | -1} sign */
export function turnBy(sign) {
  isTurning.value = false;
  turned_deg.value += sign * KEY_TURN_DEG;
}

export const toggleTurning = () => (isTurning.value = !isTurning.value);

/** Walk in another direction, from x of the torso [°]. @param {number} angle_deg */
export const chooseForward = (angle_deg) => decide(withForward(inTurn(angle_deg)));

/** Choose a foot, or choose it no more. @param {string} foot */
export function toggleFoot(foot) {
  isTurning.value = false;
  const wanted = withFoot(feetChosen.peek(), foot);
  decide(wanted);
  const wrong = wrongNumber(wanted.feet ?? []);
  if (wrong) readingAnnounced.value = wrong;
}

/** Move a leg to the next group. @param {number} leg */
export function nextGroup(leg) {
  isTurning.value = false;
  const robot = reading.peek()?.robot;
  if (robot) decide(withLegInNextGroup(robot.gait, groups.peek(), leg));
}

/** @param {string} node of the scene */
function click(node) {
  const read = reading.peek();
  if (!read) return;
  const part = clickedPart(node, read.parts, read.feet);
  if (!part) return;
  if (clickMode.peek() === "groups" && part.leg > 0) nextGroup(part.leg);
  else if (clickMode.peek() === "feet" && part.foot) toggleFoot(part.foot);
  else readingAnnounced.value = clickMode.peek() === "feet" ? "This cannot be a foot." : "This is no leg.";
}

/** Why the newest decision is not read; "" if it is, or will be. */
export const decisionProblem = computed(() =>
  (choices.value.feet ? wrongNumber(choices.value.feet) : "") || refusal.value);
