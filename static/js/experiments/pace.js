// How fast trials end, and how long the rest takes.
import { count, duration, whole } from "../format.js";

/** Trials a second, which is what the time left was reckoned with; null before that is known. */
const rateOf = ({ eta_s, progress: { done, total } }) => (eta_s > 0 && done > 0 ? (total - done) / eta_s : null);

/** {share, label, left} in words: "412 of 1 008 trials", "9.8 a second, 1 min left". */
export function paceOf(run) {
  const { done, total } = run.progress;
  const share = total ? done / total : 0;
  const label = `${whole(done)} of ${count(total, "trial")}`;
  if (run.state !== "running") return { share, label, left: "" };
  const rate = rateOf(run);
  if (rate === null) return { share, label, left: "" };
  return { share, label, left: `${rate < 10 ? rate.toFixed(1) : whole(rate)} a second, ${duration(run.eta_s)} left` };
}
