// Display names of what the server knows by identifiers.
import { sentence } from "./format.js";
import { options } from "./store.js";

/** @import { Described } from "./types.js" */

/** @type {Record<string, string>} */
const OBSERVATIONS = { measured: "feet measured", commanded: "commands remembered" };
/** @type {Record<string, string>} */
const SIMULATORS = { mujoco: "MuJoCo physics", kinematic: "ideal (no slip)" };
/** @type {Record<string, string>} */
const CLOCKS = { paper: "paper clock", wall: "real clock", free: "no clock" };

/** @type {(list: Described[] | undefined, name: string) => Described | undefined} */
const find = (list, name) => list?.find((one) => one.name === name);

/** @param {string} name */
export const gaitTitle = (name) => find(options.value?.gaits, name)?.title ?? name;
/** @param {string} name */
export const robotTitle = (name) => find(options.value?.robots, name)?.title ?? sentence(name);
/** @param {string} name */
export const observationTitle = (name) =>
  find(options.value?.observations, name)?.title ?? OBSERVATIONS[name] ?? name;
/** @param {string} name */
export const simulatorTitle = (name) => find(options.value?.simulators, name)?.title ?? SIMULATORS[name] ?? name;
/** @param {string} name */
export const clockTitle = (name) => find(options.value?.clocks, name)?.title ?? CLOCKS[name] ?? name;

/**
 * [name, title] of each, for a list of choices.
 * @param {Described[] | undefined} list
 * @param {(name: string) => string} titleOf
 * @returns {[string, string][]}
 */
export const choicesOf = (list, titleOf) => (list ?? []).map(({ name }) => [name, sentence(titleOf(name))]);
