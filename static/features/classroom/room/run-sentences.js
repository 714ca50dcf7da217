// What is said of a participant's own run, on the phone and on the projector: of how far it came nothing before the
// picture has got there.
import { metres, whole } from "../../../js/format.js";
import { isActive } from "../../../js/narrative/moment.js";

/** @import { Run } from "../../../js/types.js" */

/**
 * A run and its picture. `distance_m`: what it came to, null before. `hasArrived`: whether its picture has been at its
 * end, or there is none.
 * @typedef {{ run: Run, distance_m: number | null, isAway: boolean, hasArrived: boolean }} KnownOwn
 */

/**
 * What is said in a state. `share`: of the run that is computed.
 * @typedef {{ words: string, distance?: string, share?: number, isBusy?: boolean, isBad?: boolean }} RunSentence
 */

/** @type {Record<string, (known: KnownOwn) => RunSentence>} */
const TABLE = {
  "queued": ({ run, isAway }) => {
    const place = run.queue_position ? ` Place ${run.queue_position} in the queue.` : "";
    return isAway ? { words: "Last known: your robot waits for its turn." }
      : { words: `Your robot waits for its turn.${place}`, isBusy: true };
  },
  "computed": ({ run, isAway }) => {
    const { done, total } = run.progress;
    const what = isAway ? "Last known" : run.kind === "race" ? "It races" : "It practises";
    return { words: `${what}: step ${whole(done)} of ${whole(total)}`, share: total ? done / total : 0 };
  },
  "arriving": ({ run }) => ({
    words: run.kind === "race" ? "How far it came is told at time-out." : "How far it walks now is told at the end.",
  }),
  "arrived": ({ run, distance_m }) => ({
    words: run.kind === "race" ? "your learner at time-out" : "in 50 steps, after its practice",
    distance: metres(distance_m),
  }),
  "lost": () => ({ words: "Your robot did not get to its end. Press Go again.", isBad: true }),
};

/** @param {KnownOwn} known */
function stateOf({ run, hasArrived }) {
  if (run.state === "queued") return "queued";
  if (isActive(run)) return "computed";
  if (run.state !== "finished") return "lost";
  return hasArrived ? "arrived" : "arriving";
}

/** @param {KnownOwn} facts */
export function participantRunNarrative(facts) {
  const state = stateOf(facts);
  return { state, ...TABLE[state](facts) };
}
