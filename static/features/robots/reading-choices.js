// Decisions about a robot from a file, as a person makes them by clicks, in place of what was guessed: pure functions.
import { listed } from "../../js/format.js";
import { massInWords } from "./quantities.js";

/** @import { GaitConfig, GaitParts } from "../../js/types.js" */
/** @import { FoundRobot, ReadingChoices, ReadingFoot, ReadingPart } from "./reading.js" */

export const [LEAST_LEGS, MOST_LEGS] = [3, 12];

/** Axes of the torso, and their angles from x, anticlockwise [°]. @type {[string, number, string][]} */
export const AXES = [["x", 0, "x"], ["y", 90, "y"], ["-x", 180, "−x"], ["-y", -90, "−y"]];

/** An angle from -180° (excluded) to 180°. @param {number} angle_deg */
export const inTurn = (angle_deg) => {
  const angle = ((Math.round(angle_deg) % 360) + 360) % 360;
  return angle > 180 ? angle - 360 : angle;
};

/** A direction as it is chosen: an axis of the torso where it is one, else its angle. @param {number} angle_deg */
export const directionOf = (angle_deg) =>
  AXES.find(([, axis_deg]) => axis_deg === inTurn(angle_deg))?.[0] ?? inTurn(angle_deg);

/** A direction in words: "−x", "30° from x". @param {number} angle_deg */
export function directionInWords(angle_deg) {
  const [, , axis] = AXES.find(([, axis_deg]) => axis_deg === inTurn(angle_deg)) ?? [];
  return axis ?? `${String(inTurn(angle_deg)).replace("-", "−")}° from x`;
}

/** The angle of a direction that was chosen [°]. @param {string | number} direction */
export const angleOf = (direction) => {
  const axis = AXES.find(([name]) => name === direction);
  return axis ? axis[1] : Number(direction);
};

/**
 * With another forward, legs have other numbers: groups by numbers are guessed anew.
 * @param {number} angle_deg from x of the torso in the file
 */
export const withForward = (angle_deg) => ({ forward: directionOf(angle_deg), gait: null });

/** Of another document nothing holds that names what is in this one. @param {string} file */
export const withDocument = (file) =>
  ({ file, feet: null, gait: null, forward: null, keyframe: null, home_rad: null, arguments: null });

/** What is decided by taking an offer. @param {ReadingChoices} offer @returns {ReadingChoices} */
export function asDecision(offer) {
  const { file, forward, ...rest } = decided(offer);
  return {
    ...(file ? withDocument(file) : {}),
    ...(forward === undefined || forward === null ? {} : withForward(angleOf(forward))), ...rest,
  };
}

/** The feet that are chosen: by a person, or as they were found. */
/** @type {(choices: ReadingChoices, robot: FoundRobot | null) => string[]} */
export const chosenFeet = ({ feet }, robot) => feet ?? robot?.legs.map(({ foot }) => foot) ?? [];

/**
 * With a foot more or less; the groups of the legs are guessed anew.
 * @type {(feet: string[], foot: string) => ReadingChoices}
 */
export const withFoot = (feet, foot) =>
  ({ feet: feet.includes(foot) ? feet.filter((name) => name !== foot) : [...feet, foot], gait: null });

/** Why there cannot be so many feet; "" where there can, or none are chosen. @param {string[] | null} [feet] */
export function wrongNumber(feet) {
  if (!feet) return "";
  if (feet.length < LEAST_LEGS) return `Choose at least ${LEAST_LEGS} feet; ${feet.length || "none"} so far.`;
  return feet.length > MOST_LEGS ? `Choose at most ${MOST_LEGS} feet; ${feet.length} so far.` : "";
}

/**
 * A gait of groups; a gait has the legs between which forward is.
 * @type {(gait: GaitConfig, groups: number[][]) => GaitConfig}
 */
function gaitOf(gait, groups) {
  const { right_leg = 1, left_leg = 2 } = /** @type {Partial<GaitParts>} */ (typeof gait === "object" ? gait : {});
  return { right_leg, left_leg, groups };
}

/** The groups that are wanted: by a person, or as they were found. */
/** @type {(choices: ReadingChoices, robot: FoundRobot | null) => number[][]} */
export function wantedGroups({ gait }, robot) {
  const groups = typeof gait === "object" ? gait?.groups : null;
  return Array.isArray(groups) ? groups : robot?.groups ?? [];
}

