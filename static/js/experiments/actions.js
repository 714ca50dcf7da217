// Actions on experiments. Each keeps its own error, which is shown beside the control that caused it.
import * as api from "../api.js";
import { attempt, deleteRun } from "../actions.js";
import { count } from "../format.js";
import { isOperator } from "../selectors.js";
import { requestRun } from "../store.js";
import { wantedRun } from "./address.js";
import { chosenExperiment, mistakes, requestBody, trials } from "./form.js";

/** @import { Run, Verb } from "../types.js" */

export const startLabel = () => `Run ${chosenExperiment.value.title}: ${count(trials.value, "trial")}`;

export const canStart = () =>
  isOperator.value && Object.keys(mistakes.value).length === 0 && trials.value > 0;

export const start = () =>
  attempt("experiment", async () => {
    const run = await requestRun(() => api.startExperiment(requestBody()));
    wantedRun.value = run.id;
  });

/** @type {(run: Run, verb: Verb) => Promise<void | null>} */
export const command = (run, verb) =>
  attempt(run.id, async () => {
    await requestRun(() => api.command(run, verb));
  });

/** @param {Run} run */
export const deleteExperiment = async (run) => {
  await deleteRun(run);
  if (wantedRun.value === run.id) wantedRun.value = null;
};
