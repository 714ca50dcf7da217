// Runs that this browser has deleted lately, which can be restored for as long as the server keeps them.
import { computed } from "@preact/signals";
import * as api from "./api.js";
import { attempt } from "./actions.js";
import { count } from "./format.js";
import { storedText, toast } from "./page.js";
import { markGone, requestRun } from "./store.js";
import { messageOf } from "./titles.js";

/** @import { ReadonlySignal } from "@preact/signals" */
/** @import { RequestError } from "./api.js" */
/** @import { DamagedRun, Run } from "./types.js" */

/**
 * What was deleted at once: the ids, what is said of them, and until when they can be restored [ms since 1970].
 * @typedef {{ ids: string[], words: string, until: number }} Deletion
 */

/** Kept over a reload of the page. */
const kept = storedText("deletions", "[]");
/** Older ones are not offered. */
const MOST = 5;
const NOT_FOUND = 404;

/** @returns {Deletion[]} */
function read() {
  try {
    const all = JSON.parse(kept.value);
    return Array.isArray(all) ? all.filter(({ ids, words, until }) => Array.isArray(ids) && words && until > 0) : [];
  } catch {
    return [];
  }
}

/** What can be restored, the newest first. @type {ReadonlySignal<Deletion[]>} */
export const deletions = computed(() => read().filter(({ until }) => until > Date.now()));

/** @param {Deletion[]} all */
const keep = (all) => { kept.value = JSON.stringify(all.slice(0, MOST)); };

/** Forget that something was deleted: it is restored, or wanted no more. @param {Deletion} deletion */
export const forgetDeletion = (deletion) =>
  keep(deletions.value.filter(({ ids }) => ids.join() !== deletion.ids.join()));

/**
 * Delete runs with one request, and offer to restore them. Returns the ids of those that are gone, and the reasons why
 * others stay.
 * @param {(Run | DamagedRun)[]} runs
 */
export async function deleteRuns(runs) {
  const { deleted, kept: refused, restorable_until } = await api.deleteRuns(runs.map(({ id }) => id));
  deleted.forEach(markGone);
  const [{ name, id }] = runs;
  const words = runs.length === 1 ? `“${name ?? id}”` : count(deleted.length, "run");
  if (deleted.length && restorable_until) {
    const deletion = { ids: deleted, words, until: Date.parse(restorable_until) };
    keep([deletion, ...deletions.value]);
    toast(`Deleted ${words}.`, { label: "Undo", run: () => restore(deletion) });
  } else if (deleted.length) toast(`Deleted ${words} for good: the disk is full.`);
  return { deleted, reasons: refused.map(({ reason }) => reason) };
}

/** @param {Run | DamagedRun} run */
export const deleteRun = (run) =>
  attempt(run.id, async () => {
    const { reasons } = await deleteRuns([run]);
    if (reasons.length) throw new api.RequestError(`Not deleted: ${reasons[0]}.`);
  });

/** Bring back what was deleted. What cannot be is told, and offered no more. @param {Deletion} deletion */
export const restore = (deletion) =>
  attempt("restore", async () => {
    try {
      for (const id of deletion.ids) await requestRun(() => api.restoreRun(id));
    } catch (error) {
      if (/** @type {RequestError} */ (error).status === NOT_FOUND) forgetDeletion(deletion);
      toast(messageOf(/** @type {RequestError} */ (error)));
      throw error;
    }
    forgetDeletion(deletion);
    toast(`Restored ${deletion.words}.`);
  });
