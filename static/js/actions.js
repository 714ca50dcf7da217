// The user's actions. Each keeps its own error, which is shown beside the control that caused it.
import { computed, signal } from "@preact/signals";
import * as api from "./api.js";
import { configAtEnd } from "./training.js";
import { textOf } from "./disturbances.js";
import {
  chooseLearner, form, mistakes, raceBody, setField, setFields, trainingBody, validSteps,
} from "./form.js";
import { listed, t } from "./format.js";
import { changeIfStillHere, linkTo, page, showAddress } from "./page-state.js";
import { copy, toast } from "./page.js";
import {
  canPlay, isPlaying, isRaceRun, isStale, laneTables, matchingTable, myWork, work,
} from "./on-stage.js";
import { isActive, isOperator, markAsMine, mayStart } from "./selectors.js";
import {
  closeReplay, isOwn, openReplay, plan, playback, playReplay, position, seekReplay, setReplayClock,
  setReplaySpeed,
} from "./player.js";
import { beginOfStep } from "./replay-frames.js";
import { features, kindOf } from "./features.js";
import { formRobot } from "./robots.js";
import { agentOf, isClosed, laneSettings, learns, limitsOf, settingsOf } from "./settings.js";
import {
  isAway, options, requestRun, requestStage, runs, scene, served, setEntry, stage,
} from "./store.js";

/** @import { Signal } from "@preact/signals" */
/** @import { RequestError } from "./api.js" */
/** @import { Annotations, LaneConfig, Run } from "./types.js" */
/** @import { RunConfig, Stage, Verb } from "./types.js" */

/** Body of PUT /stage. @typedef {Partial<Stage> & { time_s?: number, stay?: boolean }} StageChanges */
/** A button of the page. @typedef {{ label: string, run: () => unknown }} Action */

/** Place → its last error; places are "start", "work", "stage", "tune", those of features, and run ids. */
export const problems = /** @type {Signal<Record<string, RequestError | null>>} */ (signal({}));
/** Places that wait for an answer. @type {Signal<Record<string, boolean>>} */
export const pending = signal({});
/** Fields that the server refused at a place. @type {(place: string) => string[]} */
export const refusedFields = (place) => problems.value[place]?.fields ?? [];

/**
 * Perform an action unless the place is pending, and keep its error there.
 * @template Result
 * @param {string} place
 * @param {() => Promise<Result>} action
 */
export async function attempt(place, action) {
  if (pending.value[place]) return null;
  setEntry(pending, place, true);
  setEntry(problems, place, null);
  try {
    return await action();
  } catch (error) {
    setEntry(problems, place, /** @type {RequestError} */ (error));
    return null;
  } finally {
    setEntry(pending, place, false);
  }
}

/**
 * Requests at a place, one at a time: those made meanwhile are sent as one when it is answered.
 * @template {object} Asked
 * @param {string} place
 * @param {(asked: Asked) => Promise<unknown>} send
 */
function oneAtATime(place, send) {
  let [sent, waiting] = /** @type {(Asked | null)[]} */ ([null, null]);
  const request = async (/** @type {Asked} */ change) => {
    if (pending.value[place]) {
      waiting = /** @type {Asked} */ ({ ...waiting, ...change });
      return;
    }
    sent = change;
    await attempt(place, () => send(change));
    const next = waiting;
    sent = waiting = null;
    if (next) await request(next);
  };
  /** What is asked for, and not answered yet. */
  return { request, unanswered: () => /** @type {Partial<Asked>} */ ({ ...sent, ...waiting }) };
}

/** @param {string} place */
export const dismissProblem = (place) => setEntry(problems, place, null);

// ---- starting

const racingLearners = computed(() => form.value.lanes.filter(learns));
const hasLearner = computed(() => racingLearners.value.length > 0);

/**
 * Set if the chosen learner has no lane in a race in which others have: a sentence, and the action that adds the lane.
 * @type {Signal<{ words: string, action: Action | null } | null>}
 */
