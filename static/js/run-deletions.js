// Runs that are deleted, and restored.
import * as api from "./api.js";
import { attempt } from "./actions.js";
import { tellDeleted } from "./deletions.js";
import { count } from "./format.js";
import { markGone, requestRun } from "./store.js";

/** @import { DamagedRun, Run } from "./types.js" */

/**
 * Delete runs with one request, and offer to restore them. Returns the ids of those that are gone, and the reasons why
 * others stay.
 * @param {(Run | DamagedRun)[]} runs
 */
export async function deleteRuns(runs) {
  const answer = await api.deleteRuns(runs.map(({ id }) => id));
  const { deleted, kept } = answer;
  deleted.forEach(markGone);
  const [{ name, id }] = runs;
  tellDeleted("runs", answer, runs.length === 1 ? `“${name ?? id}”` : count(deleted.length, "run"), requestRun);
  return { deleted, reasons: kept.map(({ reason }) => reason) };
}

/** @param {Run | DamagedRun} run */
export const deleteRun = (run) =>
  attempt(run.id, async () => {
    const { reasons } = await deleteRuns([run]);
    if (reasons.length) throw new api.RequestError(`Not deleted: ${reasons[0]}.`);
  });
