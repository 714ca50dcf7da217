// Small learning curves for the rows of the list: those of many trainings at once, with few points each.
import { effect, signal } from "@preact/signals";
import { getCurves, isLasting } from "./api.js";
import { page } from "./page-state.js";
import { shownRuns } from "./run-list.js";
import { connection, evaluations, served } from "./store.js";

/** @import { Signal } from "@preact/signals" */
/** @import { RequestError } from "./api.js" */

/** [step, distance m] @typedef {[number, number]} Point */

const RETRY_MS = 3000;

/** Run id → the points that were requested. @type {Signal<Record<string, Point[]>>} */
const requested = signal({});
/** Ids that were asked for since the connection began. @type {Set<string>} */
const requestedIds = new Set();

/**
 * The points of a training's curve: those that were requested, and the evaluations since.
 * @param {string} id
 * @returns {Point[]}
 */
export function pointsOf(id) {
  const points = requested.value[id] ?? [];
  const last = points.at(-1)?.[0] ?? 0;
  const since = (evaluations.value[id] ?? []).filter(({ step }) => step > last);
  return [...points, ...since.map(({ step, distance_m }) => /** @type {Point} */ ([step, distance_m]))];
}

/** @param {string[]} ids @throws {RequestError} */
async function load(ids) {
  const { curves } = await getCurves(ids);
  const points = curves.map(({ id, steps, distances_m }) => {
    const all = steps.map((step, n) => [step, distances_m[n]]);
    return [id, all.filter(([, distance_m]) => distance_m !== null)];
  });
  requested.value = { ...requested.value, ...Object.fromEntries(points) };
}

/** Request the curves of the trainings that are listed, as many at once as the server answers. */
export function followThumbnails() {
  effect(() => {
    if (connection.value !== "live") requestedIds.clear();
    else if (page.view.value === "runs") request();
  });
}

function request() {
  const ids = shownRuns.value.filter(({ kind }) => kind === "training").map(({ id }) => id);
  const missing = ids.filter((id) => !requestedIds.has(id)).slice(0, served().limits.run_ids[1] ?? undefined);
  if (missing.length === 0) return;
  missing.forEach((id) => requestedIds.add(id));
  load(missing).then(request, (/** @type {RequestError} */ error) => {
    if (isLasting(error)) return;
    setTimeout(() => {
      missing.forEach((id) => requestedIds.delete(id));
      if (connection.peek() === "live" && page.view.peek() === "runs") request();
    }, RETRY_MS);
  });
}
