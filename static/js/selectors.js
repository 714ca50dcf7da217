// Values derived from the store: rights, and the runs that this tab started.
import { computed, signal } from "@preact/signals";
import { disturbancesOf } from "./disturbances.js";
import { features } from "./features.js";
import { isActive } from "./narrative/moment.js";
import { options, role, runs } from "./store.js";

/** @import { Signal } from "@preact/signals" */
/** @import { GaitConfig, LaneConfig, Run, State } from "./types.js" */

/** @type {Set<State>} */
const WITH_TABLE = new Set(["finished", "stopped"]);
const MAX_OWN_RUNS = 50;

/** @type {<T>(value: T | null | undefined) => value is T} */
export const isKnown = (value) => value !== null && value !== undefined;

export { isActive };
/** @type {(run: Run | null | undefined) => boolean} */
export const hasTable = (run) => run?.kind === "training" && WITH_TABLE.has(run.state);

export const isOperator = computed(() => role.value === "operator");
const guest = computed(() => features.value.find((feature) => feature.guest)?.guest ?? null);
/** Whether this page is a feature's guest's: they start runs, and change their own, and leave the stage alone. */
export const isGuest = computed(() => guest.value?.isHere.value ?? false);
/** Ids of the guest's runs, oldest first. */
export const guestRuns = computed(() => guest.value?.runs.value ?? []);
/** Whether this page may start trainings and races. */
export const mayStart = computed(() => isOperator.value || isGuest.value);
/** Whether this page may stop, rename or delete a run. @param {{ id: string }} run */
export const mayChange = ({ id }) => isOperator.value || guestRuns.value.includes(id);

/** Every known run, newest first. */
export const everyRun = computed(() =>
  [...runs.value.values()].sort((a, b) => b.created_at.localeCompare(a.created_at)),
);

/** Whether a run is one in which robots walk, so that it can be on stage: a training or a race. */
export const isWalk = (/** @type {{ kind: string }} */ { kind }) => kind === "training" || kind === "race";

/** The runs that can be on stage. */
export const stageableRuns = computed(() => everyRun.value.filter(isWalk));

/** The known run with an id. @type {(id: string | null | undefined) => Run | null} */
export const runOf = (id) => (isKnown(id) ? runs.value.get(id) ?? null : null);

/** Ids of the runs that this tab started, newest first. @type {Signal<string[]>} */
export const ownRuns = signal(readOwnRuns());

/** Ids of the runs that this tab, or the guest, has started, newest first. */
export const myRuns = computed(() => [...new Set([...ownRuns.value, ...guestRuns.value.toReversed()])]);

/** @param {string} id */
export const markAsMine = (id) => {
  ownRuns.value = [id, ...ownRuns.value].slice(0, MAX_OWN_RUNS);
  try {
    sessionStorage.setItem("hexapods:mine", JSON.stringify(ownRuns.value));
  } catch {
    // Storage is forbidden: known until the page is closed.
  }
};

function readOwnRuns() {
  try {
    return JSON.parse(sessionStorage.getItem("hexapods:mine") ?? "[]");
  } catch {
    return [];
  }
}

/**
 * Ids of the trainings whose tables a race uses.
 * @param {Run | null} race
 */
export const trainingIds = (race) => [
  ...new Set(
    [...(race?.config.lanes ?? []).map((lane) => lane.training_id), ...(race?.waiting_for ?? [])].filter(isKnown),
  ),
];

/**
 * The model that a lane's search plans with, if the race is disturbed or the model is not the default; else null.
 * @param {Run} race
 * @param {LaneConfig} lane
 */
export const modelOfLane = (race, { plans_with = null, plans_with_by_default }) =>
  disturbancesOf(race).length || plans_with_by_default === false ? plans_with : null;

/**
 * How many transitions a look-ahead agent simulates for one decision.
 * @param {number} depth in steps
 * @param {{ gait: GaitConfig, divisions: number }} walk
 */
export function simulatedPerDecision(depth, { gait, divisions }) {
  const pairs = options.value?.gaits.find(({ name }) => name === gait)?.pairs.length ?? 3;
  const cells = divisions ** 2 + (divisions % 2 === 0 ? 1 : 0);
  const moves = pairs * (cells - 1);
  let total = 0;
  for (let level = 1; level <= depth; level += 1) total += moves ** level;
  return total;
}
