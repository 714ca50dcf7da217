// What a class gains by a lesson, in words and as shares.
import { percentage } from "../../../../js/format.js";

/** @import { Gain } from "../../../../js/types.js" */

/** A share in points of a hundred, with its sign. @param {number} share */
export const points = (share) => `${share > 0 ? "+" : share < 0 ? "\u2212" : ""}${Math.round(Math.abs(100 * share))}`;

/** The gain in a sentence. @param {Gain} gain */
export function gainInWords({ pairs, right_before, right_after, gain, low, high }) {
  const range = low === null || high === null ? "" : ` (95\u00a0%: ${points(low)} to ${points(high)})`;
  const [before, after] = [right_before, right_after].map((right) => percentage(right / pairs));
  const who = pairs === 1 ? "the one who answered twice" : `${pairs} who answered twice`;
  return `Of ${who}, ${before} were right before and ${after} after: ${points(gain)} points${range}.`;
}
