// Runs that the page requests beside those of the snapshot: those on stage, and the list with its filters.
import { computed, effect, signal } from "@preact/signals";
import { getAnyRun, listRuns } from "./api.js";
import { place } from "./page.js";
import { everyRun, trainingIds } from "./selectors.js";
import { connection, damagedRuns, isDeleted, requestRun, requestRuns, runs, stage } from "./store.js";

/** @import { Signal } from "@preact/signals" */
/** @import { RequestError } from "./api.js" */
/** @import { DamagedRun, Kind, Run, State } from "./types.js" */

// ---- the runs on stage, with the trainings of its race: they may be older than those of the snapshot

const stageIds = computed(() => {
  const shown = [stage.value?.run_id, stage.value?.next_run_id].filter((id) => id !== null && id !== undefined);
  return shown.flatMap((id) => {
    const run = runs.value.get(id);
    return run?.kind === "race" ? [id, ...trainingIds(run)] : [id];
  });
});

/** Request each run on stage that is not known, once per connection: it may have been deleted. */
export function followStageRuns() {
  /** @type {Set<string>} */
  const requested = new Set();
  effect(() => {
    if (connection.value !== "live") {
      requested.clear();
      return;
    }
    const isMissing = (/** @type {string} */ id) =>
      !runs.value.has(id) && !damagedRuns.value.has(id) && !isDeleted(id) && !requested.has(id);
    for (const id of stageIds.value.filter(isMissing)) {
      requested.add(id);
      requestRun(() => getAnyRun(id)).catch(() => null);
    }
  });
}

// ---- the list: filtered and searched by the server, a page at a time

const SEARCH_PAUSE_MS = 250;

/** An empty filter lets every run pass. @typedef {{ kind: Kind | "", state: State | "", search: string }} Filters */

/** @type {Filters} */
const NO_FILTERS = { kind: "", state: "", search: "" };
/** @type {Signal<Filters>} */
export const filters = signal(NO_FILTERS);
export const isFiltered = computed(() => Object.values(filters.value).some(Boolean));
export const clearFilters = () => (filters.value = NO_FILTERS);

/** What the server has listed for these filters. `cursor` is null after the last page, empty before the first. */
/** @type {Signal<{ filters: Filters, ids: Set<string>, cursor: string | null }>} */
const listed = signal({ filters: NO_FILTERS, ids: new Set(), cursor: "" });
export const isLoading = signal(false);
/** Why the list could not be loaded; empty where it could. */
export const listError = signal("");

const isListed = computed(() => listed.value.filters === filters.value && listed.value.cursor !== "");
export const hasOlder = computed(() => isListed.value && listed.value.cursor !== null);

/** @param {Run | DamagedRun} run */
const passes = (run) => {
  const { kind, state, search } = filters.value;
  const text = `${run.name ?? ""} ${run.id}`.toLowerCase();
  return [run.kind, null, ""].includes(kind) && ["", run.state].includes(state) && text.includes(search.toLowerCase());
};

/** The runs to be shown, newest first: what the server has listed, and what has begun since. */
export const shownRuns = computed(() => {
  const { ids, cursor } = listed.value;
  const oldest = [...ids].at(-1) ?? "";
  const isInPages = (/** @type {Run | DamagedRun} */ { id }) =>
    !isListed.value || cursor === null || ids.has(id) || id > oldest;
  return [...damagedRuns.value.values(), ...everyRun.value].filter(passes).filter(isInPages);
});

/** Number of the newest request; the answers of earlier ones are of other filters. */
let newest = 0;

/** @param {string | null} cursor */
async function load(cursor) {
  newest += 1;
  const number = newest;
  const wanted = filters.value;
  const before = listed.value.filters === wanted ? listed.value.ids : new Set();
  isLoading.value = true;
  listError.value = "";
  try {
    const { items, next_cursor } = await requestRuns(() => listRuns({ ...wanted, cursor }));
    if (number !== newest) return;
    listed.value = { filters: wanted, ids: new Set([...before, ...items.map(({ id }) => id)]), cursor: next_cursor };
  } catch (error) {
    if (number === newest) listError.value = /** @type {RequestError} */ (error).message;
  } finally {
    if (number === newest) isLoading.value = false;
  }
}

export const reload = () => load(null);

/** Load the next page, unless one is being loaded. */
export const loadOlder = () => {
  if (!isLoading.value) load(listed.value.cursor);
};

/** Load the list while it is open, again after a reconnection and when the filters change. */
export function followList() {
  const isOpen = computed(() => place.value === "runs" && connection.value === "live");
  effect(() => {
    const { search } = filters.value;
    if (!isOpen.value) return undefined;
    const timer = setTimeout(reload, search ? SEARCH_PAUSE_MS : 0);
    return () => clearTimeout(timer);
  });
}
