// In which state a run or a race is, by itself.

/** @import { Run, Scene, SceneLane } from "../types.js" */

const ACTIVE = ["queued", "running", "paused"];

/** @param {Run | null | undefined} run */
export const isActive = (run) => Boolean(run && ACTIVE.includes(run.state));

/** How a run ended that did not take all its steps, as a word that begins a sentence, and as a verb. */
/** @type {Record<string, { word: string, verb: string }>} */
const EARLY_ENDS = {
  stopped: { word: "Stopped", verb: "was stopped" },
  failed: { word: "Failed", verb: "failed" },
  interrupted: { word: "Interrupted", verb: "was interrupted" },
};

/** Null of a run that goes on or has finished. @param {Run | null} run */
export const earlyEndOf = (run) => (run ? EARLY_ENDS[run.state] ?? null : null);

/** Whether a lane has used all its steps. @param {Pick<SceneLane, "steps_made" | "steps" | "failure">} lane */
const hasUsedAll = ({ steps_made, steps, failure }) => !failure && steps > 0 && steps_made >= steps;

/** Whether a race has timed out: the first lane has used its steps, and all others are computed up to there. */
/** @param {Scene | null} scene of a race */
export const isTimedOutIn = (scene) => Boolean(scene && scene.time_out_s !== null && scene.lanes.some(hasUsedAll));

/**
 * Whether the picture of a run is where its distance can be told: at the end of a practice, or a race's time-out.
 * @param {Scene | null} scene
 * @param {string | null} run_id
 */
export const isShownToEnd = (scene, run_id) =>
  scene !== null && scene.run_id === run_id && (scene.kind === "race" ? isTimedOutIn(scene) : scene.ended);
