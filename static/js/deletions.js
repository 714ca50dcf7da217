// What this browser has deleted lately, and can restore for as long as the server keeps it.
import { computed } from "@preact/signals";
import { call } from "./api.js";
import { storedText, toast } from "./page.js";
import { makeRequests } from "./requests.js";
import { setEntry } from "./store.js";

/** @import { ReadonlySignal } from "@preact/signals" */
/** @import { Deleted, RequestError } from "./api.js" */

/**
 * What was deleted at once: the address of its list, such as "runs", the ids, what is said of it, and until when it can
 * be restored [ms since 1970].
 * @typedef {{ kind: string, ids: string[], words: string, until: number }} Deletion
 */
/**
 * Sends the request that restores something, and shows what the server answers.
 * @typedef {(send: () => Promise<any>) => Promise<unknown>} Take
 */

/** Kept over a reload of the page. */
const kept = storedText("deletions", "[]");
/** Older ones of a kind are not offered. */
const MOST = 5;
const NOT_FOUND = 404;
const { busy, failures, perform } = makeRequests();
/** Whether something of a kind is being restored, and why it was not, by kind. */
export { busy as restoring, failures as refusals };

/** @returns {Deletion[]} */
function read() {
  try {
    const all = JSON.parse(kept.value);
    return Array.isArray(all)
      ? all.filter(({ kind, ids, words, until }) => kind && Array.isArray(ids) && words && until > 0) : [];
  } catch {
    return [];
  }
}

/** What can be restored, the newest first. @type {ReadonlySignal<Deletion[]>} */
export const deletions = computed(() => read().filter(({ until }) => until > Date.now()));

/** @param {Deletion[]} all */
const keep = (all) => {
  const newer = (/** @type {string} */ kind, /** @type {number} */ n) =>
    all.slice(0, n).filter((deletion) => deletion.kind === kind).length;
  kept.value = JSON.stringify(all.filter(({ kind }, n) => newer(kind, n) < MOST));
};

/** Forget that something was deleted: it is restored, or wanted no more. @param {Deletion} deletion */
export const forgetDeletion = (deletion) =>
  keep(deletions.value.filter(({ kind, ids }) => kind !== deletion.kind || ids.join() !== deletion.ids.join()));

/**
 * Tell that things were deleted, and offer to restore them: in the message, if it can be pressed, and in their list.
 * @param {string} kind the address of their list
 * @param {Deleted} answer
 * @param {string} words
 * @param {Take | null} take null where a dialog is above the message
 */
export function tellDeleted(kind, { deleted, restorable_until }, words, take) {
  setEntry(failures, kind, "");
  if (!deleted.length) return;
  if (!restorable_until) {
    toast(`Deleted ${words} for good: the disk is full.`);
    return;
  }
  const deletion = { kind, ids: deleted, words, until: Date.parse(restorable_until) };
  keep([deletion, ...deletions.value]);
  if (!take) return;
  const run = async () => {
    if (!(await restore(deletion, take))) toast(failures.value[kind]);
  };
  toast(`Deleted ${words}.`, { label: "Undo", run });
}

/**
 * Bring back what was deleted; whether it is back. What is gone for good is offered no more.
 * @param {Deletion} deletion
 * @param {Take} take
 */
export const restore = (deletion, take) =>
  perform(deletion.kind, async () => {
    const { kind, ids, words } = deletion;
    try {
      for (const id of ids) await take(() => call("POST", `${kind}/${encodeURIComponent(id)}/restore`));
    } catch (error) {
      if (/** @type {RequestError} */ (error).status === NOT_FOUND) forgetDeletion(deletion);
      throw error;
    }
    forgetDeletion(deletion);
    toast(`Restored ${words}.`);
  });
