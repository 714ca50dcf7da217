// Follows the experiments, their summaries and the form, from the first time that they are needed.
import { openExperimentForm } from "./form.js";
import { announceExperiments, followEstimate, followExperiments, followSummary } from "./runs.js";

let isFollowing = false;

/** Begin; the server's options are there. */
export function follow() {
  if (isFollowing) return;
  isFollowing = true;
  openExperimentForm();
  followExperiments();
  followSummary();
  followEstimate();
  announceExperiments();
}
