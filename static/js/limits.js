// Checks a number against the limits that the server states.
import { whole } from "./format.js";
import { options } from "./store.js";

/** @import { Limits } from "./types.js" */

/** @type {(value: number) => string} */
const shown = (value) => (Number.isInteger(value) ? whole(value) : String(value));

/**
 * The limits of a field; none where the server states none.
 * @param {string} field
 * @returns {Limits}
 */
export const limitsOf = (field) => options.value?.limits[field] ?? [null, null];

/**
 * Limits in words: "from 0 to 1", "at least 0"; empty without limits.
 * @param {Limits} limits
 */
export function rangeOf([low, high]) {
  if (low !== null && high !== null) return `from ${shown(low)} to ${shown(high)}`;
  if (low !== null) return `at least ${shown(low)}`;
  return high === null ? "" : `at most ${shown(high)}`;
}

/** @type {(value: number, limits: Limits) => boolean} */
const isWithin = (value, [low, high]) => (low === null || value >= low) && (high === null || value <= high);

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
