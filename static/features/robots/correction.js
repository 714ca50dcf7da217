// The correction of a robot from a file: what was found in it, what a person decides, and its file read again.
import { computed, signal } from "@preact/signals";
import { pending } from "../../js/actions.js";
import { call } from "../../js/api.js";
import { form } from "../../js/form.js";
import { setEntry } from "../../js/store.js";
import { chooseStored, refresh } from "./stored-robots.js";
import { messageOf } from "../../js/titles.js";

/** @import { Signal } from "@preact/signals" */
/** @import { GaitConfig, RobotChoices, StoredRobot, WholeRobot } from "../../js/types.js" */

/** What the fields say, as texts; "" for what was found. */
/**
 * @typedef {{ forward: string, feet: string[], keyframe: string, angles: string, groups: string, torque: string,
 *   gain: string }} Fields
 */

/** Id of the robot that is corrected; null if none is. @type {Signal<string | null>} */
export const corrected = signal(null);
/** @type {Signal<WholeRobot | null>} */
export const whole = signal(null);
/** @type {Signal<Fields | null>} */
export const fields = signal(null);
/** What is wrong, or what the server refused; "" if nothing is. */
export const wrongChoice = signal("");
/** Its file is being read: until then the chosen robot may be one that is replaced, so nothing can be started. */
export const isReading = computed(() => Boolean(pending.value.robot));

/** Open the correction of a robot, or close it. @param {string | null} id */
export async function correct(id) {
  corrected.value = id;
  whole.value = null;
  fields.value = null;
  wrongChoice.value = "";
  if (id === null) return;
  try {
    const robot = /** @type {WholeRobot} */ (await call("GET", `robots/${encodeURIComponent(id)}`));
    if (corrected.peek() !== id) return;
    whole.value = robot;
    fields.value = fieldsOf(robot);
  } catch (error) {
    wrongChoice.value = messageOf(/** @type {Error} */ (error));
  }
}

/** @param {WholeRobot} robot @returns {Fields} */
function fieldsOf({ choices, groups, found }) {
  const { forward, feet, keyframe, home_rad, servo_torque_nm, servo_kp } = /** @type {RobotChoices} */ (choices ?? {});
  return {
    forward: String(forward ?? ""), keyframe: keyframe ?? "",
    // In the order of the file.
    feet: found?.feet.filter((name) => (feet ?? found.legs.map(({ foot }) => foot)).includes(name)) ?? [],
    angles: Object.entries(home_rad ?? {}).map(([joint, angle]) => `${joint}=${angle}`).join(", "),
    groups: groups.map((legs) => legs.join("+")).join(", "),
    torque: String(servo_torque_nm ?? ""), gain: String(servo_kp ?? ""),
  };
}

/** @type {<Name extends keyof Fields>(name: Name, value: Fields[Name]) => void} */
export const setCorrection = (name, value) => {
  if (fields.value) fields.value = { ...fields.value, [name]: value };
};

const DIRECTIONS = ["x", "-x", "y", "-y"];

/** A number that was typed. @type {(name: string, text: string) => number} */
function numberIn(name, text) {
  const value = Number(text.trim().replace("\u2212", "-"));
  if (!text.trim() || !Number.isFinite(value)) throw new Error(`${name} must be a number, not “${text}”.`);
  return value;
}

/** @param {string} text */
function anglesIn(text) {
  const parts = text.split(/[,;]/).map((text_) => text_.trim()).filter(Boolean);
  return Object.fromEntries(parts.map((assignment) => {
    const [joint, angle, ...more] = assignment.split("=").map((word) => word.trim());
    if (!joint || angle === undefined || more.length) {
      throw new Error(`An angle is written as joint=radians, not “${assignment}”.`);
    }
    return [joint, numberIn(`The angle of ${joint}`, angle)];
  }));
}

/** Groups of legs by numbers: "1+3, 2+4". @param {string} text */
const groupsIn = (text) => text.split(/[,;]/).map((group) =>
  group.split(/[+ ]/).filter(Boolean).map((leg) => numberIn("A leg", leg)));

/** What is decided. @type {(now: Fields, before: WholeRobot) => RobotChoices} */
function choicesOf(now, before) {
  const was = fieldsOf(before);
  const keptChoices = /** @type {RobotChoices} */ (before.choices ?? {});
  const isOther = (/** @type {keyof Fields} */ name) => String(now[name]) !== String(was[name]);
  const forward = DIRECTIONS.includes(now.forward) ? now.forward : now.forward && numberIn("Forward", now.forward);
  const angles = anglesIn(now.angles);
  const choices = {
    ...keptChoices,
    forward: forward === "" ? null : forward,
    keyframe: now.keyframe || null,
    home_rad: Object.keys(angles).length ? angles : null,
    servo_torque_nm: now.torque ? numberIn("Torque", now.torque) : null,
    servo_kp: now.gain ? numberIn("Stiffness", now.gain) : null,
    ...(isOther("feet") ? { feet: now.feet, gait: null } : {}),
    // Legs are numbered from the front right one: with another forward their numbers are others'.
    ...(isOther("forward") ? { gait: null } : {}),
  };
  return /** @type {RobotChoices} */ (Object.fromEntries(
    Object.entries(choices).filter(([, value]) => value !== null)));
}

/**
 * The groups that were typed, as a gait; those of the robot unless its legs get other numbers, null then.
 * @type {(now: Fields, before: WholeRobot) => GaitConfig | null}
 */
function gaitOf(now, before) {
  const was = fieldsOf(before);
  if (now.groups === was.groups) {
    return String(now.feet) === String(was.feet) && now.forward === was.forward ? before.gait : null;
  }
  const { right_leg, left_leg } = /** @type {{ right_leg: number, left_leg: number }} */ (
    typeof before.gait === "object" ? before.gait : { right_leg: 1, left_leg: 2 });
  return { right_leg, left_leg, groups: groupsIn(now.groups) };
}

/** Have the file read again with what the fields say. */
export async function readAgain() {
  const [now, before] = [fields.peek(), whole.peek()];
  if (!now || !before || isReading.peek()) return;
  setEntry(pending, "robot", true);
  wrongChoice.value = "";
  const isChosen = form.peek().robot === before.id;
  try {
    const choices = choicesOf(now, before);
    const gait = gaitOf(now, before);
    const changed = /** @type {StoredRobot} */ (
      await call("PATCH", `robots/${encodeURIComponent(before.id)}`, { choices, ...(gait ? { gait } : {}) }));
    await refresh();
    if (isChosen) chooseStored(changed.id);
    await correct(changed.id);
  } catch (error) {
    wrongChoice.value = messageOf(/** @type {Error} */ (error));
  }
  setEntry(pending, "robot", false);
}
