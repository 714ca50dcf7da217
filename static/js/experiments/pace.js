// The pace of an experiment: trials per second, and the time that is left.
import { count, duration, whole } from "../format.js";

/** @import { Run } from "../types.js" */

/**
 * Trials a second, as the estimate of the remaining time implies; null before there is one.
 * @param {Run} run
 */
const rateOf = ({ eta_s, progress: { done, total } }) =>
  eta_s && eta_s > 0 && done > 0 ? (total - done) / eta_s : null;

/**
 * Progress in words: "412 of 1008 trials", "9.8 a second, 1 min left".
 * @param {Run} run
 */
export function paceOf(run) {
  const { done, total } = run.progress;
  const share = total ? done / total : 0;
  const label = `${whole(done)} of ${count(total, "trial")}`;
  const rate = run.state === "running" ? rateOf(run) : null;
  if (rate === null) return { share, label, left: "" };
  const shown = rate < 10 ? rate.toFixed(1) : whole(rate);
  return { share, label, left: `${shown} a second, ${duration(run.eta_s ?? 0)} left` };
}
