// The progress of the running work, or of the playback, in words and as a share.
import { computed } from "@preact/signals";
import { count, duration, whole } from "./format.js";
import { work } from "./selectors.js";
import { scene, stage } from "./store.js";

/** @import { Run, Scene } from "./types.js" */

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

/** {label, left, share} of the work, else of the playback; null while there is neither. */
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
    label: isPaused ? "The playback is paused" : `${verb} the ${shown.kind}`,
    left: isPaused || isTimeLapse ? "" : `${duration(rest)} left`,
    share: shown.time_s / shown.duration_s,
  };
}
