// The training in view: its learning curve, with the trainings that it continues, and its action values.
import { computed, effect, signal } from "@preact/signals";
import { getCurve, isLasting } from "./api.js";
import { disturbancesOf, joinedBySteps } from "./disturbances.js";
import { count, decimal, t } from "./format.js";
import { followRuns } from "./runs.js";
import { trainingInView } from "./on-stage.js";
import { agentOf } from "./settings.js";
import { bestKnown, connection, evaluations, rates, references, runs, scene, setEntry } from "./store.js";

/** @import { ReadonlySignal, Signal } from "@preact/signals" */
/** @import { RequestError } from "./api.js" */
/** @import { ActionValues, Disturbance, Evaluation, Rates, Run, RunConfig, SettingValue } from "./types.js" */

/**
 * A point of the curve; steps count all practice. The first, before any, has no ε.
 * @typedef {{ step: number, distance_m: number, epsilon?: number }} CurvePoint
 */

const LONGEST_CHAIN = 20;
const RETRY_MS = 3000;

/** Run id → evaluations that were requested. @type {Signal<Record<string, Evaluation[]>>} */
const requested = signal({});
/** Run id → the best known distance as the curve's answer has it [m]. @type {Signal<Record<string, number | null>>} */
const requestedBest = signal({});
/** Run id → greedy's distance as the curve's answer has it [m]. @type {Signal<Record<string, number>>} */
const requestedReferences = signal({});

/**
 * A training and those that it continues, oldest first.
 * @param {Run | null | undefined} training
 */
function chainOf(training) {
  /** @type {Run[]} */
  const chain = [];
  let run = training;
  while (run && chain.length < LONGEST_CHAIN) {
    chain.unshift(run);
    run = runs.value.get(run.config?.continue_from ?? "");
  }
  return chain;
}


/** @param {string} id */
const evaluationsOf = (id) => {
  /** @type {Map<number, Evaluation>} */
  const byStep = new Map();
  for (const evaluation of [...(requested.value[id] ?? []), ...(evaluations.value[id] ?? [])]) {
    byStep.set(evaluation.step, evaluation);
  }
  return [...byStep.values()].sort((a, b) => a.step - b.step);
};

/** The curve of the training in view, null without one; as far as the stage shows it. */
export const curve = computed(() => (trainingInView.value ? curveOf(trainingInView.value, shownUpTo) : null));

/**
 * The curve of a training, with those that it continues. `blocks` are the steps at which one training
 * ended and the next continued it, `changes` those at which live settings changed; `disturbances` are disturbances.
 * @param {Run} run
 * @param {(part: Run) => number} [upTo] the last step of a training that is shown
 */
export function curveOf(run, upTo = () => Infinity) {
  const trainings = chainOf(run);
  /** @type {CurvePoint[]} */
  const points = [{ step: 0, distance_m: 0 }];
  /** @type {number[]} */
  const blocks = [];
  /** @type {RateChange[]} */
  const changes = [];
  /** @type {Disturbance[]} */
  const disturbances = [];
  let from = 0;
  for (const training of trainings) {
    if (training !== trainings[0]) blocks.push(from);
    const last = upTo(training);
    const shown = evaluationsOf(training.id).filter(({ step }) => step <= last);
    points.push(...shown.map((evaluation) => ({ ...evaluation, step: from + evaluation.step })));
    changes.push(...rateChanges(training, from).filter(({ step }) => step <= from + last));
    const happened = disturbancesOf(training).filter(({ at_step }) => at_step <= last);
    disturbances.push(...happened.map((disturbance) => movedBy(disturbance, from)));
    if (training !== run) from += training.progress?.done ?? 0;
  }
  const greedy_m = [run, ...trainings].map(greedyOf).find(Number.isFinite) ?? null;
  const to = from + run.config.steps;
  const best_known_m = bestKnownOf(run);
  return { run, points, from, to, greedy_m, best_known_m, blocks, changes, disturbances: joinedBySteps(disturbances) };
}

