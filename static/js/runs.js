// Runs that the page requests beside those of the snapshot: single ones by their ids, and lists by pages.
import { computed, effect, signal } from "@preact/signals";
import { getAnyRun, listRuns } from "./api.js";
import { place } from "./page.js";
import { everyRun, trainingIds } from "./selectors.js";
import { connection, damagedRuns, isDeleted, requestRun, requestRuns, runs, stage } from "./store.js";
import { messageOf } from "./titles.js";

/** @import { ReadonlySignal, Signal } from "@preact/signals" */
/** @import { RequestError } from "./api.js" */
/** @import { DamagedRun, Kind, Run, State } from "./types.js" */

// ---- single runs

const RETRY_MS = 3000;
const NOT_FOUND = 404;

/** Ids that the server has said to be of no run. @type {Signal<Set<string>>} */
export const absentIds = signal(new Set());

/**
 * Request each run that is not known, until it is, or the server says that there is none.
 * @param {ReadonlySignal<string[]>} ids
 */
export function followRuns(ids) {
  /** @type {Set<string>} */
  const requested = new Set();
  const request = async (/** @type {string} */ id) => {
    requested.add(id);
    try {
      await requestRun(() => getAnyRun(id));
    } catch (error) {
      if (/** @type {RequestError} */ (error).status === NOT_FOUND) {
        absentIds.value = new Set([...absentIds.value, id]);
        return;
      }
      setTimeout(requestMissing, RETRY_MS);
    }
    requested.delete(id);
  };
  const isMissing = (/** @type {string} */ id) =>
    !runs.value.has(id) && !damagedRuns.value.has(id) && !absentIds.value.has(id) && !isDeleted(id);
  function requestMissing() {
    if (connection.value !== "live") return;
    for (const id of ids.value.filter(isMissing)) {
      if (!requested.has(id)) request(id);
    }
  }
  effect(requestMissing);
}

/** The race from which one branches off, if any. @type {(race: Run) => string[]} */
const originalIds = ({ config: { branch_from: branch } }) => (branch ? [branch.race_id] : []);

/**
 * The runs on stage, with the trainings of its race and the race from which it branches off.
 * They may be older than those of the snapshot.
 */
export const stageIds = computed(() => {
  const shown = [stage.value?.run_id, stage.value?.next_run_id].filter((id) => id !== null && id !== undefined);
  return shown.flatMap((id) => {
    const run = runs.value.get(id);
    return run?.kind === "race" ? [id, ...trainingIds(run), ...originalIds(run)] : [id];
  });
});

// ---- lists: filtered and searched by the server, a page at a time

/**
 * Filters of a list; empty ones let every run pass.
 * @typedef {{ kind: Kind | "", state: State | "", search: string }} Filters
 */

const SEARCH_PAUSE_MS = 250;

/** @type {Filters} */
const NO_FILTERS = { kind: "", state: "", search: "" };

/**
 * A list of runs with these filters. `cursor` is null after the last page.
 * @param {ReadonlySignal<Filters>} filters
 */
export function makeList(filters) {
  /** @type {Signal<{ filters: Filters | null, ids: string[], cursor: string | null }>} */
  const pages = signal({ filters: null, ids: [], cursor: null });
  const isLoading = signal(false);
  /** Why the last page could not be loaded; empty where it could. */
  const error = signal("");
  /** Whether the first page of these filters is here. */
  const isListed = computed(() => pages.value.filters === filters.value);
  const hasOlder = computed(() => isListed.value && pages.value.cursor !== null);
  /** Number of the newest request; the answers of earlier ones are of other filters. */
  let newest = 0;

  /** @param {string | null} cursor null for the first page */
  const load = async (cursor) => {
    newest += 1;
    const number = newest;
    const wanted = filters.value;
    isLoading.value = true;
    error.value = "";
    try {
      const { items, next_cursor } = await requestRuns(() => listRuns({ ...wanted, cursor }));
      if (number !== newest) return;
      const before = cursor ? pages.value.ids : [];
      pages.value = { filters: wanted, ids: [...before, ...items.map(({ id }) => id)], cursor: next_cursor };
    } catch (failure) {
      if (number === newest) error.value = messageOf(/** @type {RequestError} */ (failure));
    } finally {
      if (number === newest) isLoading.value = false;
    }
  };

  /** Whether a run is in the pages that were loaded, or newer. @param {{ id: string }} run */
  const includes = ({ id }) => {
    const { ids, cursor } = pages.value;
    return !isListed.value || cursor === null || ids.includes(id) || id > (ids.at(-1) ?? "");
  };

  return {
    isListed, isLoading, error, hasOlder, includes,
    /** Load the first page, or the next one: whichever is missing. */
    loadMore: () => (isLoading.value ? undefined : load(isListed.value ? pages.value.cursor : null)),
    /** Load the first page as soon as the view is open, and again after a reconnection and for other filters. */
    follow(/** @type {string} */ view) {
      const isOpen = computed(() => place.value === view);
      effect(() => {
        // The snapshot after a reconnection replaces all known runs.
        if (connection.value !== "live") pages.value = { filters: null, ids: [], cursor: null };
      });
      effect(() => {
        if (!isOpen.value || connection.value !== "live" || isListed.value) return undefined;
        const timer = setTimeout(() => load(null), filters.value.search ? SEARCH_PAUSE_MS : 0);
        return () => clearTimeout(timer);
      });
    },
  };
}

// ---- the list of the Runs view

/** @type {Signal<Filters>} */
export const filters = signal(NO_FILTERS);
export const isFiltered = computed(() => Object.values(filters.value).some(Boolean));
export const clearFilters = () => (filters.value = NO_FILTERS);

export const runList = makeList(filters);

/** The server matches only the letters A to Z in upper and lower case. @param {string} text */
const folded = (text) => text.replaceAll(/[A-Z]/g, (letter) => letter.toLowerCase());

/**
 * A run whose kind cannot be read is listed under every kind.
 * @param {Run | DamagedRun} run
 */
const passes = (run) => {
  const { kind, state, search } = filters.value;
  const isFound = [run.name ?? "", run.id].some((text) => folded(text).includes(folded(search)));
  return ["", run.kind ?? kind].includes(kind) && ["", run.state].includes(state) && isFound;
};

/** The runs to be shown, newest first: what the server has listed, and what has begun since. */
export const shownRuns = computed(() =>
  [...damagedRuns.value.values(), ...everyRun.value].filter(passes).filter(runList.includes),
);