/**
 * With a leg in the next group; after the last one it begins a group of its own.
 * @type {(gait: GaitConfig, groups: number[][], leg: number) => ReadingChoices}
 */
export function withLegInNextGroup(gait, groups, leg) {
  const from = groups.findIndex((legs) => legs.includes(leg));
  const rest = groups.map((legs) => legs.filter((other) => other !== leg));
  const isAlone = rest[from]?.length === 0;
  const to = (from + 1) % (isAlone ? rest.length : rest.length + 1);
  const moved = [...rest, []].map((legs, number) => (number === to ? [...legs, leg].toSorted((a, b) => a - b) : legs));
  return { gait: gaitOf(gait, moved.filter((legs) => legs.length)) };
}

/** Groups of legs in words: "1+3+5, 2+4+6". @param {number[][]} groups */
export const groupsInWords = (groups) => groups.map((legs) => legs.join("+")).join(", ");

/**
 * What a person decides, without what is left to be guessed.
 * @param {ReadingChoices} choices
 * @returns {ReadingChoices}
 */
export const decided = (choices) => Object.fromEntries(Object.entries(choices).filter(([, value]) =>
  value !== null && value !== undefined && value !== ""
  && !(typeof value === "object" && !Array.isArray(value) && Object.keys(value).length === 0)));

/** How far the lowest point of a link may be from the middle of a foot that is its, in radii of the foot. */
const NEAR = 2;

/**
 * The foot of a part: the listed one that is at its end, such as a geom or a site, or else the part itself.
 * @type {(part: ReadingPart, feet: ReadingFoot[]) => string | null}
 */
export function footOf({ foot, low_m }, feet) {
  if (foot === null) return null;
  const atEnd = feet.find(({ at_m, radius_m }) =>
    Math.hypot(...at_m.map((coordinate, axis) => coordinate - low_m[axis])) <= NEAR * radius_m);
  return atEnd?.name ?? foot;
}

/** The foot of a node of the scene that was clicked, and its leg. */
/** @type {(node: string, parts: ReadingPart[], feet: ReadingFoot[]) => { foot: string | null, leg: number } | null} */
export function clickedPart(node, parts, feet) {
  const [, kind, index] = /\/(part|foot)\/(\d+)$/.exec(node) ?? [];
  const part = kind === "part" ? parts[Number(index)] : undefined;
  if (part) return { foot: footOf(part, feet), leg: part.leg };
  const foot = feet[Number(index)];
  return kind === "foot" && foot ? { foot: foot.name, leg: foot.leg } : null;
}

// ---- offers

/** "1:1,000" of 0.001, "10:1" of 10. @param {number} scale */
function ratio(scale) {
  const larger = Number((scale < 1 ? 1 / scale : scale).toPrecision(3)).toLocaleString("en");
  return scale < 1 ? `1:${larger}` : `${larger}:1`;
}

/** What each decision does, as a button says it. @type {Record<string, (value: any) => string>} */
const OFFERS = {
  scale: (scale) => `Read it at ${ratio(scale)}`,
  up: (axis) => `Read it with ${axis.replace("-", "−")} up`,
  angle_unit: (unit) => (unit === "deg" ? "Read angles as degrees" : "Read angles as radians"),
  forward: (direction) => `Walk along ${directionInWords(angleOf(direction))}`,
  feet: (feet) => `Take ${feet.length} feet: ${listed(feet.slice(0, 3))}${feet.length > 3 ? "…" : ""}`,
  gait: (gait) => (Array.isArray(gait?.groups) ? `Group legs ${groupsInWords(gait.groups)}` : "Take these groups"),
  file: (path) => `Read ${path.split("/").at(-1)} instead`,
  keyframe: (name) => `Stand as in ${name}`,
  body_height_m: (height_m) => `Stand ${Math.round(1000 * height_m)} mm high`,
  home_rad: () => "Stand so",
  mass_kg: (mass_kg) => `Weigh ${massInWords(mass_kg)}`,
  servo_torque_nm: (torque) => `Take ${torque} N·m`,
};

/** An offer in words. @param {ReadingChoices} offer */
export function offerInWords(offer) {
  const words = Object.entries(decided(offer)).map(([name, value]) => OFFERS[name]?.(value) ?? "Take this");
  return [...new Set(words)].map((text, n) => (n ? text[0].toLowerCase() + text.slice(1) : text)).join(", ");
}
