// A body as it is edited: its legs, their mirror images, and the robot that they make. Places and directions are those
// of the picture, in which the gait's forward direction at the beginning is up; a robot has them in its own frame.

/** @import { GaitConfig, GaitParts, Preview, RobotConfig } from "../../js/types.js" */

/**
 * A leg: the numbers that are its own, as in a request; `given` is what the form had, until the leg is changed.
 * @typedef {{ parts: Record<string, number>, given: object | null }} Leg
 */
/**
 * `base`: the robot without its legs. `shared`: all its numbers as it was opened. `up_deg`: the direction in the
 * robot's frame that is up in the picture. `own`: the groups leg by leg, for legs that `gait` does not divide.
 * @typedef {object} Body
 * @property {Exclude<RobotConfig, string>} base
 * @property {Record<string, number | null>} shared
 * @property {Leg[]} legs
 * @property {number} up_deg
 * @property {GaitConfig} gait
 * @property {GaitParts} own
 */
/** The legs between which forward is. @typedef {Pick<GaitParts, "right_leg" | "left_leg">} GaitBeside */
/** A point of the picture [m]: to the right, and ahead. @typedef {[number, number]} Point */

/** Closer than this to its mirror image, a leg has one [m]. */
const SAME_PLACE_M = 0.002;
const PLACE = ["x_m", "y_m", "yaw_deg", "foot_out_m"];
const LEGS_OF_RING = ["legs", "n_legs", "mount_radius_m"];
const DIGITS = 6;

/** @type {<Value>(parts: Record<string, Value>, names: string[]) => Record<string, Value>} */
const without = (parts, names) =>
  Object.fromEntries(Object.entries(parts).filter(([name]) => !names.includes(name)));

/** Without the digits that rotations add. @param {number} value */
const rounded = (value) => Number(value.toFixed(DIGITS));
/** @param {number} angle_deg */
const wrapped = (angle_deg) => {
  const from = rounded(((angle_deg % 360) + 540) % 360) - 180;
  return rounded(from === -180 ? 180 : from);
};

/** @type {(point: Point, angle_deg: number) => Point} */
function turned([x, y], angle_deg) {
  const angle = (angle_deg * Math.PI) / 180;
  const [cos, sin] = [Math.cos(angle), Math.sin(angle)];
  return [rounded(cos * x - sin * y), rounded(sin * x + cos * y)];
}

/**
 * The body of a robot.
 * @param {RobotConfig} robot as the form has it
 * @param {GaitConfig} gait
 * @param {Preview} preview
 * @returns {Body}
 */
export function openBody(robot, gait, preview) {
  const document = typeof robot === "string" ? { preset: robot } : robot;
  const { legs } = /** @type {{ legs?: object[] }} */ (document);
  return {
    base: without(document, LEGS_OF_RING),
    shared: preview.built,
    legs: preview.legs.map(({ built }, number) => ({
      parts: Object.fromEntries(Object.entries(built)
        .filter(([field, value]) => PLACE.includes(field) || value !== (preview.built[field] ?? 0))
        .map(([field, value]) => [field, rounded(value)])),
      given: legs?.[number] ?? null,
    })),
    up_deg: preview.forward_deg,
    gait,
    own: /** @type {GaitParts} */ (preview.gait),
  };
}

/** The robot that a body makes, as the form has it. @param {Body} body @returns {RobotConfig} */
export const robotOf = ({ base, legs }) => ({ ...base, legs: legs.map(({ parts, given }) => given ?? parts) });

/** A number that legs may share, or the torso's. @type {(body: Body, part: string) => number | null} */
export const sharedPart = ({ base, shared }, field) =>
  /** @type {number | null} */ (base[field] ?? shared[field] ?? null);

/** Whether the torso is a box. @param {Body} body */
export const isBox = (body) => sharedPart(body, "torso_length_m") !== null;

// ---- the picture

/** By how much the robot's frame is turned against the picture [°]. @param {Body} body */
const turnOf = ({ up_deg }) => up_deg - 90;

