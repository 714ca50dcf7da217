// What follows from the store: who may do what, and which runs the panels speak about.
import { computed, signal } from "@preact/signals";
import { form } from "./form.js";
import { options, role, runs, scene, stage } from "./store.js";

const ACTIVE = new Set(["queued", "running", "paused"]);
const TABLE_STATES = new Set(["finished", "stopped"]);

export const isActive = (run) => run !== null && run !== undefined && ACTIVE.has(run.state);
export const hasTable = (run) => run?.kind === "training" && TABLE_STATES.has(run.state);

export const isOperator = computed(() => role.value === "operator");

/** Every run that there is. */
export const everyRun = computed(() =>
  [...runs.value.values()].sort((a, b) => b.created_at.localeCompare(a.created_at)),
);

/** Trainings and races, which can be on stage; experiments cannot. */
const newestFirst = computed(() => everyRun.value.filter(({ kind }) => kind !== "experiment"));

/** Runs that this tab started, newest first. */
const mine = signal(recall());
export const claim = (id) => {
  mine.value = [id, ...mine.value].slice(0, 50);
  try {
    sessionStorage.setItem("hexapods:mine", JSON.stringify(mine.value));
  } catch {
    // Storage is forbidden: known as long as the page lives.
  }
};

function recall() {
  try {
    return JSON.parse(sessionStorage.getItem("hexapods:mine")) ?? [];
  } catch {
    return [];
  }
}

export const agentOf = (name) =>
  options.value?.agents?.find((agent) => agent.name === name) ?? {
    name, title: name, color: "#888888", learns: false,
  };

export const learns = (name) => agentOf(name).learns;

export const clock = computed(() => stage.value?.clock ?? scene.value?.clock ?? "paper");

/** The ids of the trainings that a race's learners bring. */
const trainingIds = (race) => [
  ...new Set([
    ...(race?.config?.lanes ?? []).map((lane) => lane.training_id),
    ...(race?.waiting_for ?? []),
  ].filter(Boolean)),
];

const get = (id) => runs.value.get(id) ?? null;

/** The run on stage, if any. */
export const shownRun = computed(() => get(stage.value?.run_id));

/** The race that the scoreboard and the race's chart are about. */
export const raceInView = computed(() => {
  const shown = shownRun.value;
  if (shown?.kind === "race") return shown;
  const races = newestFirst.value.filter((run) => run.kind === "race");
  if (shown?.kind === "training") {
    const next = get(stage.value.next_run_id);
    return next ?? races.find((race) => isActive(race) && trainingIds(race).includes(shown.id)) ?? null;
  }
  return races.find((race) => race.state === "finished") ?? null;
});

/** The training that the learning curve is about. */
export const trainingInView = computed(() => {
  if (shownRun.value?.kind === "training") return shownRun.value;
  const [id] = trainingIds(raceInView.value);
  if (id) return get(id);
  if (raceInView.value) return null;
  return newestFirst.value.find((run) => run.kind === "training") ?? null;
});

/** A run and what it waits for: what computes right now, and the run that was asked for. */
const working = (run) => {
  const waits = run.kind === "race" ? trainingIds(run).map(get).find(isActive) : null;
  return { asked: run, now: waits ?? run };
};

/** My own work that is not done. */
export const myWork = computed(() => {
  const run = mine.value.map(get).find(isActive);
  return run ? working(run) : null;
});

/** The work that Pause and Stop are about: mine, else what is on stage, else anyone's. */
export const work = computed(() => {
  if (myWork.value) return myWork.value;
  if (isActive(shownRun.value)) {
    return working(isActive(raceInView.value) ? raceInView.value : shownRun.value);
  }
  const any = newestFirst.value.find(isActive);
  return any ? working(any) : null;
});

/** A run that could go on: what is on stage, or the newest as long as nothing came after it. */
export const interruptedRun = computed(() =>
  work.value
    ? null
    : [shownRun.value, newestFirst.value[0]].find((run) => run?.state === "interrupted") ?? null,
);

/** The training whose rates can be moved right now. */
export const liveTraining = computed(() => {
  const run = work.value?.now;
  return run?.kind === "training" && (run.state === "running" || run.state === "paused") ? run : null;
});

/** My run, when another live run holds the stage. */
export const offStage = computed(() => {
  const { asked, now } = myWork.value ?? {};
  const held = stage.value?.run_id;
  if (!asked || !held || !isActive(shownRun.value)) return null;
  return [asked.id, now.id, ...trainingIds(asked)].includes(held) ? null : now;
});

const WALK = ["divisions", "grid_side_m", "observation", "simulator"];
const presetOf = (robot) => (typeof robot === "string" ? robot : robot?.preset);

const fits = (training, values) =>
  hasTable(training) &&
  training.config.gait === values.gait &&
  presetOf(training.config.robot) === values.robot &&
  WALK.every((field) => training.config[field] === undefined || training.config[field] === values[field]);

/** The newest table that fits the form, of what is on stage or what I started. */
export const tableInHand = computed(() => {
  const known = [raceInView.value, shownRun.value, ...mine.value.map(get)];
  const trainings = known.flatMap((run) =>
    run?.kind === "race" ? trainingIds(run).map(get) : [run],
  );
  return trainings.find((run) => run && fits(run, form.value)) ?? null;
});

/** Whether the race in view has been run, so that "again" means something. */
export const raceIsRun = computed(() => {
  const race = raceInView.value;
  return race?.state === "finished" && trainingIds(race).includes(tableInHand.value?.id);
});

/** How many transitions a look-ahead agent simulates for a decision. */
export function futures(depth, { gait, divisions }) {
  const pairs = options.value?.gaits?.find(({ name }) => name === gait)?.pairs.length ?? 3;
  const cells = divisions ** 2 + (divisions % 2 === 0 ? 1 : 0);
  const moves = pairs * (cells - 1);
  let total = 0;
  for (let level = 1; level <= depth; level += 1) total += moves ** level;
  return total;
}
