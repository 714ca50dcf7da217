// The server's state as signals. Written by `applyEvent` and `upsertRun`, and by answers to requests.
import { batch, signal } from "@preact/signals";

/** @import { Signal } from "@preact/signals" */
/** @import { DamagedRun, Evaluation, Options, Rates, Run, Scene, Stage } from "./types.js" */

/** @type {Signal<"connecting" | "live" | "reconnecting">} */
export const connection = signal("connecting");
/** The server's version. @type {Signal<string | null>} */
export const version = signal(null);
/** Whether the server refuses this page because it lacks the link's token. */
export const isLockedOut = signal(false);
/** Null until the first snapshot. @type {Signal<"operator" | "spectator" | null>} */
export const role = signal(null);
/** How many pages watch the stage. @type {Signal<number | null>} */
export const viewers = signal(null);
/** Null until the server has answered. @type {Signal<Options | null>} */
export const options = signal(null);
/** The options, for code that runs only once they are known: components, and what they call. */
export const served = () => /** @type {Options} */ (options.value);
/** Every known run by id. @type {Signal<Map<string, Run>>} */
export const runs = signal(new Map());
/** Runs that the server cannot read, by id: listed, and can be deleted. @type {Signal<Map<string, DamagedRun>>} */
export const damagedRuns = signal(new Map());
/** The stage as GET /stage has it. @type {Signal<Stage | null>} */
export const stage = signal(null);
/** The moment that is shown, updated about five times a second. @type {Signal<Scene | null>} */
export const scene = signal(null);
/** Run id → evaluations received while the page was open. @type {Signal<Record<string, Evaluation[]>>} */
export const evaluations = signal({});
/** Run id → greedy's distance on the same robot [m]. @type {Signal<Record<string, number>>} */
export const references = signal({});
/** Run id → the rates and pace that were changed while it ran. @type {Signal<Record<string, Rates>>} */
export const rates = signal({});
/** Run id → number of trials in that experiment's newest summary. @type {Signal<Record<string, number>>} */
export const summarised = signal({});

/**
 * Set one entry of a record in a signal.
 * @template Value
 * @param {Signal<Record<string, Value>>} record
 * @param {string} key
 * @param {Value} value
 */
export const setEntry = (record, key, value) => {
  record.value = { ...record.value, [key]: value };
};

/** @type {Record<string, (data: any) => void>} */
const handlers = {
  snapshot(data) {
    version.value = data.version ?? null;
    role.value = data.role ?? "operator";
    viewers.value = data.viewers ?? null;
    runs.value = new Map();
    damagedRuns.value = new Map();
    (data.runs ?? []).forEach(upsertRun);
    stage.value = data.stage ?? null;
    scene.value = data.scene ?? null;
  },
  run: (data) => upsertRun(data),
  "run-deleted": ({ id }) => forgetRun(id),
  evaluation({ run_id, ...evaluation }) {
    setEntry(evaluations, run_id, [...(evaluations.value[run_id] ?? []), evaluation]);
  },
  reference: ({ run_id, greedy_distance_m }) => setEntry(references, run_id, greedy_distance_m),
  rates: ({ run_id, ...changed }) => setEntry(rates, run_id, { ...rates.value[run_id], ...changed }),
  stage: (data) => (stage.value = data),
  summary: ({ run_id, done }) => setEntry(summarised, run_id, done),
  viewers: (data) => (viewers.value = data.count),
  scene: (data) => (scene.value = data),
};

/**
 * Apply a server-sent event. Unknown names are ignored.
 * @param {string} name
 * @param {any} data
 */
export const applyEvent = (name, data) => batch(() => handlers[name]?.(data));

/**
 * Insert a run, or replace the version that is known.
 * @param {Run | DamagedRun} run
 */
export const upsertRun = (run) =>
  batch(() => {
    forgetRun(run.id);
    if ("damaged" in run) damagedRuns.value = new Map(damagedRuns.value).set(run.id, run);
    else runs.value = new Map(runs.value).set(run.id, run);
  });

/**
 * Remove a run that was deleted.
 * @param {string} id
 */
export const forgetRun = (id) =>
  batch(() => {
    if (runs.value.has(id)) runs.value = without(runs.value, id);
    if (damagedRuns.value.has(id)) damagedRuns.value = without(damagedRuns.value, id);
  });

/**
 * @template Value
 * @param {Map<string, Value>} map
 * @param {string} key
 */
function without(map, key) {
  const left = new Map(map);
  left.delete(key);
  return left;
}
