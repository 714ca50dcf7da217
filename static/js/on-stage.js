// What is on stage, what is computed, and whose time is shown. The stage, the board, the charts, the form, the chips
// and the title follow from these values, so that they speak of one run and one moment. The phases are those of the
// server's state machine (app/stage/state_machine.py); a page that plays a replay of its own has them for its replay.
import { computed } from "@preact/signals";
import { conditionsAt, conditionsInWords, disturbancesOf } from "./disturbances.js";
import { form } from "./form.js";
import { duration, sentence, t } from "./format.js";
import { formRobot, isSame } from "./robots.js";
import { earlyEndOf } from "./narrative/moment.js";
import {
  hasTable, isActive, isKnown, isOperator, isGuest, myRuns, runOf, stageableRuns, trainingIds, isWalk,
} from "./selectors.js";
import { learns } from "./settings.js";
import { isOwn, playback } from "./player.js";
import { isAway, isLockedOut, scene, stage } from "./store.js";
import { partsOf } from "./features.js";

/** @import { Signal } from "@preact/signals" */
/** @import { FormValues, Run, Scene } from "./types.js" */

// ---- what is on stage

/** The run on stage; null if there is none, or it is not known (yet). */
export const shownRun = computed(() => runOf(playback.value?.run_id));

/** The scene, if it is of the run on stage: its first frame comes later. */
const sceneOnStage = computed(() => {
  const now = scene.value;
  return now && playback.value && now.run_id === playback.value.run_id ? now : null;
});

/** Whether the picture is the last one that was heard of: a replay of this page's own goes on without the server. */
export const isStale = computed(() => isAway.value && !isOwn.value);

/** The phase of the stage; "empty" before the first snapshot too. */
export const phase = computed(() => playback.value?.phase ?? "empty");

/** Whether the stage plays: one that shows the end of its run does not, nor one that is not heard. */
export const isPlaying = computed(() =>
  playback.value !== null && playback.value.playing && !playback.value.ended && !isStale.value);

/** Whose picture this page shows: the stage, which is everyone's, or a replay of its own. */
export const playbackName = computed(() => (isOwn.value ? "replay" : "stage"));

/** Whether this page may play and seek: the common stage is the operators', a replay of its own is anybody's. */
export const canPlay = computed(() => isOperator.value || isOwn.value);

/** The clock under which the stage times the race. */
export const clock = computed(() => playback.value?.clock ?? "paper");

// ---- the runs that the panels are about

/**
 * Whether the stage will show a race next, or another training of the race before.
 * @param {Run} race
 */
export const isToCome = (race) => {
  const next = playback.value?.next_run_id;
  return isKnown(next) && [race.id, ...trainingIds(race)].includes(next);
};

/** The race of the scoreboard and the race chart: the one on stage, or the one that follows the training there. */
export const raceInView = computed(() => {
  const shown = shownRun.value;
  if (shown?.kind !== "training") return shown?.kind === "race" ? shown : null;
  const races = stageableRuns.value.filter((run) => run.kind === "race");
  const isItsRace = (/** @type {Run} */ race) => isActive(race) && trainingIds(race).includes(shown.id);
  return races.find(isToCome) ?? races.find(isItsRace) ?? null;
});

/** The race from which the one in view branches off. */
export const originalRace = computed(() => runOf(raceInView.value?.config.branch_from?.race_id));

/** The training of the learning curve: the one on stage, or whose table the race there uses. */
export const trainingInView = computed(() => {
  if (shownRun.value?.kind === "training") return shownRun.value;
  const [id] = trainingIds(raceInView.value);
  return runOf(id);
});

// ---- what is computed

/**
 * A run that was requested, and the run that computes now: its training, as long as it waits for one.
 * @param {Run} requested
 * @returns {{ requested: Run, current: Run }}
 */
const workOf = (requested) => {
  const training = requested.kind === "race" ? trainingIds(requested).map(runOf).find(isActive) : null;
  return { requested, current: training ?? requested };
};