/** A disturbance in the steps of all practice. @type {(disturbance: Disturbance, from: number) => Disturbance} */
const movedBy = ({ at_step, until_step, ...disturbance }, from) => ({
  ...disturbance, at_step: from + at_step, ...(until_step ? { until_step: from + until_step } : {}),
});

/**
 * The last step to be shown: the stage lags behind the computation, and the curve follows the stage.
 * @param {Run} run
 */
const shownUpTo = ({ id }) => {
  const { run_id, kind, phase, lanes = [] } = scene.value ?? {};
  return run_id === id && kind === "training" && phase !== "finished" ? lanes[0]?.steps_made ?? 0 : Infinity;
};

/** @param {Run} run */
const greedyOf = ({ id, result, greedy_distance_m }) =>
  greedy_distance_m ?? references.value[id] ?? requestedReferences.value[id] ?? result?.greedy_distance_m;

/** Of the world as it is now: the end's, the newest that was announced, or that of the request. @param {Run} run */
const bestKnownOf = ({ id, result }) =>
  [result?.best_known_m, bestKnown.value[id], requestedBest.value[id]].find((best_m) => best_m !== undefined) ?? null;

/**
 * All steps of practice behind a training's table.
 * @param {Run} training
 */
export const practisedSteps = (training) =>
  chainOf(training).reduce((total, { progress }) => total + (progress?.done ?? 0), 0);

/** @param {string} id @throws {RequestError} */
async function load(id) {
  const answer = await getCurve(id);
  setEntry(requested, id, answer.evaluations);
  setEntry(requestedBest, id, answer.best_known_m);
  if (answer.greedy_distance_m !== null) setEntry(requestedReferences, id, answer.greedy_distance_m);
}

/**
 * Request what the event stream did not deliver of the curves of trainings: evaluations before the page was open or
 * while it was offline, and the trainings that they continue.
 * @param {ReadonlySignal<Run[]>} trainings
 */
export function followCurves(trainings) {
  const chains = computed(() => trainings.value.map(chainOf));
  const wanted = computed(() => {
    const ids = new Set(chains.value.flat().map(({ id }) => id));
    return connection.value === "live" ? [...ids].join(" ") : "";
  });
  /** Those that were requested and are wanted since. @type {Set<string>} */
  let requestedIds = new Set();
  const request = (/** @type {string} */ id) =>
    load(id).catch((/** @type {RequestError} */ error) => {
      if (isLasting(error)) {
        requestedIds.delete(id);
        return;
      }
      setTimeout(() => wanted.peek().split(" ").includes(id) && request(id), RETRY_MS);
    });
  effect(() => {
    const before = requestedIds;
    requestedIds = new Set(wanted.value.split(" ").filter(Boolean));
    [...requestedIds].filter((id) => !before.has(id)).forEach(request);
  });
  followRuns(computed(() => chains.value.flatMap(([first]) => first.config.continue_from ?? [])));
}

/** The training in view, if any. */
export const trainingsInView = computed(() => (trainingInView.value ? [trainingInView.value] : []));

// ---- the action values of one state: the best move, and the names of places on the foot grid

/** Grids with more cells are named by distances, in millimetres. */
const MAX_NAMED_CELLS = 5;

/**
 * The move of the highest value; pair and cell are -1 where there is none.
 * @param {Pick<ActionValues, "values_m">} known
 */
export function bestMove({ values_m }) {
  let best = { pair: -1, cell: -1, value: -Infinity };
  values_m.forEach((row, pair) =>
    row.forEach((value, cell) => {
      if (value !== null && value > best.value) best = { pair, cell, value };
    }),
  );
  return best;
}

/** Where a foot is, by the server's name of its cell. @type {Record<string, string>} */
const CELLS = {
  "home": t("home"), "left": t("left"), "right": t("right"), "front": t("front"), "back": t("back"),
  "front left": t("front left"), "front right": t("front right"), "back left": t("back left"),
  "back right": t("back right"),
};

/**
 * The name of a cell: "front left", or on finer grids "20 left, 10 front".
 * @param {Pick<ActionValues, "cell_names" | "cells_m">} known
 * @param {number} cell
 * @param {string} unit after each number
 */
