// The list of the Runs view: its filters and order, which are in the address, and the runs that it shows.
import { computed, signal } from "@preact/signals";
import { followQuery } from "./page.js";
import { folded, makeList, NO_FILTERS, orderOf } from "./runs.js";
import { everyRun } from "./selectors.js";
import { damagedRuns } from "./store.js";

/** @import { Signal } from "@preact/signals" */
/** @import { Filters } from "./runs.js" */
/** @import { DamagedRun, Run } from "./types.js" */

/** @type {Signal<Filters>} */
export const filters = signal(NO_FILTERS);
export const isFiltered = computed(() => {
  const { sort: _, ...chosen } = filters.value;
  return Object.values(chosen).some(Boolean);
});
/** @param {Partial<Filters>} changes */
export const setFilters = (changes) => (filters.value = { ...filters.value, ...changes });
export const clearFilters = () => (filters.value = { ...NO_FILTERS, sort: filters.value.sort });

export const runList = makeList(filters);

// ---- the address: `#runs?kind=race&tag=ice&sort=name`

/** Every filter that is in a query; the others are empty. @param {URLSearchParams} query */
export const readFilters = (query) => {
  const given = Object.keys(NO_FILTERS).flatMap((name) => (query.get(name) ? [[name, query.get(name)]] : []));
  filters.value = { ...NO_FILTERS, ...Object.fromEntries(given) };
};

export const filtersAsQuery = () => {
  const chosen = Object.entries(filters.value).filter(([name, value]) => value !== Reflect.get(NO_FILTERS, name));
  return new URLSearchParams(chosen).toString();
};

/** Load the list while the view is open, and keep its filters and the address the same. */
export function followRunList() {
  followQuery("runs", readFilters, filtersAsQuery);
  runList.follow("runs");
}

// ---- the runs to be shown

/**
 * A run whose kind cannot be read is listed under every kind.
 * @param {Run | DamagedRun} run
 */
const passes = (run) => {
  const { kind, state, search, tag } = filters.value;
  const { tags = [], notes = "" } = "damaged" in run ? {} : run;
  const isFound = [run.name ?? "", run.id, ...tags, notes].some((text) => folded(text).includes(folded(search)));
  const isTagged = tag === "" || tags.some((one) => folded(one) === folded(tag));
  return ["", run.kind ?? kind].includes(kind) && ["", run.state].includes(state) && isFound && isTagged;
};

/** Runs that the server has listed, and those that have begun since, in the order of the list. */
export const shownRuns = computed(() =>
  [...damagedRuns.value.values(), ...everyRun.value]
    .filter(passes)
    .filter(runList.includes)
    .sort(orderOf(filters.value.sort)),
);

/** The tags of the known runs, the most frequent first. */
export const knownTags = computed(() => {
  /** @type {Map<string, { tag: string, count: number }>} */
  const found = new Map();
  for (const tag of everyRun.value.flatMap(({ tags = [] }) => tags)) {
    const count = (found.get(folded(tag))?.count ?? 0) + 1;
    found.set(folded(tag), { tag, count });
  }
  return [...found.values()].sort((a, b) => b.count - a.count).map(({ tag }) => tag);
});