/** This tab's newest run that is not done. */
export const myWork = computed(() => {
  const run = myRuns.value.map(runOf).find(isActive);
  return run ? workOf(run) : null;
});

/** The work that Pause and Stop act on: this tab's, else the one on stage, else any. */
export const work = computed(() => {
  // Guests see each other's work in the list of runs alone.
  if (myWork.value || isGuest.value) return myWork.value;
  const candidates = isActive(shownRun.value) ? [raceInView.value, shownRun.value] : stageableRuns.value;
  const run = candidates.find(isActive);
  return run ? workOf(run) : null;
});

/** The training whose rates can be changed now. */
export const liveTraining = computed(() => {
  const run = work.value?.current;
  return run?.kind === "training" && (run.state === "running" || run.state === "paused") ? run : null;
});

/** This tab's run, while the stage shows another one. */
export const offStage = computed(() => {
  const { requested, current } = myWork.value ?? {};
  const onStage = stage.value?.run_id;
  if (!requested || !current || !onStage || isGuest.value || isAway.value) return null;
  const isShown = [requested.id, current.id, ...trainingIds(requested)].includes(onStage);
  return isShown || stage.value?.next_run_id === requested.id ? null : current;
});

/** Whether a run can be resumed that ended before its last step. @param {Run | null | undefined} run */
const isResumable = (run) => Boolean(run && earlyEndOf(run) && run.can_resume);

/**
 * Whether a race has to wait for a training: that of one that was stopped is used as it is, unless the race has not
 * begun yet. @type {(race: Run, training: Run) => boolean}
 */
const waitsFor = (race, training) =>
  trainingIds(race).includes(training.id) && (training.state !== "stopped" || race.waiting_for?.includes(training.id));

/** Whether something was made of a training's table, which stays then as it is. @param {Run} training */
const isUsed = (training) => training.state === "stopped" && stageableRuns.value.some((run) =>
  run.progress.done > 0 && (run.config.continue_from === training.id || trainingIds(run).includes(training.id)));

/**
 * The run on stage, if it can be resumed; of a training the race that waited for it, which resumes both.
 */
export const resumableOnStage = computed(() => {
  const shown = shownRun.value;
  if (work.value || !shown || !isResumable(shown) || isUsed(shown)) return null;
  return stageableRuns.value.find((run) => isResumable(run) && waitsFor(run, shown)) ?? shown;
});

/** When a run was last at work. @param {Run} run */
const lastActivity = ({ ended_at, created_at }) => ended_at ?? created_at;

/** The run that was last at work, if it was interrupted and is not on stage. */
export const interruptedRun = computed(() => {
  const [last] = stageableRuns.value.toSorted((a, b) => lastActivity(b).localeCompare(lastActivity(a)));
  if (work.value || isGuest.value || last?.state !== "interrupted") return null;
  return last === shownRun.value || last === resumableOnStage.value ? null : last;
});

// ---- Q-tables of these runs, and of this tab's, that can be used with the form's settings

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
  WALK_FIELDS.every((field) => training.config[field] === undefined || training.config[field] === values[field]);

