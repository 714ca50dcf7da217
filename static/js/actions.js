// What one can do. Each keeps its own error, so that it is shown beside the control that caused it.
import { computed, signal } from "@preact/signals";
import * as api from "./api.js";
import { form, link, mistakes, raceBody, set, trainingBody } from "./form.js";
import { count, whole } from "./format.js";
import {
  claim, isActive, isOperator, learns, liveTraining, myWork, raceIsRun, shownRun, tableInHand, work,
} from "./selectors.js";
import { dropRun, keepRun, rates, runs, scene, stage } from "./store.js";

/** Place → what went wrong there: "start", "work", "stage", "tune", or a run's id. */
export const problems = signal({});
/** Places that wait for an answer. */
export const pending = signal({});
/** Fields that the server refused. */
export const refusedFields = computed(() => problems.value.start?.fields ?? []);
/** Fields that the server refused at a place. */
export const refusals = (place) => problems.value[place]?.fields ?? [];
/** A passing remark: {text} or null. */
export const remark = signal(null);

const mark = (map, place, value) => (map.value = { ...map.value, [place]: value });

/** Do something once at a time, and keep what goes wrong. */
export async function attempt(place, act) {
  if (pending.value[place]) return null;
  mark(pending, place, true);
  mark(problems, place, null);
  try {
    return await act();
  } catch (error) {
    mark(problems, place, error);
    return null;
  } finally {
    mark(pending, place, false);
  }
}

export const forget = (place) => mark(problems, place, null);

// ---- starting

const someoneLearns = computed(() => form.value.lanes.some(learns));

/** What the one primary button will do. */
export const nextDeed = computed(() => {
  const { steps } = form.value;
  if (!someoneLearns.value) return { label: "Race", run: () => startRace() };
  if (raceIsRun.value) {
    const continueFrom = tableInHand.value.id;
    return { label: `Practise ${whole(steps)} more, race again`, run: () => startRace({ continueFrom }) };
  }
  return { label: `Train ${count(steps, "step")}, then race`, run: () => startRace() };
});

/** What else could be done: [label, deed]. */
export const otherDeeds = computed(() => {
  const deeds = [];
  const table = tableInHand.value;
  if (someoneLearns.value) {
    if (raceIsRun.value) deeds.push(["Start afresh", () => startRace()]);
    else deeds.push(["Train only", () => startTraining()]);
    if (table) deeds.push(["Race only", () => startRace({ table: table.id })]);
  }
  return deeds;
});

export const canStart = computed(
  () => isOperator.value && !myWork.value && Object.keys(mistakes.value).length === 0,
);

export const doNext = () => (canStart.value ? nextDeed.value.run() : null);

const take = (run) => {
  keepRun(run);
  claim(run.id);
  return run;
};

const startRace = (how) =>
  attempt("start", async () => take(await api.startRace(raceBody(form.value, learns, how))));

const startTraining = () =>
  attempt("start", async () => take(await api.startTraining(trainingBody(form.value))));

/** Practise on from a table that there is, at the rates that the form has now. */
export const continueWith = (table) =>
  attempt("start", async () => take(await api.startTraining(trainingBody(form.value, table.id))));

// ---- what runs

export const pause = () => tellWork("pause");
export const resume = () => tellWork("resume");

const tellWork = (verb) =>
  attempt("work", async () => {
    const { now } = work.value;
    const answer = await api.tell(now, verb);
    if (answer?.id) keepRun(answer);
    if (stage.value?.run_id === now.id) await api.putStage({ playing: verb === "resume" });
  });

export const stop = () =>
  attempt("work", async () => {
    // A race that waits takes its practice with it.
    const answer = await api.tell(work.value.asked, "stop");
    if (answer?.id) keepRun(answer);
    if (stage.value?.playing === false) await api.putStage({ playing: true });
  });

/** Space: pause the work that is on stage, else the picture. */
export function pauseOrPlay() {
  if (!isOperator.value) return;
  const { now } = work.value ?? {};
  if (now && now.id === stage.value?.run_id && now.kind === "training") {
    if (now.state === "paused") resume();
    else if (now.state === "running") pause();
    return;
  }
  togglePlaying();
}

// ---- rates of a training that runs

const TUNE_MS = 120;
let waiting = null;

/** A rate that is moved while a training runs takes effect at its next step. */
export function tune(changes) {
  const run = liveTraining.value;
  if (!run) return;
  mark(rates, run.id, { ...rates.value[run.id], ...changes });
  if (waiting) {
    Object.assign(waiting, changes);
    return;
  }
  waiting = { ...changes };
  setTimeout(() => {
    const sent = waiting;
    waiting = null;
    api.tuneTraining(run.id, sent).then(
      () => mark(problems, "tune", null),
      (error) => isActive(runs.value.get(run.id)) && mark(problems, "tune", error),
    );
  }, TUNE_MS);
}

// ---- the stage, which everyone shares

export const setStage = (changes) =>
  attempt("stage", async () => {
    const answer = await api.putStage(changes);
    if (answer) stage.value = answer;
  });

export const togglePlaying = () => {
  if (isOperator.value && stage.value?.run_id) setStage({ playing: !stage.value.playing });
};
export const skipToEnd = () => setStage({ time_s: scene.value.duration_s, playing: true });
export const showOnStage = (run) =>
  attempt(run.id, async () => {
    const time_s = isActive(run) ? {} : { time_s: 0 };
    stage.value = (await api.putStage({ run_id: run.id, playing: true, ...time_s })) ?? stage.value;
    location.hash = "";
  });

// ---- runs

/** Let a run that a server left behind go on where its last checkpoint is. */
export const goOn = (run) =>
  attempt(run.id, async () => {
    const answer = await api.tell(run, "resume");
    if (answer?.id) take(answer);
  });

export const remove = (run) =>
  attempt(run.id, async () => {
    await api.deleteRun(run);
    dropRun(run.id);
  });

/** The form as that run had it. */
export function useSettingsOf(run) {
  const { robot, lanes, ...config } = run.config;
  const known = Object.keys(form.value);
  for (const [field, value] of Object.entries(config)) {
    if (known.includes(field) && field !== "name") set(field, value);
  }
  set("robot", robot?.preset ?? robot ?? form.value.robot);
  if (lanes) {
    set("race_steps", config.steps);
    set("lanes", lanes.map(({ agent }) => agent));
  }
}

// ---- the page

let remarkTimer = 0;
export function say(text) {
  remark.value = { text };
  clearTimeout(remarkTimer);
  remarkTimer = setTimeout(() => (remark.value = null), 4000);
}

export async function share() {
  try {
    await navigator.clipboard.writeText(link());
    say("Link copied. It carries every setting of the form.");
  } catch {
    // No clipboard outside of https and loopback: the address bar has the same.
    history.replaceState(history.state, "", link());
    say("The address bar has the link: copy it from there.");
  }
}

export const isShown = (run) => shownRun.value?.id === run.id;
