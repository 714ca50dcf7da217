// Values derived from the store: rights, the runs that the panels are about, and their progress.
import { computed, signal } from "@preact/signals";
import { conditionsAt, conditionsInWords, disturbancesOf } from "./disturbances.js";
import { form } from "./form.js";
import { count, duration, whole } from "./format.js";
import { formRobot, isSame } from "./robots.js";
import { learns } from "./settings.js";
import { commonStage, options, ownStage, role, runs, scene, stage } from "./store.js";

/** @import { Signal } from "@preact/signals" */
/** @import { FormValues, GaitConfig, LaneConfig, Run, Scene, State } from "./types.js" */

/** @type {Set<State>} */
const ACTIVE = new Set(["queued", "running", "paused"]);
/** @type {Set<State>} */
const WITH_TABLE = new Set(["finished", "stopped"]);
const MAX_OWN_RUNS = 50;

/** @type {<T>(value: T | null | undefined) => value is T} */
const isKnown = (value) => value !== null && value !== undefined;

/** @type {(run: Run | null | undefined) => boolean} */
export const isActive = (run) => isKnown(run) && ACTIVE.has(run.state);
/** @type {(run: Run | null | undefined) => boolean} */
export const hasTable = (run) => run?.kind === "training" && WITH_TABLE.has(run.state);

export const isOperator = computed(() => role.value === "operator");

/** Whether this page may play and seek: the common stage is the operators', a replay of its own is anybody's. */
export const canPlay = computed(() => isOperator.value || ownStage.value !== null);

/** Every known run, newest first. */
export const everyRun = computed(() =>
  [...runs.value.values()].sort((a, b) => b.created_at.localeCompare(a.created_at)),
);

/** Trainings and races: the runs that can be on stage. */
const stageableRuns = computed(() => everyRun.value.filter(({ kind }) => kind !== "experiment"));

/** Ids of the runs that this tab started, newest first. @type {Signal<string[]>} */
const ownRuns = signal(readOwnRuns());

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

/** Whether the stage plays: one that shows the end of its run does not. */
export const isPlaying = computed(() => stage.value !== null && stage.value.playing && !stage.value.ended);

/** Kind of the picture: live of a run that goes on, else a replay. */
export const playbackName = computed(() => (isActive(shownRun.value) ? "picture" : "replay"));

/** The clock under which the stage times the race. */
export const clock = computed(() => stage.value?.clock ?? scene.value?.clock ?? "paper");

/**
 * Ids of the trainings whose tables a race uses.
 * @param {Run | null} race
 */
export const trainingIds = (race) => [
  ...new Set(
    [...(race?.config.lanes ?? []).map((lane) => lane.training_id), ...(race?.waiting_for ?? [])].filter(isKnown),
  ),
];

/** @type {(id: string | null | undefined) => Run | null} */
const get = (id) => (isKnown(id) ? runs.value.get(id) ?? null : null);

/**
 * The model that a lane's search plans with, if the race is disturbed or the model is not the default; else null.
 * @param {Run} race
 * @param {LaneConfig} lane
 */
export const modelOfLane = (race, { plans_with = null, plans_with_by_default }) =>
  disturbancesOf(race).length || plans_with_by_default === false ? plans_with : null;

/** The run on stage. */
export const shownRun = computed(() => get(stage.value?.run_id));

/**
 * Whether the stage will show a race next, or another training of the race before.
 * @param {Run} race
 */
export const isToCome = (race) => {
  const next = stage.value?.next_run_id;
  return isKnown(next) && [race.id, ...trainingIds(race)].includes(next);
};

/** The race of the scoreboard and the race chart. @type {Signal<Run | null>} */
export const raceInView = computed(() => {
  const shown = shownRun.value;
  if (shown?.kind === "race") return shown;
  const races = stageableRuns.value.filter((run) => run.kind === "race");
  if (shown?.kind === "training") {
    const isItsRace = (/** @type {Run} */ race) => isActive(race) && trainingIds(race).includes(shown.id);
    return races.find(isToCome) ?? races.find(isItsRace) ?? null;
  }
  return races.find((race) => race.state === "finished") ?? null;
});

