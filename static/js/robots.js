// Robots as forms and runs have them: the name of a preset or the id of a stored robot, or an object with either and
// what differs from it.
import { options } from "./settings.js";

/** @import { FieldOption, Gait, GaitConfig, Robot, RobotConfig } from "./types.js" */

/**
 * The name by which the server's options have a robot, or the one that it is made from: of a preset, or an id.
 * @param {RobotConfig | undefined} robot
 */
export const presetOf = (robot) => (typeof robot === "string" ? robot : robot?.preset ?? robot?.id);

const IDENTITY = ["preset", "id", "name"];

/**
 * Fields that differ from the preset: [field, value].
 * @param {RobotConfig | undefined} robot
 */
const differences = (robot) =>
  Object.entries(typeof robot === "object" ? robot : {}).filter(([field]) => !IDENTITY.includes(field));

/**
 * A robot as the form keeps it: a preset by its name, a stored robot by its id, a custom one whole.
 * @template {RobotConfig} Robot
 * @param {Robot} robot
 */
export const formRobot = (robot) => (differences(robot).length ? robot : presetOf(robot) ?? robot);

/**
 * A part of a robot as it was built; null where that is not known.
 * @param {RobotConfig | undefined} robot
 * @param {string} part
 * @param {Robot[]} presets
 */
export function builtPart(robot, part, presets) {
  const [, value = null] = differences(robot).find(([field]) => field === part) ?? [];
  const preset = presets.find(({ name }) => name === presetOf(robot));
  return typeof value === "number" ? value : preset?.built[part] ?? null;
}

/** JSON in which the order of an object's fields plays no part. @type {(value: unknown) => string} */
export const canonical = (value) =>
  JSON.stringify(value, (_key, item) =>
    item && typeof item === "object" && !Array.isArray(item)
      ? Object.fromEntries(Object.entries(item).sort(([a], [b]) => a.localeCompare(b)))
      : item) ?? "";

/** @type {(one: unknown, other: unknown) => boolean} */
export const isSame = (first, other) => canonical(first) === canonical(other);

/** @type {[string, string][]} */
const UNITS = [["_nm", "N·m"], ["_kg", "kg"], ["_m", "m"], ["_s", "s"]];

/**
 * A part of a robot in words, and its unit: ["femur", "m"] of `femur_m`.
 * @param {string} field
 */
export function partInWords(field) {
  const [suffix, unit] = UNITS.find(([ending]) => field.endsWith(ending)) ?? ["", ""];
  const words = field.slice(0, field.length - suffix.length).replaceAll("_", " ").replace("n legs", "number of legs");
  return [words, unit];
}

/** @type {(field: string, value: unknown) => string} */
function differenceInWords(field, value) {
  if (Array.isArray(value)) return `${value.length} own ${field}`;
  const [words, unit] = partInWords(field);
  return `${words} ${value}${unit && `\u00a0${unit}`}`;
}

/** The name of a stored robot as a run has it; undefined for others. @param {RobotConfig | undefined} robot */
export const storedName = (robot) => (typeof robot === "object" && robot.id ? robot.name : undefined);

/**
 * A custom robot in words, "custom: stiff, femur 0.1 m"; null for a preset and a stored robot.
 * @param {RobotConfig | undefined} robot
 */
export function customRobotInWords(robot) {
  const differs = differences(robot);
  if (!differs.length) return null;
  const parts = differs.map(([field, value]) => differenceInWords(field, value));
  return `custom: ${[storedName(robot) ?? presetOf(robot), ...parts].filter(Boolean).join(", ")}`;
}

// ---- where its legs are

/**
 * The legs' directions in the robot's own frame [°], anticlockwise. The first preset is the default robot.
 * @param {RobotConfig | undefined} robot
 * @param {Robot[]} presets
 * @returns {number[]}
 */
function bodyAzimuths(robot, presets) {
  const { legs, n_legs } = /** @type {any} */ (typeof robot === "object" ? robot : {});
  if (Array.isArray(legs)) {
    return legs.map(({ azimuth_deg, x_m, y_m }) => azimuth_deg ?? (Math.atan2(y_m, x_m) * 180) / Math.PI);
  }
  if (n_legs) return Array.from({ length: n_legs }, (_, leg) => (360 * leg) / n_legs);
  return (presets.find(({ name }) => name === presetOf(robot)) ?? presets[0]).azimuths_deg;
}

/**
 * How far the joints of a leg turn [rad], by their names; undefined where that is not known.
 * @param {RobotConfig | undefined} robot
 * @param {number} leg from 1
 * @param {Robot[]} presets
 * @returns {Record<string, [number, number]> | undefined}
 */
