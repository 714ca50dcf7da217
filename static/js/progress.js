// How far the work is and how long it takes, in words and as a share.
import { computed } from "@preact/signals";
import { count, duration, whole } from "./format.js";
import { work } from "./selectors.js";
import { scene, stage } from "./store.js";

/** Run id → when this page first saw it move: {at, done}. */
const firstSeen = new Map();

function secondsLeft(run) {
  if (Number.isFinite(run.eta_s)) return run.eta_s;
  const { done, total } = run.progress;
  const now = performance.now() / 1000;
  if (!firstSeen.has(run.id)) firstSeen.set(run.id, { at: now, done });
  const first = firstSeen.get(run.id);
  return done > first.done ? ((total - done) * (now - first.at)) / (done - first.done) : null;
}

const verbs = { training: "Practising", race: "Simulating the race" };

/** {label, left, share} of what computes, else of what is shown; null if nothing goes on. */
export const progress = computed(() => (work.value ? ofWork(work.value) : ofShow(scene.value)));

function ofWork({ asked, now }) {
  const { done, total } = now.progress;
  const share = total ? done / total : 0;
  const then = asked === now ? "" : ", then the race";
  if (now.state === "queued") return { label: `Waiting for its turn${then}`, left: "", share: 0 };
  const steps = `${whole(done)} of ${count(total, "step")}`;
  if (now.state === "paused") return { label: `Paused at ${steps}${then}`, left: "", share };
  const seconds = secondsLeft(now);
  const left = seconds === null ? "" : `${duration(seconds)} left`;
  return { label: `${verbs[now.kind] ?? "Running"}, ${steps}${then}`, left, share };
}

function ofShow(shown) {
  if (!shown || shown.kind === "idle" || !shown.duration_s) return null;
  if (["finished", "waiting", "start-line"].includes(shown.phase)) return null;
  const speed = shown.shown_speed || 1;
  const rest = Math.max(0, shown.duration_s - shown.time_s) / speed;
  const verb = shown.replay ? "Showing again" : "Showing";
  const isTimeLapse = shown.kind === "training" && stage.value?.speed === "time-lapse";
  const paused = stage.value?.playing === false;
  return {
    label: paused ? "The picture is paused" : `${verb} the ${shown.kind}`,
    left: paused || isTimeLapse ? "" : `${duration(rest)} left`,
    share: shown.time_s / shown.duration_s,
  };
}
