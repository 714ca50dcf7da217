// The summary of the chosen experiment, requested again as its trials end.
import { computed, effect, signal } from "@preact/signals";
import { getSummary } from "../api.js";
import { place } from "../page.js";
import { connection, setEntry, summarised } from "../store.js";
import { chosenRun } from "./selection.js";

/** @import { Signal } from "@preact/signals" */
/** @import { RequestError } from "../api.js" */
/** @import { Summary } from "../types.js" */

const PAUSE_MS = 2000;

/** Run id → its newest summary. @type {Signal<Record<string, Summary>>} */
const summaries = signal({});
/** Run id → the error of its last request. @type {Signal<Record<string, RequestError | null>>} */
const errors = signal({});

export const summary = computed(() => summaries.value[chosenRun.value?.id ?? ""] ?? null);
export const summaryError = computed(() => errors.value[chosenRun.value?.id ?? ""] ?? null);

/** Lists of a config that are no parameters of a setting. */
const PLACES = ["agents", "gaits", "observations", "robots"];

/**
 * A summary with the names of its parameters, which earlier versions left out.
 * @param {Summary} stored
 * @returns {Summary}
 */
function withParameters(stored) {
  const lists = Object.entries(stored.config).filter(([, value]) => Array.isArray(value));
  const names = lists.map(([name]) => name).filter((name) => !PLACES.includes(name));
  return { ...stored, parameters: stored.parameters ?? names };
}

/** @param {string} id */
async function load(id) {
  try {
    setEntry(summaries, id, withParameters(await getSummary(id)));
    setEntry(errors, id, null);
  } catch (error) {
    setEntry(errors, id, /** @type {RequestError} */ (error));
  }
}

/** Request at most one summary every two seconds, and one more for changes in between. */
export function followSummary() {
  const wanted = computed(() => {
    const run = chosenRun.value;
    if (!run || place.value !== "experiments" || connection.value !== "live") return "";
    return [run.id, run.state, summarised.value[run.id] ?? ""].join(" ");
  });
  let isBusy = false;
  let hasMissed = false;
  let last = "";

  const next = async () => {
    const [id] = wanted.peek().split(" ");
    if (!id) return;
    if (isBusy && id === last) {
      hasMissed = true;
      return;
    }
    isBusy = true;
    hasMissed = false;
    last = id;
    await load(id);
    setTimeout(() => {
      isBusy = false;
      if (hasMissed) next();
    }, PAUSE_MS);
  };
  effect(() => {
    if (wanted.value) next();
  });
}