/** The race from which the one in view branches off. */
export const originalRace = computed(() => get(raceInView.value?.config.branch_from?.race_id));

/** The training of the learning curve. */
export const trainingInView = computed(() => {
  if (shownRun.value?.kind === "training") return shownRun.value;
  const [id] = trainingIds(raceInView.value);
  if (id) return get(id);
  if (raceInView.value) return null;
  return stageableRuns.value.find((run) => run.kind === "training") ?? null;
});

/**
 * A run that was requested, and the run that computes now: its training, as long as it waits for one.
 * @param {Run} requested
 * @returns {{ requested: Run, current: Run }}
 */
const workOf = (requested) => {
  const training = requested.kind === "race" ? trainingIds(requested).map(get).find(isActive) : null;
  return { requested, current: training ?? requested };
};

/** This tab's newest run that is not done. */
export const myWork = computed(() => {
  const run = ownRuns.value.map(get).find(isActive);
  return run ? workOf(run) : null;
});

/** The work that Pause and Stop act on: this tab's, else the one on stage, else any. */
export const work = computed(() => {
  if (myWork.value) return myWork.value;
  const candidates = isActive(shownRun.value) ? [raceInView.value, shownRun.value] : stageableRuns.value;
  const run = candidates.find(isActive);
  return run ? workOf(run) : null;
});

/** An interrupted run that can be resumed: the one on stage, or the newest. */
export const interruptedRun = computed(() =>
  work.value
    ? null
    : [shownRun.value, stageableRuns.value[0]].find((run) => run?.state === "interrupted") ?? null,
);

/** The training whose rates can be changed now. */
export const liveTraining = computed(() => {
  const run = work.value?.current;
  return run?.kind === "training" && (run.state === "running" || run.state === "paused") ? run : null;
});

/** This tab's run, while another live run is on stage. */
export const offStage = computed(() => {
  const { requested, current } = myWork.value ?? {};
  const onStage = commonStage.value?.run_id;
  if (!requested || !current || !onStage || !isActive(get(onStage))) return null;
  return [requested.id, current.id, ...trainingIds(requested)].includes(onStage) ? null : current;
});

const WALK_FIELDS = ["divisions", "grid_side_m", "observation", "simulator"];

/**
 * Whether a training's table can be used with the form's settings.
 * @param {Run} training
 * @param {FormValues} values
 */
const fits = (training, values) =>
  hasTable(training) &&
  isSame(training.config.gait, values.gait) &&
  isSame(formRobot(training.config.robot), formRobot(values.robot)) &&
  WALK_FIELDS.every((field) => [undefined, values[field]].includes(training.config[field]));

/** The trainings whose tables fit the form: those on stage first, then this tab's. */
const fittingTrainings = computed(() => {
  const known = [raceInView.value, shownRun.value, ...ownRuns.value.map(get)];
  const trainings = known.flatMap((run) => (run?.kind === "race" ? trainingIds(run).map(get) : [run]));
  return trainings.filter(isKnown).filter((run) => fits(run, form.value));
});

/** @param {string} agent */
const tableOf = (agent) => fittingTrainings.value.find(({ config }) => config.agent === agent) ?? null;

/** The newest training of the chosen learner whose table fits the form. */
export const matchingTable = computed(() => tableOf(form.value.agent));

/** Learner → id of its newest training that fits; null if a learner of the lanes has none. */
export const laneTables = computed(() => {
  const tables = form.value.lanes.filter(learns).map((agent) => [agent, tableOf(agent)?.id]);
  const isComplete = tables.length > 0 && tables.every(([, id]) => id);
  return isComplete ? /** @type {Record<string, string>} */ (Object.fromEntries(tables)) : null;
});

