// The trials of the chosen experiment by setting and seed, and the runs that were made of them.
import { computed, effect, signal } from "@preact/signals";
import { adopt, attempt } from "../../js/actions.js";
import * as api from "../../js/api.js";
import { isLasting } from "../../js/api.js";
import { changeIfStillHere } from "../../js/page-state.js";
import { isActive } from "../../js/selectors.js";
import { connection, requestRuns, runs } from "../../js/store.js";
import { fieldsInWords, messageOf, variedFields } from "../../js/titles.js";
import { getTrials, startTrial } from "./api.js";

/** @import { Signal } from "@preact/signals" */
/** @import { RequestError } from "../../js/api.js" */
/** @import { Page, Run, Setting, Summary, Trial } from "../../js/types.js" */

/** The trials of an experiment by setting, as far as they were requested. */
/** @type {Signal<{ id: string, trials: Map<string, Trial[]> } | null>} */
const newest = signal(null);
/** The error of the last request. @type {Signal<{ id: string, error: RequestError } | null>} */
const failure = signal(null);

/** Why the trials of an experiment, or their runs, cannot be had; null where they can. @param {string} id */
export const problemOf = (id) => (failure.value?.id === id ? messageOf(failure.value.error) : null);

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

// ---- the trials and their runs, requested while the section is open

/** All trials are one answer, which may be large: of an experiment that runs it is requested now and then. */
const PAUSE_MS = 10_000;

/**
 * Keep the trials of an experiment, and the runs that were made of them, until the function that is returned is called.
 * @param {() => Run | null} experiment
 */
export function followTrials(experiment) {
  let [isBusy, isResting, isOver] = [false, false, false];
  /** Experiment and progress whose trials were loaded. */
  let loaded = "";
  /** The experiment whose runs were loaded; events tell of later ones. */
  let listed = "";

  const wanted = computed(() => {
    const run = experiment();
    return run && connection.value === "live" ? [run.id, isActive(run) ? run.progress.done : "ended"].join(" ") : "";
  });

  const load = async () => {
    const now = wanted.peek();
    const [id, progress] = now.split(" ");
    const isUrgent = progress === "ended" || !loaded.startsWith(`${id} `);
    if (!now || now === loaded || isBusy || isOver || (isResting && !isUrgent)) return;
    isBusy = true;
    try {
      const answer = await getTrials(id);
      newest.value = { id, trials: bySetting(answer.trials) };
      if (listed !== id) await requestEveryRun(`of experiment ${id}`);
      [loaded, listed] = [now, id];
      failure.value = null;
    } catch (error) {
      failure.value = { id, error: /** @type {RequestError} */ (error) };
      loaded = isLasting(failure.value.error) ? now : `${id} `;
    }
    [isBusy, isResting] = [false, true];
    clearTimeout(timer);
    timer = setTimeout(rest, PAUSE_MS);
    if (wanted.peek() !== now) load();
  };
  /** @type {ReturnType<typeof setTimeout> | undefined} */
  let timer;
  const rest = () => {
    isResting = false;
    load();
  };

  const stops = [
    effect(() => {
      // The snapshot after a reconnection has the newest runs only.
      if (connection.value !== "live") [loaded, listed] = ["", ""];
    }),
    effect(() => {
      if (wanted.value) load();
    }),
  ];
  return () => {
    isOver = true;
    clearTimeout(timer);
    stops.forEach((stop) => stop());
  };
}

/** Take in all runs that a search finds, page by page. @param {string} search */
async function requestEveryRun(search) {
  /** @type {string | null} */
  let cursor = null;
  do {
    const query = { search, cursor };
    /** @type {Page<Run>} */
    const page = await requestRuns(() => api.listRuns(query));
    cursor = page.next_cursor;
  } while (cursor);
}

/** @type {(trials: Trial[]) => Map<string, Trial[]>} */
function bySetting(trials) {
  /** @type {Map<string, Trial[]>} */
  const trialsOf = new Map();
  for (const trial of trials) {
    const setting = trial.key.slice(0, trial.key.lastIndexOf("#"));
    const list = trialsOf.get(setting) ?? [];
    list.push(trial);
    trialsOf.set(setting, list);
  }
  return trialsOf;
}

// ---- what is shown of them

/**
 * Settings of which a single run repeats a trial (of a practice in blocks none does), with the model of a search.
 * @param {Summary} summary
 * @returns {Setting[]}
 */
export function repeatable({ settings, worlds = [] }) {
  const models = new Map(worlds.map(({ key, plans_with }) => [key, plans_with]));
  return settings.filter(({ blocks, n }) => blocks <= 1 && n > 0)
    .map((one) => ({ ...one, plans_with: models.get(one.key) ?? null }));
}

/** Fields in which settings may differ, in the order in which a name tells them. */
const NAMED_FIELDS = ["plans_with", "gait", "observation", "robot", "world"];

/**
 * The names of settings: the agent, and the other fields in which they differ: "Q-learning, 500 steps".
 * @param {Setting[]} settings
 * @param {string[]} parameters
 * @returns {Map<string, string>} key → name
 */
export function namesOf(settings, parameters) {
  const varied = variedFields(settings, [...NAMED_FIELDS, ...parameters]);
  return new Map(settings.map((setting) => [setting.key, fieldsInWords(setting, ["agent", ...varied])]));
}

/** Note of the server on a run that it made of a trial. */
const NOTE = /Trial (.+#\d+) of experiment (\w+)\./;

/** Experiment and trial → the newest run that was made of it. */
const runsOfTrials = computed(() => {
  /** @type {Map<string, Run>} */
  const newestRuns = new Map();
  for (const run of runs.value.values()) {
    const [, key, id] = NOTE.exec(run.notes ?? "") ?? [];
    const place = `${id} ${key}`;
    if (key && run.id > (newestRuns.get(place)?.id ?? "")) newestRuns.set(place, run);
  }
  return newestRuns;
});

/**
 * The seeds of a setting: {key, number, distance_m, run}; null before the trials are known.
 * @param {string} id of the experiment
 * @param {string} setting
 */
export function seedsOf(id, setting) {
  if (newest.value?.id !== id) return null;
  const trials = newest.value.trials.get(setting) ?? [];
  return trials.map(({ key, result }) => ({
    key,
    number: Number(key.slice(key.lastIndexOf("#") + 1)),
    distance_m: result?.distances_m?.at(-1) ?? null,
    run: runsOfTrials.value.get(`${id} ${key}`) ?? null,
  })).sort((a, b) => a.number - b.number);
}

/** Run a trial here, and go to the stage, which shows it. @type {(experiment: Run, key: string) => unknown} */
export const runTrial = ({ id }, key) =>
  attempt("trials", async () => {
    const go = changeIfStillHere();
    await adopt(() => startTrial(id, key));
    go({ view: "race" });
  });

/** Whether a run can be replayed: it has ended and not failed. @param {Run | null} run */
export const hasReplay = (run) => run !== null && !isActive(run) && run.state !== "failed";
