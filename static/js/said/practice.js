// What a practice has come to, in sentences.
import { count, metres, whole } from "../format.js";
import { earlyEndOf, isActive } from "./states.js";

/** @import { CurvePoint } from "../training.js" */
/** @import { Run } from "../types.js" */

/**
 * A practice at a moment. `newest`: its newest test that is shown; null before the first.
 * @typedef {{ training: Run, title: string, newest: CurvePoint | null }} KnownPractice
 */

/** A share of random steps that is not worth a sentence. */
const FEWEST_RANDOM = 0.005;

/** @param {KnownPractice} known */
export const practising = ({ title, newest }) =>
  (newest ? `${title} walks ${metres(newest.distance_m)} so far` : `${title} practises`);

/** @param {KnownPractice} known */
export const whyPractising = ({ training, newest }) =>
  (newest ? chanceInWords(newest.epsilon) : firstTest(training));

/**
 * What practice does at present: "33 of 100 steps are still random (ε 0.33): it finds out which moves pay."
 * @param {number | undefined} epsilon at the newest test that is shown
 */
export function chanceInWords(epsilon) {
  if (epsilon === undefined || epsilon < FEWEST_RANDOM) return null;
  const shown = Number(epsilon.toFixed(2));
  return `${whole(100 * epsilon)} of 100 steps are still random (ε\u00a0${shown}): it finds out which moves pay.`;
}

/** When the first test of a practice comes; null without one, as where it ended before. @param {Run} training */
function firstTest(training) {
  const step = training.config.evaluate_every;
  const isTested = step > 0 && (isActive(training) || training.progress.done > step);
  return isTested ? `Its first test is at step ${whole(step)}.` : null;
}

/** @param {KnownPractice} known */
export const practised = ({ title, newest }) =>
  (newest ? `${title} walked ${metres(newest.distance_m)} in its last test` : `${title} has practised`);

/** @param {KnownPractice} known */
export const whyPractised = ({ training }) => `It has practised ${count(training.progress.done, "step")}.`;

/** "Stopped at step 400 of 1500". @param {{ training: Run }} known */
export const brokenOff = ({ training }) => {
  const { done, total } = training.progress;
  return `${earlyEndOf(training)?.word} at step ${whole(done)} of ${whole(total)}`;
};

/** How far the learner had come where it was left; null where that was not measured. @param {KnownPractice} known */
export const whyBrokenOff = ({ training, title, newest }) => {
  const then_m = training.result?.distance_m ?? null;
  if (then_m !== null) return `Tested there, ${title} walked ${metres(then_m)} in 50 steps.`;
  if (!newest) return null;
  return `${title} walked ${metres(newest.distance_m)} in its last test, after ${count(newest.step, "step")}.`;
};
