// The known experiments, newest first, and the one whose report is shown.
import { computed, effect, signal } from "@preact/signals";
import { getRun, listRuns } from "../api.js";
import { place } from "../page.js";
import { everyRun, isActive } from "../selectors.js";
import { connection, isDeleted, requestRun, requestRuns, runs } from "../store.js";
import { wantedRun } from "./address.js";

/** @import { Signal } from "@preact/signals" */

export const experimentRuns = computed(() => everyRun.value.filter(({ kind }) => kind === "experiment"));

/** The requested one, else the active one, else the newest. */
export const chosenRun = computed(() => {
  const all = experimentRuns.value;
  if (wantedRun.value) return all.find(({ id }) => id === wantedRun.value) ?? null;
  return all.find(isActive) ?? all[0] ?? null;
});

/** Whether the server has listed its experiments. */
export const isListed = signal(false);
/** Where older ones continue, null after the last. @type {Signal<string | null>} */
const cursor = signal(null);
export const hasOlder = computed(() => cursor.value !== null);

/** @param {string | null} [from] */
async function load(from) {
  const answer = await requestRuns(() => listRuns("experiment", from)).catch(() => null);
  if (!answer) return;
  cursor.value = answer.next_cursor ?? null;
  isListed.value = true;
}

export const loadOlder = () => load(cursor.value);

/** List experiments when the view opens: the first snapshot may have had room for trainings and races only. */
export function followExperiments() {
  const isOpen = computed(() => place.value === "experiments" && connection.value === "live");
  effect(() => {
    if (isOpen.value) load();
  });
  const unknown = computed(() => {
    const id = wantedRun.value;
    return isOpen.value && id && !runs.value.has(id) ? id : null;
  });
  effect(() => {
    const id = unknown.value;
    if (!id) return;
    if (isDeleted(id)) {
      wantedRun.value = null;
      return;
    }
    requestRun(() => getRun({ kind: "experiment", id })).catch(() => (wantedRun.value = null));
  });
}
