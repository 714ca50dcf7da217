// Settings as the server declares them, and checks of numbers against their limits.
import { whole } from "./format.js";
import { kindOf, valueOf } from "./settings.js";
import { options, served } from "./store.js";

/** @import { Limits, SettingOption, SettingValue } from "./types.js" */

/** @type {(value: number) => string} */
const shown = (value) => (Number.isInteger(value) ? whole(value) : String(value));

/**
 * The declaration of a setting, for components: they are shown once the server has answered.
 * @type {(field: string) => SettingOption}
 */
export const settingOf = (field) => served().settings[field];

/**
 * The limits of a field; none where the server states none.
 * @param {string} field
 * @returns {Limits}
 */
export function limitsOf(field) {
  const setting = options.value?.settings[field];
  if (setting) return setting;
  const [minimum, maximum] = options.value?.limits[field] ?? [null, null];
  return { minimum, maximum, excludes_minimum: false, excludes_maximum: false };
}

/**
 * Limits in words: "from 0 to 1", "over 0 and at most 1", "at least 0"; empty without limits.
 * @param {Limits} limits
 */
export function rangeOf({ minimum, maximum, excludes_minimum, excludes_maximum }) {
  const lower = minimum === null ? "" : `${excludes_minimum ? "over" : "at least"} ${shown(minimum)}`;
  const upper = maximum === null ? "" : `${excludes_maximum ? "under" : "at most"} ${shown(maximum)}`;
  if (minimum === null || maximum === null) return lower || upper;
  if (excludes_minimum) return `${lower} and ${upper}`;
  return `from ${shown(minimum)} to ${excludes_maximum ? "under " : ""}${shown(maximum)}`;
}

/** @type {(value: number, limits: Limits) => boolean} */
const isWithin = (value, { minimum, maximum, excludes_minimum, excludes_maximum }) =>
  (minimum === null || value > minimum || (value === minimum && !excludes_minimum)) &&
  (maximum === null || value < maximum || (value === maximum && !excludes_maximum));

/**
 * The reason why a number is not valid; null if it is.
 * @param {number} value
 * @param {Limits} limits
 * @param {boolean} isInteger
 */
export function mistakeIn(value, limits, isInteger) {
  const range = rangeOf(limits);
  const said = range && `, ${range}`;
  if (!Number.isFinite(value)) return `Enter a number${said}`;
  if (isInteger && !Number.isInteger(value)) return `Enter a whole number${said}`;
  return isWithin(value, limits) ? null : `Must be ${range}`;
}

/**
 * The numbers of a list with commas, or why it is none.
 * @param {string} typed
 * @param {Limits} limits of each number
 * @param {boolean} isInteger
 * @returns {{ value?: number[], mistake?: string }}
 */
export function parseNumbers(typed, limits, isInteger) {
  const found = typed.split(",").map((part) => (part.trim() === "" ? NaN : Number(part)));
  if (!found.every(Number.isFinite)) return { mistake: "Enter numbers separated by commas" };
  if (isInteger && !found.every(Number.isInteger)) return { mistake: "Enter whole numbers" };
  if (!found.every((one) => isWithin(one, limits))) return { mistake: `Each must be ${rangeOf(limits)}` };
  if (new Set(found).size < found.length) return { mistake: "Enter each number once" };
  return { value: found };
}

/**
 * The values of a list with commas, or why it is none.
 * @param {string} typed
 * @param {SettingOption} setting
 * @returns {{ value?: SettingValue[], mistake?: string }}
 */
export function parseValues(typed, setting) {
  if (kindOf(setting) === "number") return parseNumbers(typed, setting, setting.is_whole);
  const found = typed.split(",").map((part) => valueOf(part.trim(), setting));
  if (found.includes(undefined)) return { mistake: `Each must be ${setting.valid}` };
  if (new Set(found).size < found.length) return { mistake: "Enter each value once" };
  return { value: /** @type {SettingValue[]} */ (found) };
}