export function jointsOf(robot, leg, presets) {
  const { joints = [], limits_rad = [] } = presets.find(({ name }) => name === presetOf(robot)) ?? presets[0] ?? {};
  // A custom robot may have more legs than its preset; all of a preset's have the same joints.
  const at = joints[leg - 1] ? leg - 1 : 0;
  return joints[at] && Object.fromEntries(joints[at].map((name, number) => [name, limits_rad[at][number]]));
}

/** @type {(robot: RobotConfig | undefined, presets: Robot[]) => number} */
export const numberOfLegs = (robot, presets) => bodyAzimuths(robot, presets).length;

/**
 * The legs' directions from forward [°], anticlockwise, in the order of their numbers.
 * @param {RobotConfig | undefined} robot
 * @param {GaitConfig} gait a name, or a gait with the legs on the right and on the left of forward
 * @param {{ gaits: Gait[], robots: Robot[] }} options of the server; its gaits are for the robot with six legs
 */
export function azimuthsOf(robot, gait, { gaits, robots }) {
  const azimuths = bodyAzimuths(robot, robots);
  const named = gaits.find(({ name }) => name === gait);
  const { right_leg = 1, left_leg = 2 } = /** @type {any} */ (named ? legsBeside(named) : gait);
  const [right, left] = [azimuths[right_leg - 1] ?? 0, azimuths[left_leg - 1] ?? 0];
  const forward = right + ((((left - right) % 360) + 360) % 360) / 2;
  return azimuths.map((azimuth) => azimuth - forward);
}

/** The legs of a named gait between which forward is. @param {Gait} gait */
function legsBeside({ azimuths_deg }) {
  const nearest = (/** @type {number} */ sign) => {
    const onSide = azimuths_deg.map((azimuth, leg) => ({ azimuth: sign * azimuth, leg: leg + 1 }));
    return onSide.filter(({ azimuth }) => azimuth > 0).sort((a, b) => a.azimuth - b.azimuth)[0].leg;
  };
  return { right_leg: nearest(-1), left_leg: nearest(1) };
}

// ---- robots that are stored

/**
 * The stored robot that the form has by its id.
 * @type {(robot: RobotConfig | undefined, robots: Robot[]) => Robot | undefined}
 */
export const storedRobot = (robot, robots) => robots.find(({ id }) => id !== null && id === robot);

/**
 * Those that can be chosen: hidden ones only if they are chosen.
 * @type {(robots: Robot[], chosen: unknown[]) => Robot[]}
 */
export const offered = (robots, chosen) => robots.filter(({ name, hidden }) => !hidden || chosen.includes(name));

/**
 * The text of a robot in a link: a stored body by value too, for a server that does not have it.
 * @type {(robot: RobotConfig, robots: Robot[]) => string | null}
 */
export function linkedText(robot, robots) {
  const stored = storedRobot(robot, robots);
  return stored?.body ? JSON.stringify({ id: stored.id, name: stored.title, body: stored.body }) : null;
}

/**
 * A robot of a link: a stored one by its id, or what came with it where it is not stored.
 * @type {(robot: RobotConfig, robots: Robot[]) => RobotConfig}
 */
export function unlinked(robot, robots) {
  if (typeof robot !== "object" || !robot.body) return robot;
  return storedRobot(robot.id, robots) ? /** @type {string} */ (robot.id) : /** @type {RobotConfig} */ (robot.body);
}

// ---- kinds of disturbances as they fit a robot

/** @param {string} name */
export const kindNamed = (name) => (options.value?.disturbances ?? []).find((kind) => kind.name === name);

/**
 * A kind with the joints of a robot's leg: their names to choose from, and how far they turn.
 * @param {string} name
 * @param {RobotConfig} [robot]
 * @param {number} [leg]
 */
export function kindFor(name, robot, leg = 1) {
  const kind = kindNamed(name);
  const chosenIn = Object.values(kind?.fields ?? {}).flatMap(({ ranges }) => (ranges ? [ranges.field] : []));
  const joints = jointsOf(robot, leg, options.value?.robots ?? []);
  if (!kind || !joints || !chosenIn.length) return kind;
  const names = Object.keys(joints);
  /** @type {(own: string, field: FieldOption) => FieldOption} */
  const fitted = (preset, field) => {
    if (chosenIn.includes(preset)) {
      return { ...field, choices: names, choice_titles: names, valid: names.join(", or ") };
    }
    return field.ranges ? { ...field, ranges: { ...field.ranges, ranges: joints } } : field;
  };
  const fields = Object.entries(kind.fields).map(([name_, field]) => [name_, fitted(name_, field)]);
  return { ...kind, fields: Object.fromEntries(fields) };
}

/** The leg of the fields of a text; the first where there is none. @param {[string, string][]} fields */
export const legIn = (fields) => Number(fields.find(([field]) => field === "leg")?.[1]) || 1;
