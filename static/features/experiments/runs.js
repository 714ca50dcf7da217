// The known experiments, and the chosen one: its address, summary and pace, and the actions on it.
import { computed, effect, signal } from "@preact/signals";
import { attempt } from "../../js/actions.js";
import { deleteRun } from "../../js/run-deletions.js";
import * as api from "../../js/api.js";
import { askForNewest } from "../../js/api.js";
import { getSummary, startExperiment } from "./api.js";
import { runTitle, summarised } from "./feature.js";
import { count } from "../../js/format.js";
import { announcement } from "../../js/headline.js";
import { hasFeature } from "../../js/features.js";
import { page } from "../../js/page-state.js";
import { followRuns, makeList, NO_FILTERS } from "../../js/runs.js";
import { everyRun, isActive, isOperator } from "../../js/selectors.js";
import { connection, isGone, options, requestRun, runs, setEntry } from "../../js/store.js";
import { chosenExperiment, mistakes, requestBody, trials } from "./form.js";

/** @import { ReadonlySignal, Signal } from "@preact/signals" */
/** @import { RequestError } from "../../js/api.js" */
/** @import { Estimate, Run, Summary, Verb } from "../../js/types.js" */

// ---- the known experiments, newest first, and the one whose report is shown

export const experimentRuns = computed(() => everyRun.value.filter(({ kind }) => kind === "experiment"));

/** The requested one, else the active one, else the newest. */
export const chosenRun = computed(() => {
  const all = experimentRuns.value;
  if (page.report.value) return all.find(({ id }) => id === page.report.value) ?? null;
  return all.find(isActive) ?? all[0] ?? null;
});

/** Listed by themselves: the first snapshot may have had room for trainings and races only. */
export const experimentList = makeList(signal({ ...NO_FILTERS, kind: "experiment" }));

/** Whether the requested run is no experiment of this server, by its answer. */
export const isMissing = computed(() => {
  const id = page.report.value;
  if (id === null) return false;
  const run = runs.value.get(id);
  return run ? run.kind !== "experiment" : isGone(id);
});

export function followExperiments() {
  experimentList.follow("experiments");
  followRuns(computed(() => (page.view.value === "experiments" && page.report.value ? [page.report.value] : [])));
}

// ---- the summary of the chosen experiment, requested again as its trials end

const PAUSE_MS = 2000;

/** Run id → its newest summary. @type {Signal<Record<string, Summary>>} */
const summaries = signal({});
/** Run id → the error of its last request. @type {Signal<Record<string, RequestError | null>>} */
const errors = signal({});

/** The newest known summary of an experiment. @type {(id: string) => Summary | null} */
export const summaryOf = (id) => summaries.value[id] ?? null;
export const summary = computed(() => summaries.value[chosenRun.value?.id ?? ""] ?? null);
export const summaryError = computed(() => errors.value[chosenRun.value?.id ?? ""] ?? null);

/** @param {string} id */
async function loadSummary(id) {
  try {
    setEntry(summaries, id, await getSummary(id));
    setEntry(errors, id, null);
  } catch (error) {
    setEntry(errors, id, /** @type {RequestError} */ (error));
    throw error;
  }
}

/** Request at most one summary of an experiment every two seconds, and that of another at once. */
export function followSummary() {
  const chosenId = computed(() => chosenRun.value?.id ?? "");
  effect(() => {
    const id = chosenId.value;
    return askForNewest({
      key: () => {
        const run = chosenRun.value;
        if (run?.id !== id || page.view.value !== "experiments" || connection.value !== "live") return "";
        return [id, run.state, summarised.value[id] ?? ""].join(" ");
      },
      ask: () => loadSummary(id),
      pause_ms: () => PAUSE_MS,
    });
  });
}

// ---- actions

const hasMistakes = () => Object.keys(mistakes.value).length > 0;

/** Without a number of trials while a field is not valid, by which it would be another. */
export function startLabel() {
  const { title } = chosenExperiment.value;
  return hasMistakes() ? `Run ${title}` : `Run ${title}: ${count(trials.value, "trial")}`;
}

export const canStart = () =>
  isOperator.value && !hasMistakes() && trials.value > 0;

/** How long the form's experiment takes; undefined while the server is asked, null where it is not known. */
export const experimentEstimate = computed(() => (answer.value === null ? null : answer.value.value));

/** @type {Signal<ReadonlySignal<Estimate | null | undefined> | null>} */
const answer = signal(null);

/** Ask for the estimate, where the server has any. */
export async function followEstimate() {
  if (!hasFeature("what_if")) return;
  const { makeAnswer } = await import("../what_if/estimate.js");
  answer.value = makeAnswer(computed(() => (page.view.value === "experiments" && options.value && canStart()
    ? { path: "experiments", body: requestBody() }
    : null)));
}

/** Start an experiment and choose it; its id, or null if it was refused. */
export const start = () =>
  attempt("experiment", async () => {
    const run = await requestRun(() => startExperiment(requestBody()));
    page.report.value = run.id;
    return run.id;
  });

/** @type {(run: Run, verb: Verb) => Promise<void | null>} */
export const command = (run, verb) =>
  attempt(run.id, async () => {
    await requestRun(() => api.command(run, verb));
  });

/** @param {Run} run */
export const deleteExperiment = async (run) => {
  await deleteRun(run);
  if (page.report.value === run.id) page.report.value = null;
};

// ---- announcements

export function announceExperiments() {
  /** @type {Run | null} */
  let before = null;
  effect(() => {
    const run = chosenRun.value;
    if (run && before?.id === run.id && isActive(before) && !isActive(run)) {
      announcement.value = `${runTitle(run)} is ${run.state}. ${run.error ?? ""}`;
    }
    before = run;
  });
}
