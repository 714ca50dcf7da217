// The runs of the list that are selected, and what is done with all of them.
import { computed } from "@preact/signals";
import { attempt } from "./actions.js";
import * as api from "./api.js";
import { deleteRuns } from "./run-deletions.js";
import { listed } from "./format.js";
import { page } from "./page-state.js";
import { listedRuns } from "./run-list.js";
import { isActive } from "./selectors.js";
import { requestRun, served } from "./store.js";

/** @import { DamagedRun, Run } from "./types.js" */

/** @typedef {Run | DamagedRun} AnyRun */

const ids = computed(() => new Set(page.selected.value));
/** The run from which a range is selected: the one that was clicked last. @type {string | null} */
let anchor = null;

/** The selected runs that the list shows: nothing is done with one that nobody sees. */
export const selected = computed(() => listedRuns.value.filter(({ id }) => ids.value.has(id)));
/** @param {string} id */
export const isSelected = (id) => ids.value.has(id);

/** @param {Iterable<string>} chosen */
const select = (chosen) => (page.selected.value = [...new Set(chosen)]);
export const clearSelection = () => select([]);
export const selectAll = () => select(listedRuns.value.map(({ id }) => id));

/**
 * Select a run, or no longer; with `isRange` all from the one before to it.
 * @param {string} id
 * @param {boolean} isOn
 * @param {boolean} [isRange]
 */
export function setSelected(id, isOn, isRange = false) {
  const shown = listedRuns.value.map((run) => run.id);
  const from = isRange && anchor !== null ? shown.indexOf(anchor) : -1;
  const to = shown.indexOf(id);
  const range = from < 0 ? [id] : shown.slice(Math.min(from, to), Math.max(from, to) + 1);
  const left = [...ids.value].filter((other) => !range.includes(other));
  select(isOn ? [...left, ...range] : left);
  anchor = id;
}

/** Those that can be deleted: they have ended, or are damaged. */
export const deletable = computed(() => selected.value.filter((run) => "damaged" in run || !isActive(run)));

/** Delete the selected runs; those that are kept stay selected, and the reasons are told. */
export const deleteSelected = () =>
  attempt("selection", async () => {
    const reasons = [];
    const all = deletable.value;
    const [, most] = served().limits.run_ids;
    for (let at = 0; at < all.length; at += most ?? all.length) {
      const { deleted, reasons: more } = await deleteRuns(all.slice(at, at + (most ?? all.length)));
      select([...ids.value].filter((id) => !deleted.includes(id)));
      reasons.push(...more);
    }
    if (reasons.length) throw new api.RequestError(`Not deleted: ${listed(reasons)}.`);
  });

/** Add a tag to all selected runs. @param {string} tag */
export const tagSelected = (tag) =>
  attempt("selection", async () => {
    for (const run of selected.value) {
      if (!("damaged" in run)) {
        await requestRun(() => api.annotateRun(run.id, { tags: [...run.tags ?? [], tag] }));
      }
    }
    return true;
  });