export const missingLane = computed(() => {
  const { agent, lanes } = form.value;
  if (!hasLearner.value || lanes.includes(agent)) return null;
  const { title } = agentOf(agent);
  const others = listed(racingLearners.value.map((name) => agentOf(name).title));
  const isFixed = lanes.length >= (limitsOf("lanes").maximum ?? Infinity) || isClosed("lanes");
  const action = { label: t("Add {robot}", { robot: title }), run: () => setField("lanes", [agent, ...lanes]) };
  const words = t("{robot} is not in the race; {others} will learn and race.", { robot: title, others });
  return { words, action: isFixed ? null : action };
});

/** "Practise 500 more" */
const practiseMore = () => {
  const steps = validSteps();
  return steps === null ? t("Practise more") : t("Practise {steps} more", { steps });
};

/**
 * The action of the primary button; `short` is its label where there is little room.
 * @type {Signal<Action & { short: string }>}
 */
export const primaryAction = computed(() => {
  if (!hasLearner.value) return { label: t("Race"), short: t("Race"), run: () => startRace() };
  const short = t("Train, then race");
  const tables = laneTables.value;
  if (isRaceRun.value && tables) {
    return {
      label: t("{practice}, race again", { practice: practiseMore() }), short,
      run: () => startRace({ continued: tables }),
    };
  }
  const steps = validSteps();
  const label = steps === null ? short : t("Train {steps} {steps|step|steps}, then race", { steps });
  return { label, short, run: () => startRace() };
});

/** The other ways to start. @type {Signal<Action[]>} */
export const secondaryActions = computed(() => {
  if (!hasLearner.value) return [];
  /** @type {Action[]} */
  const actions = [];
  if (isRaceRun.value) actions.push({ label: t("Start over"), run: () => startRace() });
  else actions.push({ label: t("Train, don’t race"), run: () => startTraining() });
  const table = matchingTable.value;
  const practice = practiseMore();
  if (table) actions.push({ label: t("{practice}, don’t race", { practice }), run: () => continueTraining(table) });
  const tables = laneTables.value;
  if (tables) actions.push({ label: t("Race only"), run: () => startRace({ tables }) });
  if (racingLearners.value.every((agent) => form.value[`${agent}.keep_learning`])) {
    actions.push({ label: t("Race without practice"), run: () => startRace({ isUnpractised: true }) });
  }
  return actions;
});

export const canStart = computed(
  () => mayStart.value && !isAway.value && options.value !== null && !myWork.value && !pending.value.robot &&
    Object.keys(mistakes.value).length === 0,
);

export const runPrimaryAction = () => (canStart.value ? primaryAction.value.run() : null);

/**
 * Take in a run that this tab starts.
 * @param {() => Promise<Run | null>} send
 */
export const adopt = async (send) => {
  const run = await requestRun(send);
  if (run?.id) {
    markAsMine(run.id);
    closeReplay();
    features.peek().forEach(({ started }) => started?.(run));
  }
  return run;
};

/** @param {Parameters<typeof raceBody>[0]} [how] */
const startRace = (how) => attempt("start", () => adopt(() => api.startRace(raceBody(how))));

const startTraining = () => attempt("start", () => adopt(() => api.startTraining(trainingBody())));

/**
 * Continue the training of a table with the form's rates, without a race.
 * @param {Run} table
 */
const continueTraining = (table) =>
  attempt("start", () => adopt(() => api.startTraining(trainingBody(table.id))));

// ---- running work

export const pause = () => commandWork("pause");
export const resume = () => commandWork("resume");
export const stop = () => commandWork("stop");

/** Command the present work, and not what may come after it. @param {Verb} verb */
function commandWork(verb) {
  const id = work.value?.current.id;
  if (id && !isAway.peek() && commands.unanswered().verb !== verb) commands.request({ verb, id });
}

