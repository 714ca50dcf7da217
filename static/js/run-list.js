// The list of the Runs view: its filters, order and groups, which are in the address, and the runs that it shows.
import { computed } from "@preact/signals";
import { GROUPINGS, page } from "./page-state.js";
import { storedText } from "./page.js";
import { groupRuns } from "./run-groups.js";
import { folded, makeList, NO_FILTERS, orderOf } from "./runs.js";
import { everyRun } from "./selectors.js";
import { damagedRuns } from "./store.js";

/** @import { ReadonlySignal } from "@preact/signals" */
/** @import { Filters } from "./runs.js" */
/** @import { DamagedRun, Run } from "./types.js" */

/** Those of the address, `#runs?kind=race&tag=ice&sort=name`; the others are empty. @type {ReadonlySignal<Filters>} */
export const filters = computed(() => {
  const set = Object.keys(NO_FILTERS).map((name) => [name, page.list.value.get(name)]).filter(([, value]) => value);
  return { ...NO_FILTERS, ...Object.fromEntries(set) };
});
export const isFiltered = computed(() => {
  const { sort: _, ...chosen } = filters.value;
  return Object.values(chosen).some(Boolean);
});
/** @param {Partial<Filters>} changes */
export const setFilters = (changes) => {
  const chosen = Object.entries({ ...filters.value, ...changes });
  page.list.value = new URLSearchParams(chosen.filter(([name, value]) => value !== Reflect.get(NO_FILTERS, name)));
};
export const clearFilters = () => setFilters({ ...NO_FILTERS, sort: filters.value.sort });

export const runList = makeList(filters);

/** Load the list while the view is open. */
export const followRunList = () => runList.follow("runs");

// ---- the runs to be shown

/**
 * A run whose kind cannot be read is listed under every kind.
 * @param {Run | DamagedRun} run
 */
const passes = (run) => {
  const { kind, state, search, tag } = filters.value;
  const { tags = [], notes = "" } = "damaged" in run ? {} : run;
  const isFound = [run.name ?? "", run.id, ...tags, notes].some((text) => folded(text).includes(folded(search)));
  const isTagged = tag === "" || tags.some((other) => folded(other) === folded(tag));
  return ["", run.kind ?? kind].includes(kind) && ["", run.state].includes(state) && isFound && isTagged;
};

/** Runs that the server has listed, and those that have begun since, in the order of the list. */
export const shownRuns = computed(() =>
  [...damagedRuns.value.values(), ...everyRun.value]
    .filter(passes)
    .filter((run) => runList.includes(run) || page.selected.value.includes(run.id))
    .sort(orderOf(filters.value.sort)),
);

// ---- their groups

const keptGrouping = storedText("grouping", GROUPINGS[0]);

/** How the list is grouped: as the link says, or as this browser has kept it. */
export const grouping = computed(() =>
  page.grouping.value ?? (GROUPINGS.includes(keptGrouping.value) ? keptGrouping.value : GROUPINGS[0]));

/** Choose how the list is grouped, which this browser keeps. @param {string} by */
export function setGrouping(by) {
  keptGrouping.value = by;
  page.grouping.value = by;
}

/** The runs that are shown, in groups. */
export const runGroups = computed(() => groupRuns({
  runs: shownRuns.value, by: grouping.value, everyRun: everyRun.value,
}));

/** The runs that are shown, from the top to the bottom. */
export const listedRuns = computed(() => runGroups.value.flatMap(({ rows }) => rows.map(({ run }) => run)));

/** The tags of the known runs, the most frequent first. */
export const knownTags = computed(() => {
  /** @type {Map<string, { tag: string, count: number }>} */
  const counts = new Map();
  for (const tag of everyRun.value.flatMap(({ tags = [] }) => tags)) {
    const count = (counts.get(folded(tag))?.count ?? 0) + 1;
    counts.set(folded(tag), { tag, count });
  }
  return [...counts.values()].sort((a, b) => b.count - a.count).map(({ tag }) => tag);
});