/** The trainings whose tables fit the form: those on stage first, then this tab's. */
const fittingTrainings = computed(() => {
  const shownRuns = [raceInView.value, shownRun.value, ...myRuns.value.map(runOf)];
  const trainings = shownRuns.flatMap((run) => (run?.kind === "race" ? trainingIds(run).map(runOf) : [run]));
  // A guest begins with a robot of their own, whatever the stage shows of others.
  const isUsable = (/** @type {Run} */ run) => !isGuest.value || myRuns.value.includes(run.id);
  return trainings.filter(isKnown).filter((run) => isUsable(run) && fits(run, form.value));
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

// ---- the moment that is shown, and how far the computation is ahead of it

/** The scene, if it shows the race in view. */
export const raceScene = computed(() => {
  const now = sceneOnStage.value;
  return now?.kind === "race" && now.run_id === raceInView.value?.id ? now : null;
});

/** Whether a race's show ended with its photo finish while lanes still walk, so that somebody may keep watching. */
export const isDecided = computed(() => raceScene.value?.phase === "photo-finish");

/** The present step of the first lane that still walks, counted from 1; null if none does. */
export const stepShown = computed(() => {
  const walking = (raceScene.value?.lanes ?? []).filter(({ done, halted }) => !done && !halted);
  return walking.length ? Math.max(1, ...walking.map(({ step }) => step)) : null;
});

/** Steps of all lanes that the picture has shown, as a run's progress counts them; null while it shows another run. */
const stepsShown = computed(() =>
  sceneOnStage.value ? sceneOnStage.value.lanes.reduce((sum, { step }) => sum + step, 0) : null,
);

/** Conditions in the step that is shown, of the run on stage, in words. */
export const conditionsShown = computed(() => {
  const run = shownRun.value;
  if (!run || !isWalk(run) || !sceneOnStage.value) return [];
  const step = Math.max(1, ...sceneOnStage.value.lanes.map((lane) => lane.step));
  return conditionsInWords(conditionsAt(disturbancesOf(run), step - 1, run.config.robot));
});

/** The picture may be so many steps behind before that is told. */
const MAX_LAG_STEPS = 2;

/**
 * What a change of a live setting acts on, where the picture could make a reader think otherwise: a training that is
 * computed, whose next step is `step` while the picture shows `shown`; or one that is computed to its end already.
 * @type {Signal<{ step: number, shown: number | null } | "computed" | null>}
 */
export const steering = computed(() => {
  if (isAway.value) return null;
  const run = liveTraining.value;
  const isShown = sceneOnStage.value !== null && shownRun.value?.id === run?.id;
  if (run) {
    const { done } = run.progress;
    const shown = isShown ? stepsShown.value : null;
    return isShown && done - (shown ?? 0) <= MAX_LAG_STEPS ? null : { step: done + 1, shown };
  }
  const isBehind = shownRun.value?.kind === "training" && phase.value === "showing";
  return isBehind && playback.value?.origin === "started" ? "computed" : null;
});

// ---- progress of the running work, or of what plays

/** Run and start → when this page first saw it, for an estimate. @type {Map<string, {at: number, done: number}>} */
const firstSeen = new Map();

/** @param {Run} run */
function secondsLeft(run) {
  if (Number.isFinite(run.eta_s)) return run.eta_s ?? null;
  const { done, total } = run.progress;
  const now = performance.now() / 1000;
  const key = `${run.id} ${run.started_at}`;
  const first = firstSeen.get(key) ?? { at: now, done };
  firstSeen.set(key, first);
  return done > first.done ? ((total - done) * (now - first.at)) / (done - first.done) : null;
}

/** @type {Record<string, string>} */
const VERBS = { training: t("Practising"), race: t("Simulating the race") };

/**
 * Progress as a bar: `share` is computed, and `shown` of it is in the picture, where the picture is of that run.
 * @typedef {{ label: string, left: string, share: number, shown: number | null }} Progress
 */

/** Progress of the work, else of what plays; null while there is neither. @type {Signal<Progress | null>} */
export const progress = computed(() => {
  if (work.value) return isAway.value ? lastKnown(ofWork(work.value)) : ofWork(work.value);
  return isStale.value ? null : ofPlayback(sceneOnStage.value);
});

/** As it was heard last: whether it goes on is not known. @type {(known: Progress) => Progress} */
const lastKnown = ({ label, ...rest }) =>
  ({ ...rest, label: t("Last known: {label}", { label: label[0].toLowerCase() + label.slice(1) }), left: "" });

/** Told to those who wait for others. @param {Run} run */
const placeInQueue = ({ queue_position: place }) => (isGuest.value && place ? t(", place {place}", { place }) : "");

/** @param {{ requested: Run, current: Run }} work @returns {Progress} */
function ofWork({ requested, current }) {
  const { done, total } = current.progress;
  const share = total ? done / total : 0;
  const seen = shownRun.value?.id === current.id ? stepsShown.value : null;
  const shown = seen === null || !total ? null : Math.min(seen, done) / total;
  const then = requested === current ? "" : t(", then the race");
  if (current.state === "queued") {
    return { label: t("Waiting in the queue") + placeInQueue(current) + then, left: "", share: 0, shown: null };
  }
  const steps = t("{done} of {total} {total|step|steps}", { done, total });
  if (current.state === "paused") return { label: t("Paused at {steps}", { steps }) + then, left: "", share, shown };
  const seconds = secondsLeft(current);
  const left = seconds === null ? "" : t("{time} left", { time: duration(seconds) });
  const verb = VERBS[current.kind] ?? t("Running");
  if (seen === null) return { label: `${verb}, ${steps}${then}${notShown(current)}`, left, share, shown };
  const isBehind = done - seen > MAX_LAG_STEPS;
  const label = isBehind ? t("{verb}: {seen} shown ▸ {steps} computed", { verb, seen, steps }) : `${verb}, ${steps}`;
  return { label: label + then, left, share, shown };
}

/** @param {Run} run */
function notShown(run) {
  if (!playback.value?.run_id || playback.value.run_id === run.id) return "";
  return isToCome(run) ? t(", shown next") : t(", not on the stage");
}

/** @param {Scene | null} now @returns {Progress | null} */
function ofPlayback(now) {
  if (!now || now.kind === "idle" || !now.duration_s || phase.value === "ended") return null;
  if (["waiting", "start-line"].includes(now.phase)) return null;
  const end = (playback.value?.end_at_time_out ? now.time_out_s : null) ?? now.duration_s;
  const last = Math.min(now.computed_s, Math.max(end, now.time_s));
  const rest = Math.max(0, last - now.time_s) / (now.shown_speed || 1);
  const isTimeLapse = now.kind === "training" && playback.value?.speed === "time-lapse";
  const isPaused = playback.value?.playing === false;
  return {
    label: isPaused ? pausedLabel() : showing(now),
    left: isPaused || isTimeLapse ? "" : t("{time} left", { time: duration(rest) }),
    share: now.computed_s / now.duration_s,
    shown: now.time_s / now.duration_s,
  };
}

const pausedLabel = () => (isOwn.value ? t("The replay is paused") : t("The stage is paused"));

/** @param {Scene} now */
function showing(now) {
  const isRace = now.kind === "race";
  if (playback.value?.origin !== "started") return isRace ? t("Replaying the race") : t("Replaying the training");
  if (earlyEndOf(shownRun.value)) {
    return isRace ? t("Showing the race, which is computed as far as it came")
      : t("Showing the training, which is computed as far as it came");
  }
  return isRace ? t("Showing the race, which is computed to its end")
    : t("Showing the training, which is computed to its end");
}

// ---- the title of the window

const PRODUCT = "Racing Hexapods";
/** @type {Record<string, string>} */
const VIEW_TITLES = { runs: t("Runs"), compare: t("Compare runs") };

/**
 * The window's title: the connection if it is lost, the view, or what the stage shows.
 * @param {string} view
 * @param {string | null} headline of the race or the practice that is shown
 */
export function windowTitle(view, headline) {
  const title = VIEW_TITLES[view] ?? partsOf("views")[view]?.title;
  const parts = [title ?? (phase.value === "empty" ? null : headline ?? sceneOnStage.value?.label ?? null)];
  if (isLockedOut.value) parts.splice(0, 1, t("No access"));
  else if (isAway.value) parts.unshift(t("Reconnecting"));
  return [...parts, PRODUCT].filter(Boolean).map((word) => sentence(/** @type {string} */ (word))).join(" · ");
}