const commands = oneAtATime("work", async (/** @type {{ verb: Verb, id: string }} */ { verb, id }) => {
  const { current, requested } = work.value ?? {};
  if (!requested || current?.id !== id || current.state === STATES[verb]) return;
  // A race that waits for its training stops that too.
  await requestRun(() => api.command(verb === "stop" ? requested : current, verb));
  const { run_id, playing } = stage.value ?? {};
  if (!isOperator.value) return;
  if (verb === "stop" ? playing === false : run_id === id) await api.putStage({ playing: verb !== "pause" });
});

/** Verb → the state that it leads to. @type {Record<string, string>} */
const STATES = { pause: "paused", resume: "running", stop: "stopped" };

/** Pause or resume the training on stage, else the playback. */
export function togglePause() {
  if (isOwn.value) {
    togglePlaying();
    return;
  }
  if (!isOperator.value) return;
  const current = work.value?.current;
  if (current && current.id === playback.value?.run_id && current.kind === "training") {
    const state = STATES[commands.unanswered().verb ?? ""] ?? current.state;
    if (state === "paused") resume();
    else if (state === "running") pause();
    return;
  }
  togglePlaying();
}

// ---- races that branch off

/**
 * Branch a race: repeat it up to a step, and race on with disturbances.
 * @param {Run} race
 * @param {number} step how many steps both have in common
 * @param {object[]} disturbances without their step
 */
export const branchRace = (race, step, disturbances) =>
  attempt("branch", async () => {
    const body = { branch_from: { race_id: race.id, step }, disturbances };
    const run = await adopt(() => api.startRace(body));
    // The stage keeps its moment by itself, for all who watch.
    if (run && !isOwn.peek()) await requestStage(() => api.putStage({ run_id: run.id, playing: true }));
    else if (run) await openReplay(run.id, { time_s: beginOfStep(plan.peek(), step, position.peek()) });
    return run;
  });

// ---- the stage: the one that all pages share, or this page's own replay

/** @param {StageChanges} changes */
export function setStage(changes) {
  if (!isOwn.value) return stageChanges.request(changes);
  const { time_s, playing, speed, clock } = changes;
  setEntry(problems, "stage", null);
  if (typeof speed === "number") setReplaySpeed(speed);
  if (time_s !== undefined) seekReplay(time_s);
  if (playing !== undefined) playReplay(playing);
  if (clock === undefined) return Promise.resolve();
  // Not one at a time: the newest choice is obeyed.
  return setReplayClock(clock).catch((error) => setEntry(problems, "stage", error));
}

/** Change the stage that all pages share, whatever this page shows. @param {StageChanges} changes */
export const setShared = (changes) => stageChanges.request(changes);

const stageChanges = oneAtATime(
  "stage", (/** @type {StageChanges} */ changes) => requestStage(() => api.putStage(changes)),
);

/**
 * A function that shows a moment of a run [s]; null if another run is on stage, or for who may not.
 * @param {string} id
 * @returns {((time_s: number) => void) | null}
 */
export const seekIn = (id) =>
  canPlay.value && scene.value?.run_id === id ? (time_s) => setStage({ time_s }) : null;

export const togglePlaying = () => {
  const willPlay = stageChanges.unanswered().playing ?? isPlaying.value;
  if (canPlay.value && !isStale.value && playback.value?.run_id) setStage({ playing: !willPlay });
};
export const skipToEnd = () => setStage({ time_s: scene.value?.duration_s ?? undefined, playing: true });

/** Let the show of the race end at its time-out, or go on to its last step. @param {boolean} isOn */
export const endAtTimeOut = (isOn) => setStage({ end_at_time_out: isOn });
/** Go on from the photo finish, where the show has ended. */
export const keepWatching = () => setStage({ end_at_time_out: false, playing: true });
/** Keep the run on stage, instead of the replay that is announced. */
export const stay = () => setStage({ stay: true });

/** @param {Run} run */
export const showOnStage = (run) =>
  attempt(run.id, async () => {
    const start = isActive(run) ? {} : { time_s: 0 };
    const go = changeIfStillHere();
    await requestStage(() => api.putStage({ run_id: run.id, playing: true, ...start }));
    closeReplay();
    go({ view: "race" });
  });

// ---- runs

