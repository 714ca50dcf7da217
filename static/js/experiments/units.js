// Distances as one likes to compare them: in metres, in half grid sides, or relative to greedy.
import { signal } from "@preact/signals";
import { metres } from "../format.js";

const MINUS = "\u2212";
const NARROW = "\u202f";

export const UNITS = [["m", "metres"], ["h", "half grid sides"], ["greedy", "relative to greedy"]];
export const unit = signal("m");

/**
 * What a distance in metres is multiplied with; null where there is nothing to measure with.
 * @param where {half_side_m, greedy_m}
 */
export function factorOf({ half_side_m, greedy_m }) {
  if (unit.value === "m") return 1;
  const one = unit.value === "h" ? half_side_m : greedy_m;
  return one ? 1 / one : null;
}

/** A number of the chosen unit: "0.38 m", "19.1 h", "76 %". */
export function shown(value) {
  if (value === null || value === undefined || Number.isNaN(value)) return "–";
  if (unit.value === "m") return metres(value);
  const digits = unit.value === "h" ? 1 : 0;
  const rounded = (unit.value === "h" ? value : 100 * value).toFixed(digits);
  const signed = rounded.replace("-", MINUS);
  return unit.value === "h" ? `${signed}${NARROW}h` : `${signed}${NARROW}%`;
}

/** Without the unit, for the ends of an interval. */
export const bare = (value) => shown(value).replace(/[^\d.−–].*$/u, "");

export const inUnit = (value, factor) => (value === null || value === undefined || factor === null ? null : value * factor);

/** What stands beside an axis. */
export const UNIT_NAMES = { m: "metres in 50 steps", h: "half grid sides in 50 steps", greedy: "share of greedy’s distance" };
