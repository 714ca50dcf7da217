// The unit of distances in a report: metres, half grid sides, or shares of greedy's distance.
import { signal } from "@preact/signals";
import { metres, THIN_SPACE } from "../format.js";

const MINUS = "\u2212";

/** @type {[string, string][]} */
export const UNITS = [["m", "metres"], ["h", "half grid sides"], ["greedy", "relative to greedy"]];
export const unit = signal("m");

/**
 * The factor from metres to the chosen unit; null where its reference is unknown.
 * @param {{ half_side_m: number, greedy_m: number | null }} reference
 */
export function factorOf({ half_side_m, greedy_m }) {
  if (unit.value === "m") return 1;
  const one = unit.value === "h" ? half_side_m : greedy_m;
  return one ? 1 / one : null;
}

/**
 * A number of the chosen unit with its sign: "0.38 m", "19.1 h", "76 %".
 * @param {number | null | undefined} value
 */
export function shown(value) {
  if (value === null || value === undefined || Number.isNaN(value)) return "–";
  if (unit.value === "m") return metres(value);
  const rounded = unit.value === "h" ? value.toFixed(1) : (100 * value).toFixed(0);
  return `${rounded.replace("-", MINUS)}${THIN_SPACE}${unit.value === "h" ? "h" : "%"}`;
}

/**
 * The same without the unit, for the ends of an interval.
 * @param {number | null | undefined} value
 */
export const bare = (value) => shown(value).replace(/[^\d.−–].*$/u, "");

/** @type {(value: number | null | undefined, factor: number | null) => number | null} */
export const inUnit = (value, factor) =>
  value === null || value === undefined || factor === null ? null : value * factor;

/** Labels of an axis. @type {Record<string, string>} */
export const UNIT_NAMES = {
  m: "metres in 50 steps",
  h: "half grid sides in 50 steps",
  greedy: "share of greedy’s distance",
};
