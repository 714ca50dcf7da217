// Changes of a training that runs: its live settings, its pace, and disturbances.
import { attempt, problems } from "./actions.js";
import * as api from "./api.js";
import { changesSomething, conditionsNow } from "./disturbances.js";
import { setField } from "./form.js";
import { whole } from "./format.js";
import { liveTraining } from "./on-stage.js";
import { isActive, isOperator } from "./selectors.js";
import { rates, runs, setEntry } from "./store.js";

/** @import { RequestError } from "./api.js" */
/** @import { Change, Disturbance, Rates, Run } from "./types.js" */

const TUNE_MS = 120;
/** Changes that are not yet sent. @type {Rates | null} */
let unsent = null;
/** The newest request: two on their way at once could overtake each other, and an older value would stay. */
let lastTuned = Promise.resolve();

/**
 * Change settings of the live training from its next step on; requests are sent one by one, at most every 120 ms.
 * @param {Rates} changes
 */
export function tune(changes) {
  const run = liveTraining.value;
  if (!run || !isOperator.value) return;
  setEntry(rates, run.id, { ...rates.value[run.id], ...changes });
  if (unsent) {
    Object.assign(unsent, changes);
    return;
  }
  unsent = { ...changes };
  const pause = new Promise((resolve) => {
    setTimeout(resolve, TUNE_MS);
  });
  lastTuned = Promise.all([lastTuned, pause]).then(async () => {
    const sent = unsent ?? {};
    unsent = null;
    await api.tuneTraining(run.id, sent).then(
      () => setEntry(problems, "tune", null),
      (error) => refuseTuning(run, sent, error),
    );
  });
}

/** @type {(run: Run, sent: Rates, error: RequestError) => void} */
function refuseTuning(run, sent, error) {
  const remaining = Object.entries(rates.value[run.id] ?? {}).filter(([name, value]) => sent[name] !== value);
  setEntry(rates, run.id, Object.fromEntries(remaining));
  const run_ = runs.value.get(run.id);
  const isTooLate = error.status === CONFLICT && !isActive(run_);
  setEntry(problems, "tune", isTooLate ? new api.RequestError(tooLate(run_ ?? run)) : error);
}

const CONFLICT = 409;

/** Why a change of a training that has ended was refused, and what to do. @param {Run} run */
const tooLate = ({ progress: { done, total } }) =>
  `The training was computed up to step ${whole(done)} of ${whole(total)} when the change arrived, so it has no ` +
  "effect there. The next training starts with it; to steer one while you watch, practise at the pace of the picture.";

/** Times real time: a pace at which a practice can be watched and steered. */
const WATCHABLE_PACE = 4;

/** Let the training that runs, or else the next one, practise at the pace of the picture. */
export function practiseAtPaceOfPicture() {
  setField("pace", WATCHABLE_PACE);
  setEntry(problems, "tune", null);
  tune({ pace: WATCHABLE_PACE });
}

// ---- disturbances

/** Newest disturbance: an answer waits for the end of a step, in which the next leg may be clicked. */
let lastChange = Promise.resolve(/** @type {{ id: string, changes: Change[] } | null} */ (null));

/**
 * Disturb a training from its next step on, after earlier disturbances were sent; skip one that changes nothing.
 * @param {Run} run
 * @param {Disturbance} disturbance without its step
 */
export function disturb(run, disturbance) {
  lastChange = lastChange.then(async (last) => {
    const newest = runs.value.get(run.id) ?? run;
    // The event that tells of the last one may come after its answer.
    const changes = [...newest.changes ?? [], ...(last?.id === run.id ? last.changes : [])];
    if (!changesSomething(disturbance, conditionsNow({ ...newest, changes }), newest.config.robot)) return last;
    const happened = await attempt("disturb", () => api.disturbTraining(run.id, disturbance));
    return happened && { id: run.id, changes: [{ step: happened.at_step, disturbance: happened }] };
  });
  return lastChange;
}
