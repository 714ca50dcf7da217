// The learning curve of the training in view, with the practice that it went on from before it.
import { computed, effect, signal } from "@preact/signals";
import { getCurve, getRun } from "./api.js";
import { trainingInView } from "./selectors.js";
import { connection, evaluations, keepRun, references, runs, scene } from "./store.js";

const LONGEST_CHAIN = 20;

/** Run id → the evaluations that the server had when it was asked. */
const fetched = signal({});
/** Run id → greedy's distance, as the curve's answer has it. */
const fetchedReferences = signal({});

/** The training, and those that it went on from: oldest first. */
const chain = computed(() => {
  const found = [];
  let run = trainingInView.value;
  while (run && found.length < LONGEST_CHAIN) {
    found.unshift(run);
    run = runs.value.get(run.config?.continue_from) ?? null;
  }
  return found;
});

const evaluationsOf = (id) => {
  const byStep = new Map();
  for (const one of [...(fetched.value[id] ?? []), ...(evaluations.value[id] ?? [])]) {
    byStep.set(one.step, one);
  }
  return [...byStep.values()].sort((a, b) => a.step - b.step);
};

/**
 * {run, points: [{step, distance_m}], from, to, greedy_m, blocks: [step…]}: steps count from the
 * beginning of all practice; `blocks` is where one training ended and the next went on.
 */
export const curve = computed(() => {
  const runsOfIt = chain.value;
  const run = runsOfIt.at(-1);
  if (!run) return null;
  const points = [{ step: 0, distance_m: 0 }];
  const blocks = [];
  let from = 0;
  for (const part of runsOfIt) {
    if (part !== runsOfIt[0]) blocks.push(from);
    const shown = evaluationsOf(part.id).filter(({ step }) => step <= shownUpTo(part));
    points.push(...shown.map((one) => ({ ...one, step: from + one.step })));
    if (part !== run) from += part.progress?.done ?? 0;
  }
  const greedy_m = [run, ...runsOfIt].map(greedyOf).find(Number.isFinite) ?? null;
  return { run, points, from, to: from + run.config.steps, greedy_m, blocks };
});

/** The curve grows with the picture, which is slower than the computer. */
const shownUpTo = ({ id }) => {
  const { run_id, kind, phase, lanes } = scene.value ?? {};
  return run_id === id && kind === "training" && phase !== "finished" ? lanes[0]?.step ?? 0 : Infinity;
};

const greedyOf = ({ id, result, greedy_distance_m }) =>
  greedy_distance_m ?? references.value[id] ?? fetchedReferences.value[id] ?? result?.greedy_distance_m;

/** How much a learner has practised in all. */
export function practised(run) {
  let total = 0;
  for (let part = run, n = 0; part && n < LONGEST_CHAIN; n += 1) {
    total += part.progress?.done ?? 0;
    part = runs.value.get(part.config?.continue_from);
  }
  return total;
}

async function load(id) {
  const answer = await getCurve(id).catch(() => null);
  if (!answer) return;
  fetched.value = { ...fetched.value, [id]: answer.evaluations };
  if (Number.isFinite(answer.greedy_distance_m)) {
    fetchedReferences.value = { ...fetchedReferences.value, [id]: answer.greedy_distance_m };
  }
}

/** Keep the curve complete: what came before this page was open, or while it was cut off. */
export function followCurves() {
  const wanted = computed(() =>
    connection.value === "live" ? chain.value.map(({ id }) => id).join(" ") : "",
  );
  effect(() => wanted.value.split(" ").filter(Boolean).forEach(load));

  const unknown = computed(() => {
    const id = chain.value[0]?.config?.continue_from;
    return id && !runs.value.has(id) ? id : null;
  });
  effect(() => {
    if (unknown.value) getRun({ kind: "training", id: unknown.value }).then(keepRun, () => {});
  });
}