/**
 * Resume an interrupted or failed run from its last checkpoint.
 * @param {Run} run
 */
export const resumeRun = (run) =>
  attempt(run.id, () => adopt(() => api.command(run, "resume")));

/**
 * Start a run with the settings of another, and show it.
 * @param {Run} run
 */
export const runAgain = (run) =>
  attempt(run.id, async () => {
    const go = changeIfStillHere();
    const again = await adopt(() => api.startAgain(run.id));
    go(kindOf(run)?.stateOf(again?.id ?? null) ?? { view: "race" });
  });

/**
 * Change what users say of a run; null if that was refused.
 * @type {(run: Run, changes: Annotations) => Promise<Run | null>}
 */
export const annotate = (run, changes) =>
  attempt(run.id, () => requestRun(() => api.annotateRun(run.id, changes)));

/**
 * Copy the settings of a run into the form as they hold at its end, those of a race with those of its training.
 * @param {Run} run
 */
export function copySettings(run) {
  /** @type {Walk & { [field: string]: unknown }} */
  const config = run.kind === "race" ? configOfRace(run) : flat(configAtEnd(run));
  const { robot, agent, disturbances = [], ...fields } = config;
  if (agent && learns(agent)) chooseLearner(agent);
  const racing = run.kind === "race" ? run.config.lanes.map((lane) => lane.agent) : [];
  const fieldNames = Object.keys({
    ...form.value, ...settingsOf([form.value.agent, ...racing]), ...laneSettings(racing),
  });
  const taken = Object.entries(fields).filter(([field]) => fieldNames.includes(field) && field !== "name");
  const happens = { world: served().worlds[0].name, disturb: disturbances.map(textOf) };
  setFields({ ...Object.fromEntries(taken), robot: robot ? formRobot(robot) : form.value.robot, ...happens });
}

/**
 * A config as the form has it, with the agent's settings among the other fields.
 * @type {(config: Record<string, any>) => Record<string, any>}
 */
const flat = ({ settings = {}, ...config }) => ({ ...config, ...settings });

/** The agent of a lane without training, its settings, and how it reads its state. @param {LaneConfig} lane */
const settingsOfLane = ({ agent, observation, settings }) => ({ agent, observation, ...settings });

/**
 * A lane as it was asked for: what its search knows by default depends on what happens in its race.
 * @type {(lane: LaneConfig) => LaneConfig}
 */
const asAsked = (lane) => lane.plans_with_by_default ? { ...lane, plans_with: null } : lane;

/** What the form takes over. @typedef {Partial<Pick<RunConfig, "robot" | "agent" | "disturbances">>} Walk */

/** @type {(race: Run) => Walk & { lanes: string[], [field: string]: unknown }} */
function configOfRace({ config: { lanes, steps, ...walk } }) {
  const trainings = lanes.map((lane) => {
    const run = runs.value.get(lane.training_id ?? "");
    return run ? flat(configAtEnd(run)) : learns(lane.agent) && settingsOfLane(lane);
  });
  // Of a setting that several learners have, the value of the first.
  const practice = Object.assign({}, ...trainings.reverse());
  const settingsOfLanes = lanes.map(asAsked).map(flat)
    .flatMap((lane) => Object.entries(lane).map(([name, value]) => [`${lane.agent}.${name}`, value]));
  const agents = lanes.map(({ agent }) => agent);
  return { ...practice, ...walk, ...Object.fromEntries(settingsOfLanes), race_steps: steps, lanes: agents };
}

/** Copy a link to what the page shows; where there is no clipboard, show it in the address bar. */
export async function share() {
  const moment = { run: page.run.peek(), ghost: page.ghost.peek(), moment: position.peek() };
  const address = linkTo(isOwn.value ? moment : undefined);
  const contents = isOwn.value ? t("Link copied. It opens this replay at this moment.")
    : t("Link copied. It contains every setting that was changed.");
  if (!(await copy(address, contents))) {
    showAddress(address);
    toast(t("The address bar has the link: copy it from there."));
  }
}
