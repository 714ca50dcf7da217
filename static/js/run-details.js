// The runs whose details are shown beside the list: the one that was opened, or those that are selected.
import { computed } from "@preact/signals";
import { change, page } from "./page-state.js";
import { isPhone } from "./page.js";
import { byValue } from "./run-groups.js";
import { listedRuns } from "./run-list.js";
import { selected } from "./run-selection.js";
import { greedyOf } from "./run-words.js";
import { followRuns } from "./runs.js";
import { damagedRuns, isGone, runs } from "./store.js";
import { curveOf, followCurves } from "./training.js";

/** @import { AnyRun } from "./runs.js" */
/** @import { Run } from "./types.js" */

/** Show the details of a run; where there is no room beside the list, over it. @param {string} id */
export const openDetails = (id) => change({ opened: id, isOverList: isPhone.peek() });

export const closeDetails = () => change({ isOverList: false });

/** The run that was opened, listed or not; null without one. @type {{ value: AnyRun | null }} */
const opened = computed(() => {
  const id = page.opened.value ?? "";
  return runs.value.get(id) ?? damagedRuns.value.get(id) ?? null;
});

/** Whether the details are of the selection: of several runs, until one beside them is opened. */
export const isOfSelection = computed(() => {
  const all = selected.value;
  return all.length > 1 && (opened.value === null || all.includes(opened.value));
});

/** Whether the run that was opened is there no more; the details of another would look like its own. */
export const isOpenedGone = computed(() =>
  page.opened.value !== null && opened.value === null && selected.value.length === 0 && isGone(page.opened.value));

/** The runs whose details are shown: the opened run, else the first; several, a sweep by its values, where selected. */
export const subjects = computed(() => {
  if (isOfSelection.value) return byValue(selected.value);
  if (isOpenedGone.value) return [];
  const run = opened.value ?? selected.value[0] ?? listedRuns.value[0];
  return run ? [run] : [];
});

// ---- their curves

/** More lines in one chart cannot be told apart. */
export const MAX_CURVES = 8;

/** @param {AnyRun} run @returns {run is Run} */
export const isTraining = (run) => !("damaged" in run) && run.kind === "training";

const withCurves = computed(() => subjects.value.filter(isTraining).slice(0, MAX_CURVES));

/** Keep the run that a link opens, and the curves, while the view is open. */
export function followDetails() {
  const isOpen = computed(() => page.view.value === "runs");
  followRuns(computed(() => (isOpen.value && page.opened.value ? [page.opened.value] : [])));
  followRuns(computed(() => (isOpen.value ? page.selected.value : [])));
  followCurves(computed(() => (isOpen.value ? withCurves.value : [])));
}

/**
 * The point of a training's curve that is the farthest: [step, distance m]; null before its first evaluation.
 * @param {Run} run
 */
export function bestPointOf(run) {
  const { points } = curveOf(run);
  const [first, ...later] = points.slice(1);
  return first ? later.reduce((best, point) => (point.distance_m > best.distance_m ? point : best), first) : null;
}

/** Greedy's distance, where it is the same for all trainings [m]; else null. @param {Run[]} trainings */
export function commonGreedy(trainings) {
  const [first = null, ...later] = trainings.map(greedyOf);
  return later.every((greedy) => greedy === first) ? first : null;
}
