// The learning curve of the training in view, with the trainings that it continues.
import { computed, effect, signal } from "@preact/signals";
import { getCurve, getRun } from "./api.js";
import { trainingInView } from "./selectors.js";
import { connection, evaluations, references, requestRun, runs, scene, setEntry } from "./store.js";

/** @import { Signal } from "@preact/signals" */
/** @import { Evaluation, Run } from "./types.js" */

/** A point of the curve; steps count all practice. @typedef {{ step: number, distance_m: number }} CurvePoint */

const LONGEST_CHAIN = 20;

/** Run id → evaluations that were requested. @type {Signal<Record<string, Evaluation[]>>} */
const requested = signal({});
/** Run id → greedy's distance as the curve's answer has it [m]. @type {Signal<Record<string, number>>} */
const requestedReferences = signal({});

/**
 * A training and those that it continues, oldest first.
 * @param {Run | null | undefined} training
 */
export function chainOf(training) {
  /** @type {Run[]} */
  const found = [];
  let run = training;
  while (run && found.length < LONGEST_CHAIN) {
    found.unshift(run);
    run = runs.value.get(run.config?.continue_from ?? "");
  }
  return found;
}

const chain = computed(() => chainOf(trainingInView.value));

/** @param {string} id */
const evaluationsOf = (id) => {
  /** @type {Map<number, Evaluation>} */
  const byStep = new Map();
  for (const one of [...(requested.value[id] ?? []), ...(evaluations.value[id] ?? [])]) {
    byStep.set(one.step, one);
  }
  return [...byStep.values()].sort((a, b) => a.step - b.step);
};

/**
 * The curve of the training in view, null without one. `blocks` are the steps at which one training
 * ended and the next continued it.
 */
export const curve = computed(() => {
  const trainings = chain.value;
  const run = trainings.at(-1);
  if (!run) return null;
  /** @type {CurvePoint[]} */
  const points = [{ step: 0, distance_m: 0 }];
  /** @type {number[]} */
  const blocks = [];
  let from = 0;
  for (const part of trainings) {
    if (part !== trainings[0]) blocks.push(from);
    const shown = evaluationsOf(part.id).filter(({ step }) => step <= shownUpTo(part));
    points.push(...shown.map((one) => ({ ...one, step: from + one.step })));
    if (part !== run) from += part.progress?.done ?? 0;
  }
  const greedy_m = [run, ...trainings].map(greedyOf).find(Number.isFinite) ?? null;
  return { run, points, from, to: from + run.config.steps, greedy_m, blocks };
});

/**
 * The last step to be shown: the stage lags behind the computation, and the curve follows the stage.
 * @param {Run} run
 */
const shownUpTo = ({ id }) => {
  const { run_id, kind, phase, lanes = [] } = scene.value ?? {};
  return run_id === id && kind === "training" && phase !== "finished" ? lanes[0]?.step ?? 0 : Infinity;
};

/** @param {Run} run */
const greedyOf = ({ id, result, greedy_distance_m }) =>
  greedy_distance_m ?? references.value[id] ?? requestedReferences.value[id] ?? result?.greedy_distance_m;

/**
 * All steps of practice behind a training's table.
 * @param {Run} training
 */
export const practisedSteps = (training) =>
  chainOf(training).reduce((total, { progress }) => total + (progress?.done ?? 0), 0);

/** @param {string} id */
async function load(id) {
  const answer = await getCurve(id).catch(() => null);
  if (!answer) return;
  setEntry(requested, id, answer.evaluations);
  if (answer.greedy_distance_m !== null) setEntry(requestedReferences, id, answer.greedy_distance_m);
}

/** Request what the event stream did not deliver: evaluations before the page was open or while it was offline. */
export function followCurves() {
  const wanted = computed(() => (connection.value === "live" ? chain.value.map(({ id }) => id).join(" ") : ""));
  effect(() => wanted.value.split(" ").filter(Boolean).forEach(load));

  const unknown = computed(() => {
    const id = chain.value[0]?.config?.continue_from;
    return id && !runs.value.has(id) ? id : null;
  });
  effect(() => {
    const id = unknown.value;
    if (id) requestRun(() => getRun({ kind: "training", id })).catch(() => {});
  });
}
