// What one can do with experiments. Each keeps its own error, shown beside what caused it.
import * as api from "../api.js";
import { attempt, remove } from "../actions.js";
import { count } from "../format.js";
import { isOperator } from "../selectors.js";
import { keepRun } from "../store.js";
import { wantedRun } from "./address.js";
import { body, chosenKind, mistakes, trials } from "./form.js";

/** What the button will do. */
export const startLabel = () => `Run ${chosenKind.value.title}: ${count(trials.value, "trial")}`;

export const canStart = () =>
  isOperator.value && Object.keys(mistakes.value).length === 0 && trials.value > 0;

export const start = () =>
  attempt("experiment", async () => {
    const run = await api.startExperiment(body());
    keepRun(run);
    wantedRun.value = run.id;
  });

/** `verb` is stop, pause or resume. */
export const tell = (run, verb) =>
  attempt(run.id, async () => {
    const answer = await api.tell(run, verb);
    if (answer?.id) keepRun(answer);
  });

export const discard = async (run) => {
  await remove(run);
  if (wantedRun.value === run.id) wantedRun.value = null;
};
