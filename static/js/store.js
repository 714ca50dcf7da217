// What the page knows of the server, as signals. Only `applyEvent`, `keepRun` and `dropRun` write to it.
import { batch, signal } from "@preact/signals";

/** "connecting", "live" or "reconnecting". */
export const connection = signal("connecting");
export const version = signal(null);
/** Whether this server shows itself only to those who have its link. */
export const isLockedOut = signal(false);
/** Null until the snapshot says; then "operator" or "spectator". */
export const role = signal(null);
export const viewers = signal(null);
export const options = signal(null);
/** Every run that was heard of, by id. */
export const runs = signal(new Map());
/** By id the runs that the server cannot read; they are listed, can be deleted, and nothing else. */
export const damagedRuns = signal(new Map());
/** What everyone is shown, as GET /stage has it. */
export const stage = signal(null);
/** What everyone sees right now, about five times a second. */
export const scene = signal(null);
/** Evaluations that came in while the page was open: run id → [{step, distance_m, epsilon}]. */
export const evaluations = signal({});
/** Run id → how far greedy gets on the same robot [m]. */
export const references = signal({});
/** Run id → the newest rates and pace that someone set while it ran. */
export const rates = signal({});

/** Run id → how many trials the newest summary of that experiment is of. */
export const summarised = signal({});

const put = (map, key, value) => (map.value = { ...map.value, [key]: value });

const handlers = {
  snapshot(data) {
    version.value = data.version ?? null;
    role.value = data.role ?? "operator";
    viewers.value = data.viewers ?? null;
    const byId = (some) => new Map(some.map((run) => [run.id, run]));
    runs.value = byId((data.runs ?? []).filter((run) => !run.damaged));
    damagedRuns.value = byId((data.runs ?? []).filter((run) => run.damaged));
    stage.value = data.stage ?? null;
    scene.value = data.scene ?? null;
  },
  run: (data) => keepRun(data),
  "run-deleted": ({ id }) => dropRun(id),
  evaluation({ run_id, ...evaluation }) {
    put(evaluations, run_id, [...(evaluations.value[run_id] ?? []), evaluation]);
  },
  reference: ({ run_id, greedy_distance_m }) => put(references, run_id, greedy_distance_m),
  rates: ({ run_id, ...changed }) =>
    put(rates, run_id, { ...rates.value[run_id], ...changed }),
  stage: (data) => (stage.value = data),
  summary: ({ run_id, done }) => put(summarised, run_id, done),
  viewers: ({ count }) => (viewers.value = count),
  scene: (data) => (scene.value = data),
};

export const applyEvent = (name, data) => batch(() => handlers[name]?.(data));

/** Take in a run as an answer or an event has it. */
export function keepRun(run) {
  const [its, other] = run.damaged ? [damagedRuns, runs] : [runs, damagedRuns];
  its.value = new Map(its.value).set(run.id, run);
  if (other.value.has(run.id)) other.value = without(other.value, run.id);
}

export const dropRun = (id) =>
  batch(() => {
    runs.value = without(runs.value, id);
    damagedRuns.value = without(damagedRuns.value, id);
  });

function without(map, id) {
  const left = new Map(map);
  left.delete(id);
  return left;
}