/** Whether the race in view was run with those tables, so that it can be run "again". */
export const isRaceRun = computed(() => {
  const race = raceInView.value;
  const ids = trainingIds(race);
  return race?.state === "finished" && Object.values(laneTables.value ?? { none: "" }).every((id) => ids.includes(id));
});

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

// ---- the moment that is shown

/** The scene, if it shows the race in view. */
export const raceScene = computed(() =>
  scene.value && scene.value.kind === "race" && scene.value.run_id === raceInView.value?.id
    ? scene.value
    : null,
);

/** The present step of the first lane that still walks, counted from 1; null if none does. */
export const stepShown = computed(() => {
  const walking = (raceScene.value?.lanes ?? []).filter(({ done }) => !done);
  return walking.length ? Math.max(1, ...walking.map(({ step }) => step)) : null;
});

/** Conditions in the step that is shown, of the run on stage, in words. */
export const conditionsShown = computed(() => {
  const run = shownRun.value;
  if (!run || run.kind === "experiment" || scene.value?.run_id !== run.id) return [];
  const step = Math.max(1, ...scene.value.lanes.map((lane) => lane.step));
  return conditionsInWords(conditionsAt(disturbancesOf(run), step - 1, run.config.robot));
});

/** The race whose replay is held: paused, or at its end. */
export const heldRace = computed(() => {
  const race = raceInView.value;
  const isHeld = stage.value !== null && (!stage.value.playing || stage.value.ended);
  return race?.state === "finished" && raceScene.value && isHeld && !work.value ? race : null;
});

// ---- the progress of the running work, or of what plays

/** Run id → when this page first saw it, for an estimate of its own. @type {Map<string, {at: number, done: number}>} */
const firstSeen = new Map();

/** @param {Run} run */
function secondsLeft(run) {
  if (Number.isFinite(run.eta_s)) return run.eta_s ?? null;
  const { done, total } = run.progress;
  const now = performance.now() / 1000;
  const first = firstSeen.get(run.id) ?? { at: now, done };
  firstSeen.set(run.id, first);
  return done > first.done ? ((total - done) * (now - first.at)) / (done - first.done) : null;
}

/** @type {Record<string, string>} */
const VERBS = { training: "Practising", race: "Simulating the race" };

/** {label, left, share} of the work, else of what plays; null while there is neither. */
export const progress = computed(() => (work.value ? ofWork(work.value) : ofPlayback(scene.value)));

/** @param {{ requested: Run, current: Run }} work */
function ofWork({ requested, current }) {
  const { done, total } = current.progress;
  const share = total ? done / total : 0;
  const then = requested === current ? "" : ", then the race";
  if (current.state === "queued") return { label: `Waiting in the queue${then}`, left: "", share: 0 };
  const steps = `${whole(done)} of ${count(total, "step")}`;
  if (current.state === "paused") return { label: `Paused at ${steps}${then}`, left: "", share };
  const seconds = secondsLeft(current);
  const left = seconds === null ? "" : `${duration(seconds)} left`;
  return { label: `${VERBS[current.kind] ?? "Running"}, ${steps}${then}`, left, share };
}

/** @param {Scene | null} shown */
function ofPlayback(shown) {
  if (!shown || shown.kind === "idle" || !shown.duration_s) return null;
  if (["finished", "waiting", "start-line"].includes(shown.phase)) return null;
  const speed = shown.shown_speed || 1;
  const rest = Math.max(0, shown.duration_s - shown.time_s) / speed;
  const verb = shown.replay ? "Replaying" : "Showing";
  const isTimeLapse = shown.kind === "training" && stage.value?.speed === "time-lapse";
  const isPaused = stage.value?.playing === false;
  return {
    label: isPaused ? `The ${playbackName.value} is paused` : `${verb} the ${shown.kind}`,
    left: isPaused || isTimeLapse ? "" : `${duration(rest)} left`,
    share: shown.time_s / shown.duration_s,
  };
}
