// Why a learner loses: the question about a lane of the race that is shown, and the server's answer.
import { computed, signal } from "@preact/signals";
import { keepAnswer } from "../../js/api.js";
import { getLoss } from "./api.js";
import { clock, raceInView } from "../../js/on-stage.js";
import { isLoser } from "../../js/race.js";
import { moment } from "./steps.js";
import { connection } from "../../js/store.js";

/** @import { Signal } from "@preact/signals" */
/** @import { Reply } from "../../js/api.js" */
/** @import { Loss } from "../../js/types.js" */

/** Lane of a race under a clock. @typedef {{ run_id: string, lane: number, clock: string }} LostLane */

/** The lane that is looked at, if it is asked why it loses; null otherwise. @type {Signal<LostLane | null>} */
export const lostLane = computed(() => {
  const [race, at] = [raceInView.value, moment.value];
  if (!race || at?.run_id !== race.id || !isLoser(at.lane)) return null;
  return { run_id: race.id, lane: at.lane, clock: clock.value };
});

/** Whether the answer is unfolded; it is asked for only then. */
export const isOpen = signal(false);
/** Whether the board has sent here for it: the page goes to the answer once. */
export const isSought = signal(false);

/** @type {Signal<Reply<Loss>>} */
export const loss = signal({ answer: null, error: null, again: false });

/** Keep the answer about the lane that is looked at, until the function that is returned is called. */
export const followLoss = () => keepAnswer(
  () => {
    const isLive = connection.value === "live";
    // A race that goes on or was stopped is another one after more steps.
    const { state, progress } = raceInView.value ?? { state: "", progress: { done: 0 } };
    if (!isLive || !isOpen.value || !lostLane.value) return "";
    return JSON.stringify({ ...lostLane.value, state, done: progress.done });
  },
  (key) => getLoss(JSON.parse(key)),
  loss,
  () => 0,
);

/** Whether an answer is about a lane. @param {Loss} answer @param {LostLane} settings */
export const isAbout = (answer, settings) =>
  answer.run_id === settings.run_id && answer.lane === settings.lane && answer.clock === settings.clock;
