// Runs that the page requests beside those of the snapshot: single ones by their ids, and lists by pages.
import { computed, effect, signal } from "@preact/signals";
import { getAnyRun, listRuns } from "./api.js";
import { page } from "./page-state.js";
import { playback } from "./player.js";
import { trainingIds } from "./selectors.js";
import { connection, damagedRuns, isGone, markGone, requestRun, requestRuns, runs } from "./store.js";
import { messageOf } from "./titles.js";

/** @import { ReadonlySignal } from "@preact/signals" */
/** @import { RequestError } from "./api.js" */
/** @import { DamagedRun, Run } from "./types.js" */

// ---- single runs

const RETRY_MS = 3000;
const NOT_FOUND = 404;

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
        markGone(id);
        return;
      }
      setTimeout(requestMissing, RETRY_MS);
    }
    requested.delete(id);
  };
  const isMissing = (/** @type {string} */ id) =>
    !runs.value.has(id) && !damagedRuns.value.has(id) && !isGone(id);
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
 * The runs on stage and of ghosts, with the trainings of its race and the race from which it branches off.
 * They may be older than those of the snapshot.
 */
export const stageIds = computed(() => {
  const all = [playback.value?.run_id, playback.value?.next_run_id, page.ghost.value];
  const shown = all.filter((id) => id !== null && id !== undefined);
  return shown.flatMap((id) => {
    const run = runs.value.get(id);
    return run?.kind === "race" ? [id, ...trainingIds(run), ...originalIds(run)] : [id];
  });
});

// ---- lists: filtered and searched by the server, a page at a time

/**
 * Filters of a list and its order; empty filters let every run pass. They may come from a link: the server says what
 * is not valid.
 * @typedef {{ kind: string, state: string, search: string, tag: string, sort: string }} Filters
 */

const SEARCH_PAUSE_MS = 250;

/** @type {Filters} */
export const NO_FILTERS = { kind: "", state: "", search: "", tag: "", sort: "newest" };

/** The server takes only the letters A to Z of upper and lower case for the same. @param {string} text */
export const folded = (text) => text.replaceAll(/[A-Z]/g, (letter) => letter.toLowerCase());

/**
 * The distance of a training, or of a race's winner by the paper clock [m]; null if there is none.
 * @param {Run | DamagedRun} run
 * @returns {number | null}
 */
export function distanceOf(run) {
  const { lanes, distance_m = null } = ("result" in run && run.result) || {};
  const winner = lanes?.find(({ clocks }) => clocks.paper.rank === 1);
  return winner ? winner.clocks.paper.finished_distance_m : distance_m;
}

/** @typedef {Run | DamagedRun} AnyRun */

/** @type {(a: string, b: string) => number} */
const byText = (a, b) => (a === b ? 0 : a < b ? -1 : 1);
/** Ids sort by the time of creation. @type {(a: AnyRun, b: AnyRun) => number} */
const newestFirst = (a, b) => byText(b.id, a.id);
/** Sort → the order of two runs, as the server's. @type {Record<string, (a: AnyRun, b: AnyRun) => number>} */
const ORDERS = {
  oldest: (a, b) => newestFirst(b, a),
  name: (a, b) => byText(folded(a.name ?? ""), folded(b.name ?? "")) || newestFirst(a, b),
  distance: (a, b) => (distanceOf(b) ?? -Infinity) - (distanceOf(a) ?? -Infinity) || newestFirst(a, b),
};
/** @param {string} sort */
export const orderOf = (sort) => ORDERS[sort] ?? newestFirst;

/**
 * The pages of a list that were loaded, of these filters.
 * @typedef {{ filters: Filters | null, ids: string[], cursor: string | null }} Pages
 */

/** @type {Pages} */
const NO_PAGES = { filters: null, ids: [], cursor: null };

/** The last run of these that was not deleted since. @param {string[]} ids */
const lastOf = (ids) =>
  ids.map((id) => runs.value.get(id) ?? damagedRuns.value.get(id)).findLast((run) => run !== undefined);

/**
 * A list of runs with these filters. `cursor` is null after the last page.
 * @param {ReadonlySignal<Filters>} filters
 */
export function makeList(filters) {
  const pages = signal(NO_PAGES);
  const isLoading = signal(false);
  /** Why the last page could not be loaded; empty where it could. */
  const error = signal("");
  /** Whether the first page of these filters is here. */
  const isListed = computed(() => pages.value.filters === filters.value);
  const hasMore = computed(() => isListed.value && pages.value.cursor !== null);
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

  const last = computed(() => lastOf(pages.value.ids));

  /** Whether a run is in the pages that were loaded, or comes before their end. @param {AnyRun} run */
  const includes = (run) => {
    const { ids, cursor } = pages.value;
    if (!isListed.value || cursor === null || ids.includes(run.id)) return true;
    return last.value !== undefined && orderOf(filters.value.sort)(run, last.value) < 0;
  };

  /** Load the first page as soon as the view is open, and again after a reconnection and for other filters. */
  const follow = (/** @type {string} */ view) => {
    const isOpen = computed(() => page.view.value === view);
    effect(() => {
      // The snapshot after a reconnection replaces all known runs.
      if (connection.value !== "live") pages.value = NO_PAGES;
    });
    effect(() => {
      if (!isOpen.value || connection.value !== "live" || isListed.value) return undefined;
      const timer = setTimeout(() => load(null), filters.value.search ? SEARCH_PAUSE_MS : 0);
      return () => clearTimeout(timer);
    });
  };

  /** Load the first page, or the next one: whichever is missing. */
  const loadMore = () => (isLoading.value ? undefined : load(isListed.value ? pages.value.cursor : null));

  return { isListed, isLoading, error, hasMore, includes, loadMore, follow };
}
