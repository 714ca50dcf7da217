// What is said of a participant's own run, on the phone and on the projector: of how far it came nothing before the
// picture has got there.
import { metres, t } from "../../../js/format.js";
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
    if (isAway) return { words: t("Last known: your robot waits for its turn.") };
    const place = run.queue_position ? ` ${t("Place {place} in the queue.", { place: run.queue_position })}` : "";
    return { words: t("Your robot waits for its turn.") + place, isBusy: true };
  },
  "computed": ({ run, isAway }) => {
    const { done, total } = run.progress;
    const what = isAway ? t("Last known") : run.kind === "race" ? t("It races") : t("It practises");
    return { words: t("{what}: step {done} of {total}", { what, done, total }), share: total ? done / total : 0 };
  },
  "arriving": ({ run }) => ({
    words: run.kind === "race" ? t("How far it came is told at time-out.")
      : t("How far it walks now is told at the end."),
  }),
  "arrived": ({ run, distance_m }) => ({
    words: run.kind === "race" ? t("your learner at time-out") : t("in 50 steps, after its practice"),
    distance: metres(distance_m),
  }),
  "lost": () => ({ words: t("Your robot did not get to its end. Press Go again."), isBad: true }),
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
