// The experiments that there are, newest first, and the one that the report is about.
import { computed, effect, signal } from "@preact/signals";
import { getRun, listRuns } from "../api.js";
import { place } from "../page.js";
import { everyRun, isActive } from "../selectors.js";
import { connection, keepRun, runs } from "../store.js";
import { wantedRun } from "./address.js";

export const experimentRuns = computed(() => everyRun.value.filter(({ kind }) => kind === "experiment"));

/** The one that was asked for, else what runs, else the newest. */
export const chosenRun = computed(() => {
  const all = experimentRuns.value;
  if (wantedRun.value) return all.find(({ id }) => id === wantedRun.value) ?? null;
  return all.find(isActive) ?? all[0] ?? null;
});

/** Whether the server has said which experiments there are. */
export const isListed = signal(false);
/** Where older ones are, if there are more. */
const cursor = signal(null);
export const hasOlder = computed(() => cursor.value !== null);

async function load(from) {
  const answer = await listRuns("experiment", from).catch(() => null);
  if (!answer) return;
  answer.items.forEach(keepRun);
  cursor.value = answer.next_cursor ?? null;
  isListed.value = true;
}

export const loadOlder = () => load(cursor.value);

/** Trainings and races may have pushed them out of what the page is told at first. */
export function followExperiments() {
  const isOpen = computed(() => place.value === "experiments" && connection.value === "live");
  effect(() => {
    if (isOpen.value) load();
  });
  const unknown = computed(() => (isOpen.value && wantedRun.value && !runs.value.has(wantedRun.value) ? wantedRun.value : null));
  effect(() => {
    if (unknown.value) getRun({ kind: "experiment", id: unknown.value }).then(keepRun, () => (wantedRun.value = null));
  });
}
