// Kinds of disturbances, as the server declares them and as they fit a robot.
import { jointsOf } from "./robots.js";
import { options } from "./store.js";

/** @import { FieldOption, RobotConfig } from "./types.js" */

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
  const fitted = (own, field) => {
    if (chosenIn.includes(own)) return { ...field, choices: names, choice_titles: names, valid: names.join(", or ") };
    return field.ranges ? { ...field, ranges: { ...field.ranges, ranges: joints } } : field;
  };
  const fields = Object.entries(kind.fields).map(([own, field]) => [own, fitted(own, field)]);
  return { ...kind, fields: Object.fromEntries(fields) };
}

/** The leg of the fields of a text; the first where there is none. @param {[string, string][]} fields */
export const legIn = (fields) => Number(fields.find(([field]) => field === "leg")?.[1]) || 1;