export function cellName({ cell_names, cells_m }, cell, unit = "") {
  if (cell === 0 || cell_names.length <= MAX_NAMED_CELLS) return CELLS[cell_names[cell]] ?? cell_names[cell];
  const [x, y] = cells_m[cell].map((metres) => Math.round(1000 * metres));
  const parts = [
    x && `${Math.abs(x)}${unit} ${x < 0 ? CELLS.left : CELLS.right}`,
    y && `${Math.abs(y)}${unit} ${y > 0 ? CELLS.front : CELLS.back}`,
  ];
  return parts.filter(Boolean).join(", ");
}

// ---- changes of live settings and pace while a training ran: the values that hold, and the changes in words

/** A setting's new value from a step on. @typedef {{ name: string, value: SettingValue, step: number }} RateChange */

/** A slider that is dragged sends values in a row; those within this share of the training are one change. */
const BURST_SHARE = 0.02;

/**
 * Values that were changed while a run ran, as they hold at its end.
 * @param {Run} run
 * @returns {Rates}
 */
const changedValues = ({ changes = [] }) =>
  Object.fromEntries(changes.flatMap(({ pace = null, settings = {} }) => Object.entries({ ...settings, pace }))
    .filter(([, value]) => value !== null));

/**
 * Pace and live settings of a run that were changed, with what this page has sent and not yet seen confirmed.
 * @param {Run} run
 * @returns {Rates}
 */
export const presentRates = (run) => ({ ...changedValues(run), ...rates.value[run.id] });

/**
 * The config of a run with the values that hold at its end. A live setting that is none of the config, as ε, stands
 * for all settings of its symbol.
 * @param {Run} run
 * @returns {RunConfig}
 */
export function configAtEnd(run) {
  const { settings, live_settings } = agentOf(run.config.agent);
  const { pace: newest, ...changed } = changedValues(run);
  const values = Object.entries(changed).flatMap(([name, value]) => {
    if (name in run.config.settings) return [[name, value]];
    const symbol = live_settings[name]?.symbol ?? name;
    const same = Object.keys(settings).filter((setting) => settings[setting].symbol === symbol);
    return same.map((setting) => [setting, value]);
  });
  const pace = /** @type {RunConfig["pace"]} */ (newest ?? run.config.pace);
  return { ...run.config, pace, settings: { ...run.config.settings, ...Object.fromEntries(values) } };
}

/**
 * The changes of a run's live settings, those of a slider that was dragged as one.
 * @param {Run} run
 * @param {number} [offset] added to each step
 * @returns {RateChange[]}
 */
export function rateChanges({ changes = [], config }, offset = 0) {
  /** @type {RateChange[]} */
  const rateList = [];
  for (const { step, settings = {} } of changes) {
    for (const [name, value] of Object.entries(settings)) {
      if (value === null) continue;
      const before = rateList.findLast((change) => change.name === name);
      const isBurst = before && offset + step - before.step <= BURST_SHARE * config.steps;
      if (isBurst) Object.assign(before, { value, step: offset + step });
      else rateList.push({ name, value, step: offset + step });
    }
  }
  return rateList.sort((a, b) => a.step - b.step);
}

/** @type {(agent: string, change: Pick<RateChange, "name" | "value">) => string} */
export function rateInWords(agent, { name, value }) {
  const { symbol, title } = agentOf(agent).live_settings[name] ?? { symbol: null, title: name };
  return `${symbol ?? title}\u00a0${decimal(String(value))}`;
}

/**
 * The last change of each setting: "α 0.5 from step 136", with how many there were if more than one.
 * @param {string} agent
 * @param {RateChange[]} changes in the order of their steps
 */
export const changesInWords = (agent, changes) =>
  [...new Set(changes.map(({ name }) => name))].map((name) => {
    const ofName = changes.filter((change) => change.name === name);
    const last = ofName[ofName.length - 1];
    const remark = ofName.length > 1 ? ` (${count(ofName.length, "change")})` : "";
    return t("{change} from step {step}", { change: rateInWords(agent, last), step: last.step }) + remark;
  });