/**
 * The numbers of a leg, with its place as in the picture.
 * @type {(body: Body, leg: number) => Record<string, number>}
 */
export function partsOf(body, leg) {
  const { parts } = body.legs[leg - 1];
  const [x_m, y_m] = turned([parts.x_m, parts.y_m], -turnOf(body));
  const shared = Object.keys(body.shared).map((field) => [field, sharedPart(body, field)]);
  return { ...Object.fromEntries(shared), ...parts, x_m, y_m, yaw_deg: wrapped(parts.yaw_deg - turnOf(body)) };
}

/** The point at a distance in a direction. @type {(from: Point, yaw_deg: number, distance_m: number) => Point} */
const pointAt = ([x, y], yaw_deg, distance_m) => {
  const [right, ahead] = turned([distance_m, 0], yaw_deg);
  return [x + right, y + ahead];
};

/**
 * A leg from above: its coxa joint, the end of its coxa, and its foot at home.
 * @type {(body: Body, leg: number) => { mount: Point, coxa: Point, foot: Point }}
 */
export function drawnLeg(body, leg) {
  const { x_m, y_m, yaw_deg, foot_out_m, coxa_m } = partsOf(body, leg);
  const at = (/** @type {number} */ distance_m) => pointAt([x_m, y_m], yaw_deg, distance_m);
  return { mount: [x_m, y_m], coxa: at(Math.min(coxa_m, foot_out_m)), foot: at(foot_out_m) };
}

/** @param {Body} body */
export const numbersOf = ({ legs }) => legs.map((_, number) => number + 1);

/** Half the side of a square picture in which a body has room [m], in whole steps. @param {Body} body */
export function extentOf(body) {
  const feet = numbersOf(body).flatMap((leg) => Object.values(drawnLeg(body, leg)).flat());
  const torso = ["torso_length_m", "torso_width_m"].map((field) => (sharedPart(body, field) ?? 0) / 2);
  const farthest = Math.max(...feet.map(Math.abs), ...torso);
  return Math.ceil((farthest + MARGIN_M) / EXTENT_STEP_M) * EXTENT_STEP_M;
}
const MARGIN_M = 0.03;
const EXTENT_STEP_M = 0.05;

// ---- changes, each of which returns a new body

/** @type {(body: Body, leg: number, changes: Record<string, number>) => Body} */
const withParts = (body, leg, changes) => ({
  ...body,
  legs: body.legs.map((bodyLeg, number) =>
    (number === leg - 1 ? { parts: { ...bodyLeg.parts, ...changes }, given: null } : bodyLeg)),
});

/**
 * The leg at the mirror image of another; that itself where it stands on the axis, null if there is none.
 * @type {(body: Body, leg: number) => number | null}
 */
export function mirrorOf(body, leg) {
  const { x_m, y_m } = partsOf(body, leg);
  const distances = numbersOf(body).filter((other) => other !== leg).map((other) => {
    const { mount: [x, y] } = drawnLeg(body, other);
    return { other, distance_m: Math.hypot(x + x_m, y - y_m) };
  });
  const [nearest] = distances.toSorted((a, b) => a.distance_m - b.distance_m);
  if (nearest && nearest.distance_m <= SAME_PLACE_M) return nearest.other;
  return Math.abs(x_m) <= SAME_PLACE_M ? leg : null;
}

/** Numbers of a leg, in the picture, as those of its mirror image. @param {Record<string, number>} parts */
const mirrored = (parts) => Object.fromEntries(Object.entries(parts).map(([field, value]) => {
  if (field === "x_m") return [field, 0 - value];
  return [field, field === "yaw_deg" ? wrapped(180 - value) : value];
}));

/**
 * Numbers in the picture as those of the robot's frame.
 * @type {(body: Body, parts: Record<string, number>) => Record<string, number>}
 */
function inRobotFrame(body, { x_m, y_m, yaw_deg, ...rest }) {
  const [x, y] = turned([x_m, y_m], turnOf(body));
  return { ...rest, x_m: x, y_m: y, yaw_deg: wrapped(yaw_deg + turnOf(body)) };
}

