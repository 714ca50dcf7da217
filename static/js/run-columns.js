// The columns of the list of runs: what there are, and which are shown. A link has them, and this browser keeps them.
import { computed } from "@preact/signals";
import { metres, shortTime, whole } from "./format.js";
import { page } from "./page-state.js";
import { storedText } from "./page.js";
import { fieldInWords, fieldsOf } from "./run-settings.js";
import { shareOf } from "./run-words.js";
import { distanceOf } from "./runs.js";
import { bestKnown } from "./store.js";
import { agentTitle, gaitTitle } from "./titles.js";
import { isWalk } from "./selectors.js";

/** @import { Run } from "./types.js" */

/**
 * `width` [rem]; `value` is empty where a run has none.
 * @typedef {{ title: string, width: number, value: (run: Run) => string }} Column
 */

/** @type {(value: (run: Run) => string) => (run: Run) => string} */
const ofTraining = (value) => (run) => (run.kind === "training" ? value(run) : "");
/** @type {(value: (run: Run) => string) => (run: Run) => string} */
const ofWalk = (value) => (run) => (isWalk(run) ? value(run) : "");

/** @param {Run} run */
const bestOf = ({ id, result, best_known_m }) => result?.best_known_m ?? best_known_m ?? bestKnown.value[id] ?? null;

/** @param {number | null} distance */
const metresOf = (distance) => (distance === null ? "" : metres(distance));

/** In the order in which they stand. @type {Record<string, Column>} */
export const COLUMNS = {
  learner: { title: "Learner", width: 7.5, value: ofTraining(({ config }) => agentTitle(config.agent)) },
  gait: { title: "Gait", width: 8.5, value: ofWalk(({ config }) => gaitTitle(config.gait)) },
  world: { title: "World", width: 6.5, value: ofWalk((run) => fieldInWords(fieldsOf(run), "world")) },
  steps: { title: "Practice", width: 3.5, value: ofTraining(({ config }) => whole(config.steps)) },
  seed: { title: "Seed", width: 2.5, value: ofWalk(({ config }) => String(config.seed)) },
  tags: { title: "Tags", width: 7, value: ({ tags = [] }) => tags.join(", ") },
  state: { title: "State", width: 5.5, value: ({ state }) => state },
  best: { title: "Best known", width: 4.5, value: ofWalk((run) => metresOf(bestOf(run))) },
  share: { title: "Of Greedy", width: 4.5, value: (run) => shareOf(run) ?? "" },
  distance: { title: "Distance", width: 4.5, value: ofWalk((run) => (run.result ? metresOf(distanceOf(run)) : "")) },
  created: { title: "Created", width: 4.5, value: ({ created_at }) => shortTime(created_at) },
};
const BY_DEFAULT = ["distance", "created"];

const storedColumns = storedText("columns", BY_DEFAULT.join(","));

/** The names of the columns that are shown: as the link says, or as this browser has kept them. */
export const shownColumns = computed(() => {
  const names = page.columns.value ?? storedColumns.value.split(",");
  return Object.keys(COLUMNS).filter((name) => names.includes(name));
});

/** Show a column, or no longer; this browser keeps that. @param {string} name */
export function toggleColumn(name) {
  const shown = shownColumns.peek();
  const remaining = shown.filter((column) => column !== name);
  const chosen = remaining.length < shown.length ? remaining : [...shown, name];
  storedColumns.value = chosen.join(",");
  page.columns.value = chosen;
}
