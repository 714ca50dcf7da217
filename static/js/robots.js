// Robots as forms and runs have them: the name of a preset, or an object with a preset and what differs from it.

/** @import { RobotConfig } from "./types.js" */

/**
 * The preset of a robot, or the one that it is made from.
 * @param {RobotConfig | undefined} robot
 */
export const presetOf = (robot) => (typeof robot === "string" ? robot : robot?.preset);

/**
 * What differs from the preset: [field, value].
 * @param {RobotConfig | undefined} robot
 */
const differences = (robot) =>
  Object.entries(typeof robot === "object" ? robot : {}).filter(([field]) => field !== "preset" && field !== "name");

/**
 * A robot as the form keeps it: a preset by its name, a custom robot whole.
 * @template {RobotConfig} Robot
 * @param {Robot} robot
 */
export const formRobot = (robot) => (differences(robot).length ? robot : presetOf(robot) ?? robot);

/** JSON in which the order of an object's fields plays no part. @type {(value: unknown) => string} */
const canonical = (value) =>
  JSON.stringify(value, (_key, part) =>
    part && typeof part === "object" && !Array.isArray(part)
      ? Object.fromEntries(Object.entries(part).sort(([a], [b]) => a.localeCompare(b)))
      : part) ?? "";

/** @type {(one: unknown, other: unknown) => boolean} */
export const isSame = (one, other) => canonical(one) === canonical(other);

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

/**
 * A custom robot in words, "custom: stiff, femur 0.1 m"; null for a preset.
 * @param {RobotConfig | undefined} robot
 */
export function customRobotInWords(robot) {
  const differs = differences(robot);
  if (!differs.length) return null;
  const parts = differs.map(([field, value]) => differenceInWords(field, value));
  return `custom: ${[presetOf(robot), ...parts].filter(Boolean).join(", ")}`;
}