/**
 * Change numbers of a leg, given as in the picture. `mirror`: the leg that follows as its mirror image; a leg that is
 * its own stays on the axis.
 * @type {(body: Body, leg: number, changes: Record<string, number>, mirror: number | null) => Body}
 */
export function changeLeg(body, leg, changes, mirror) {
  const legChanges = mirror === leg ? without(changes, ["x_m", "yaw_deg"]) : changes;
  if (!Object.keys(legChanges).length) return body;
  const { x_m, y_m, yaw_deg } = partsOf(body, leg);
  const now = { x_m, y_m, yaw_deg, ...legChanges };
  const changed = withParts(body, leg, inRobotFrame(body, now));
  if (mirror === null || mirror === leg) return changed;
  return withParts(changed, mirror, inRobotFrame(body, mirrored(now)));
}

/** Give all legs the same number. @type {(body: Body, part: string, value: number) => Body} */
export function changeAll(body, field, value) {
  if (PLACE.includes(field)) {
    return numbersOf(body).reduce((changed, leg) => withParts(changed, leg, { [field]: value }), body);
  }
  const legs = body.legs.map((bodyLeg) => {
    const hasOwn = field in bodyLeg.parts;
    return hasOwn ? { parts: without(bodyLeg.parts, [field]), given: null } : bodyLeg;
  });
  return { ...body, legs, base: { ...body.base, [field]: value } };
}

/** @type {(body: Body, changes: Record<string, number>) => Body} */
export const changeTorso = (body, changes) => ({ ...body, base: { ...body.base, ...changes } });

/** Make a round torso a box that is as long and as wide. @param {Body} body */
export function makeBox(body) {
  const side = 2 * (sharedPart(body, "torso_radius_m") ?? 0);
  return changeTorso(body, { torso_length_m: side, torso_width_m: side });
}

// ---- other legs: they are numbered anew, and the gait's groups follow

/** The direction of a leg's mount from ahead [°], to the left. @type {(body: Body, leg: number) => number} */
function azimuthOf(body, leg) {
  const { x_m, y_m } = partsOf(body, leg);
  return rounded((Math.atan2(-x_m, y_m) * 180) / Math.PI);
}

/** The numbers of legs anticlockwise, from the front right one. @param {Body} body */
function inOrder(body) {
  const legs = numbersOf(body).map((leg) => ({ leg, azimuth: azimuthOf(body, leg) }));
  const right = legs.filter(({ azimuth }) => azimuth < 0 && azimuth > -180);
  const first = right.length ? Math.max(...right.map(({ azimuth }) => azimuth)) : 0;
  const from = (/** @type {number} */ azimuth) => (((azimuth - first) % 360) + 360) % 360;
  return legs.toSorted((a, b) => from(a.azimuth) - from(b.azimuth)).map(({ leg }) => leg);
}

/**
 * Number the legs anew; groups keep their legs. A gait by its name stays where forward is between legs of the numbers
 * that it names.
 * @type {(body: Body, before: GaitParts) => Body}
 */
function renumbered(body, before) {
  const order = inOrder(body);
  const numberOf = (/** @type {number} */ leg) => order.indexOf(leg) + 1;
  const [right, left] = [body.own.right_leg, body.own.left_leg].map(numberOf);
  const legs = order.map((leg) => body.legs[leg - 1]);
  const byAzimuth = { ...body, legs };
  const onLeft = numbersOf(byAzimuth).find((leg) => azimuthOf(byAzimuth, leg) > 0) ?? 2;
  const startLegs = { right_leg: right || 1, left_leg: left || onLeft };
  const groups = /** @type {number[][]} */ (body.own.groups)
    .map((group) => group.map(numberOf).filter(Boolean).toSorted((a, b) => a - b)).filter((group) => group.length);
  const ownGait = /** @type {GaitParts} */ ({ ...startLegs, groups });
  return { ...byAzimuth, own: ownGait, gait: gaitAfter(body.gait, before, startLegs) ?? ownGait };
}

