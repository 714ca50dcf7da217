// The trials of the chosen experiment by setting and seed, and the runs that were made of them.
import { computed, signal } from "@preact/signals";
import { adopt, attempt } from "../actions.js";
import * as api from "../api.js";
import { isActive } from "../selectors.js";
import { requestRuns, runs, setEntry } from "../store.js";

/** @import { Signal } from "@preact/signals" */
/** @import { Run, Setting, Trial } from "../types.js" */

/** Run id → its trials, once they were requested. @type {Signal<Record<string, Trial[]>>} */
const trials = signal({});

/** The setting whose seeds are shown, and the one of them that was asked for. Empty before a choice. */
export const chosen = signal({ setting: "", distance_m: /** @type {number | null} */ (null) });
export const isOpen = signal(false);

/**
 * Show the seeds of a setting, and the one of a dot.
 * @param {Setting} setting
 * @param {number} distance_m of the dot
 */
export function showSeed({ key }, distance_m) {
  chosen.value = { setting: key, distance_m };
  isOpen.value = true;
  requestAnimationFrame(() => document.getElementById("seeds")?.scrollIntoView({ block: "nearest" }));
}

/** Request the trials that an experiment has done, and the runs that were made of them. @param {Run} experiment */
export const loadTrials = ({ id }) =>
  attempt("trials", async () => {
    const answer = await api.getTrials(id);
    setEntry(trials, id, answer.trials);
    await requestRuns(() => api.listRuns({ search: id }));
  });

/** Settings of which a single run repeats a trial: in blocks, none does. @param {Setting[]} settings */
export const repeatable = (settings) => settings.filter(({ blocks, n }) => blocks <= 1 && n > 0);

/** Note of the server on a run that it made of a trial. */
const NOTE = /Trial (.+#\d+) of experiment (\w+)\./;

/** Experiment and trial → the newest run that was made of it. */
const runsOfTrials = computed(() => {
  /** @type {Map<string, Run>} */
  const found = new Map();
  for (const run of runs.value.values()) {
    const [, key, id] = NOTE.exec(run.notes ?? "") ?? [];
    const place = `${id} ${key}`;
    if (key && run.id > (found.get(place)?.id ?? "")) found.set(place, run);
  }
  return found;
});

/**
 * The seeds of a setting: {key, number, distance_m, run}; null before the trials are known.
 * @param {string} id of the experiment
 * @param {string} setting
 */
export function seedsOf(id, setting) {
  const own = trials.value[id]?.filter(({ key }) => key.slice(0, key.lastIndexOf("#")) === setting);
  return own?.map(({ key, result }) => ({
    key,
    number: Number(key.slice(key.lastIndexOf("#") + 1)),
    distance_m: result?.distances_m?.at(-1) ?? null,
    run: runsOfTrials.value.get(`${id} ${key}`) ?? null,
  })).sort((a, b) => a.number - b.number) ?? null;
}

/** Run a trial here, and go to the stage, which shows it. @type {(experiment: Run, key: string) => unknown} */
export const runTrial = ({ id }, key) =>
  attempt("trials", async () => {
    await adopt(() => api.startTrial(id, key));
    location.hash = "";
  });

/** Whether a run can be replayed: it has ended and not failed. @param {Run | null} run */
export const hasReplay = (run) => run !== null && !isActive(run) && run.state !== "failed";