/** @type {(gait: GaitConfig, before: GaitParts, beside: GaitBeside) => GaitConfig | null} */
function gaitAfter(gait, before, startLegs) {
  if (typeof gait === "string") {
    return startLegs.right_leg === before.right_leg && startLegs.left_leg === before.left_leg ? gait : null;
  }
  return Array.isArray(gait.groups) || gait.pairs ? null : { ...gait, ...startLegs };
}

/** @type {(groups: unknown, change: (group: number[]) => number[]) => any} */
const eachGroup = (groups, change) => /** @type {number[][]} */ (groups).map(change);

/**
 * Remove a leg, and its mirror image.
 * @type {(body: Body, leg: number, mirror: number | null) => Body}
 */
export function removeLeg(body, leg, mirror) {
  const gone = [leg, mirror];
  const remaining = numbersOf(body).filter((number) => !gone.includes(number));
  const numberOf = (/** @type {number} */ number) => remaining.indexOf(number) + 1;
  const groups = eachGroup(body.own.groups, (group) => group.map(numberOf).filter(Boolean));
  const [right_leg, left_leg] = [body.own.right_leg, body.own.left_leg].map(numberOf);
  const legs = remaining.map((number) => body.legs[number - 1]);
  return renumbered({ ...body, legs, own: { ...body.own, right_leg, left_leg, groups } }, body.own);
}

/**
 * Add a leg in the widest gap between two; mirrored with its image, which moves with it, unless the gap is at the
 * front or the back, where it stands on the axis.
 * @type {(body: Body, isMirrored: boolean, most: number) => { body: Body, leg: number }}
 */
export function addLeg(body, isMirrored, most) {
  const order = inOrder(body);
  const gaps = order.map((leg, number) => {
    const next = order[(number + 1) % order.length];
    const [from, to] = [azimuthOf(body, leg), azimuthOf(body, next)];
    const width = rounded((((to - from) % 360) + 360) % 360) || 360;
    return { parts: between(body, leg, next), width };
  });
  const isOnAxis = (/** @type {typeof gaps[0]} */ { parts }) => Math.abs(parts.x_m) <= SAME_PLACE_M;
  const hasRoomForTwo = isMirrored && body.legs.length + 2 <= most;
  const fitting = isMirrored ? gaps.filter((gap) => isOnAxis(gap) || hasRoomForTwo) : gaps;
  const [widest] = (fitting.length ? fitting : gaps)
    .toSorted((a, b) => b.width - a.width || Number(isOnAxis(a)) - Number(isOnAxis(b)));
  const both = hasRoomForTwo && !isOnAxis(widest) ? [widest.parts, mirrored(widest.parts)] : [widest.parts];
  // Of a pair the right one is chosen.
  const added = both.toSorted((a, b) => b.x_m - a.x_m)
    .map((parts) => ({ parts: inRobotFrame(body, parts), given: null }));
  const numbers = added.map((_, number) => body.legs.length + number + 1);
  const groups = [.../** @type {number[][]} */ (body.own.groups), numbers];
  const enlarged = renumbered({
    ...body, legs: [...body.legs, ...added], own: /** @type {GaitParts} */ ({ ...body.own, groups }),
  }, body.own);
  return { body: enlarged, leg: enlarged.legs.indexOf(added[0]) + 1 };
}

/** A leg in the middle between two. @type {(body: Body, leg: number, next: number) => Record<string, number>} */
function between(body, leg, next) {
  const [leftParts, rightParts] = [partsOf(body, leg), partsOf(body, next)];
  const mean = (/** @type {string} */ field) => rounded((leftParts[field] + rightParts[field]) / 2);
  const yaw_deg = wrapped(leftParts.yaw_deg + wrapped(rightParts.yaw_deg - leftParts.yaw_deg) / 2);
  return { x_m: mean("x_m"), y_m: mean("y_m"), yaw_deg, foot_out_m: mean("foot_out_m") };
}
