// The sentences about a race and a practice: who leads or has won, by which rule and why; what a practice has come to.
import {
  decimal, distanceApart, fixed, inMillimetres, listed, metres, percentage, t,
} from "../format.js";
import { SAME_MOMENT_S } from "../replay-frames.js";
import { distanceOf, earlyEndOf, isActive, LEVEL_M, madeAt, stepEnds, timeSpent } from "./moment.js";

/** @import { CurvePoint } from "../training.js" */
/** @import { Run, TimelineLane } from "../types.js" */
/** @import { Happening, KnownRace, Row } from "./moment.js" */

// ---- who leads or has won

/** @type {(rows: Row[]) => string} */
const titlesOf = (rows) => listed(rows.map(({ title }) => title));

/** How far the first of several is ahead of the second [m]. @param {Row[]} rows */
export function leadIn(rows) {
  const [first, second] = rows.map(distanceOf).sort((a, b) => b - a);
  return first - second;
}

/** Whether nobody is said to be ahead of the others. @param {Row[]} rows */
export const areLevel = (rows) => rows.length > 1 && leadIn(rows) < LEVEL_M;

/** The leader of a race that has not timed out. @param {Row[]} rows */
export function lead(rows) {
  const best = Math.max(...rows.map(distanceOf));
  if (best <= 0) return rows.some(({ step }) => step > 0) ? t("Nobody has gained ground") : t("On the start line");
  const ahead = rows.filter((row) => best - distanceOf(row) < LEVEL_M);
  if (ahead.length > 1) return t("{robots} are level", { robots: titlesOf(ahead) });
  const [{ title: robot }] = ahead;
  if (rows.length === 1) return t("{robot} leads with {distance}", { robot, distance: metres(best) });
  return t("{robot} leads by {distance}", { robot, distance: distanceApart(leadIn(rows)) });
}

/**
 * The lane that is ahead of all others, or in front alone; null while they are level. @param {Row[]} rows
 * @returns {{ lane: number, words: string } | null} `words`: "Greedy takes the lead, 0.12 m"
 */
export function leaderOf(rows) {
  const [first] = rows.toSorted((a, b) => distanceOf(b) - distanceOf(a));
  if (distanceOf(first) < LEVEL_M || areLevel(rows)) return null;
  const values = { robot: first.title, distance: metres(distanceOf(first)) };
  return { lane: first.lane, words: t("{robot} takes the lead, {distance}", values) };
}

/** The outcome of a race: "Greedy wins by 3 cm". @param {Row[]} rows */
export function verdict(rows) {
  const winners = rows.filter(({ rank }) => rank === 1);
  if (winners.length > 1) return t("{robots} tie", { robots: titlesOf(winners) });
  const [{ title: robot, failure, step }] = winners;
  if (failure) return t("{robot} wins, stopped at step {step}", { robot, step });
  if (rows.length === 1) return t("{robot} wins with {distance}", { robot, distance: metres(distanceOf(winners[0])) });
  return t("{robot} wins by {distance}", { robot, distance: distanceApart(leadIn(rows)) });
}

/**
 * Where a race was left that ended before its time-out: "Stopped at step 26 of 50"; of lanes that have come there.
 * @param {KnownRace} known
 * @param {Row[]} rows
 */
function leftAt({ race }, rows) {
  const halted = rows.filter(({ isHalted }) => isHalted);
  const reached = (halted.length ? halted : rows).map(({ step }) => step);
  const [first, last] = [Math.min(...reached), Math.max(...reached)];
  const values = { end: earlyEndOf(race)?.word ?? "", first, last, steps: race?.config.steps ?? 0 };
  return first === last ? t("{end} at step {first} of {steps}", values)
    : t("{end} at steps {first} to {last} of {steps}", values);
}

/** While others are still on their way to where they were left, nobody leads. */
/** @param {KnownRace} moment @param {Row[]} rows */
export const halting = (moment, rows) => leftAt(moment, rows);

/**
 * How far the lanes came: "Stopped at step 26 of 50: Greedy had come farthest, 0.31 m".
 * @param {KnownRace} moment
 * @param {Row[]} rows
 */
export function leftOff(moment, rows) {
  const best = Math.max(...rows.map((row) => row.distance_m ?? 0));
  const at = leftAt(moment, rows);
  if (best <= 0) return at;
  const robots = titlesOf(rows.filter((row) => (row.distance_m ?? 0) === best));
  return t("{at}: {robots} had come farthest, {distance}", { at, robots, distance: metres(best) });
}

// ---- the rule

/** @param {string} clockTitle @param {Row[]} rows */
export const ruleBefore = (clockTitle, [{ steps }]) => t(
  "The farthest at time-out wins: when the first robot has used its {steps} {steps|step|steps} ({clock}).",
  { steps, clock: clockTitle },
);

/** @param {string} clockTitle @param {KnownRace} known */
export const ruleOfNone = (clockTitle, { race }) =>
  t("No ranking: the race {verb} before its time-out ({clock}).", {
    verb: earlyEndOf(race)?.verb ?? "", clock: clockTitle,
  });

/** @param {string} clockTitle @param {KnownRace} moment @param {Row[]} rows */
export function ruleAfter(clockTitle, moment, rows) {
  const first = firstTimedOut(moment);
  const timedOut = rows.filter(({ lane }) => first.includes(lane));
  const values = { clock: clockTitle, steps: rows[0].steps, robots: titlesOf(timedOut) };
  if (!first.length) return t("Ranked at time-out ({clock}).", values);
  if (first.length === rows.length) {
    return t("Ranked at time-out, after {steps} {steps|step|steps} each ({clock}).", values);
  }
  return timedOut.length > 1
    ? t("Ranked at time-out, when {robots} had used their {steps} {steps|step|steps} ({clock}).", values)
    : t("Ranked at time-out, when {robots} had used its {steps} {steps|step|steps} ({clock}).", values);
}

/** Numbers of the lanes that use all their steps first; none while it is not known. @param {KnownRace} moment */
export function firstTimedOut(moment) {
  const ends = moment.race?.config.lanes.map((_, number) => endOf(moment, number)) ?? [];
  const first = Math.min(...ends);
  return ends.flatMap((end, number) => (Number.isFinite(end) && end - first <= SAME_MOMENT_S ? [number] : []));
}

/** When a lane has used all its steps [s]; Infinity if it has not. */
/** @param {KnownRace} known @param {number} number */
function endOf({ race, timeline, clock }, number) {
  const result = race?.result?.lanes?.[number];
  const track = timeline?.lanes[number];
  if (result) return result.steps === race?.config.steps ? result.clocks?.[clock]?.elapsed_s ?? Infinity : Infinity;
  return track && track.steps === race?.config.steps ? track.total_s : Infinity;
}

// ---- a practice

/**
 * A practice at a moment. `newest`: its newest test that is shown; null before the first.
 * @typedef {{ training: Run, title: string, newest: CurvePoint | null }} KnownPractice
 */

/** A share of random steps that is not worth a sentence. */
const FEWEST_RANDOM = 0.005;

/** @param {KnownPractice} known */
export const practising = ({ title, newest }) =>
  (newest ? t("{robot} walks {distance} so far", { robot: title, distance: metres(newest.distance_m) })
    : t("{robot} practises", { robot: title }));

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
  const values = { share: 100 * epsilon, epsilon: decimal(shown) };
  return t("{share} of 100 steps are still random (ε\u00a0{epsilon}): it finds out which moves pay.", values);
}

/** When the first test of a practice comes; null without one, as where it ended before. @param {Run} training */
function firstTest(training) {
  const step = training.config.evaluate_every;
  const isTested = step > 0 && (isActive(training) || training.progress.done > step);
  return isTested ? t("Its first test is at step {step}.", { step }) : null;
}

/** @param {KnownPractice} known */
export const practised = ({ title, newest }) =>
  (newest ? t("{robot} walked {distance} in its last test", { robot: title, distance: metres(newest.distance_m) })
    : t("{robot} has practised", { robot: title }));

/** @param {KnownPractice} known */
export const whyPractised = ({ training }) =>
  t("It has practised {steps} {steps|step|steps}.", { steps: training.progress.done });

/** "Stopped at step 400 of 1500". @param {{ training: Run }} known */
export const brokenOff = ({ training }) => {
  const { done, total } = training.progress;
  const values = { end: earlyEndOf(training)?.word ?? "", first: done, steps: total };
  return t("{end} at step {first} of {steps}", values);
};

/** How far the learner had come where it was left; null where that was not measured. @param {KnownPractice} known */
export const whyBrokenOff = ({ training, title, newest }) => {
  const then_m = training.result?.distance_m ?? null;
  if (then_m !== null) {
    return t("Tested there, {robot} walked {distance} in 50 steps.", { robot: title, distance: metres(then_m) });
  }
  if (!newest) return null;
  const values = { robot: title, distance: metres(newest.distance_m), steps: newest.step };
  return t("{robot} walked {distance} in its last test, after {steps} {steps|step|steps}.", values);
};

// ---- why the leader is ahead: the first sentence that the recorded figures of two lanes show

/** @typedef {Pick<TimelineLane, "points" | "thinking" | "futures" | "total_s" | "steps" | "stride">} Track */
/**
 * A lane with what is recorded of it until a moment: `made` steps of which `ends_m` are the distances at the start and
 * at the end of each, or of each `stride`; `futures` the transitions that it simulated in them, `thought_s` its time of
 * thinking.
 * @typedef {object} Walked
 * @property {string} title
 * @property {number} made
 * @property {number} stride
 * @property {number[]} ends_m
 * @property {number[]} futures
 * @property {number} thought_s
 * @property {number | null} fell_at_step
 */

/** A step is longer than another by more than this share, if that is to be the reason. */
const LONGER = 0.1;
/** Steps in which a robot marches on the spot, by the board's rule; and in which two lanes "began". */
const FEW_STEPS = 10;
/** A robot that gains less in so many steps marches on the spot [m]. */
const MARCHING_M = 0.01;
/** A share of the time for thinking that is worth a sentence. */
const LEAST_THOUGHT = 0.005;
/** Fewer steps before or after a disturbance tell nothing of it. */
const FEWEST_STEPS = 3;
/** Steps after a disturbance are shorter at least by this share, if it is to be the reason. */
const SHORTER = 0.25;
/** Of the present lead, so much was there after the first steps, if the beginning is to be the reason. */
const SHARE_OF_LEAD = 0.5;

/**
 * What the reasons take of a lane; null where the timeline does not have its steps, or before the first of them.
 * @param {Row} row
 * @param {Track | undefined} track
 * @param {number} made steps
 * @param {number} time at which it has made them [s]
 * @returns {Walked | null}
 */
function walked({ title, fell_at_step }, track, made, time) {
  const ends = track ? stepEnds(track) : null;
  if (!track || !ends) return null;
  const { stride, steps, futures } = track;
  // Of steps that are told of together, the whole strides, and the last steps that there are.
  const reached = made === steps ? futures.length : Math.floor(made / stride);
  if (reached < 1 || reached >= ends.length) return null;
  return {
    title, made, stride, ends_m: ends.slice(0, reached + 1).map(([, distance]) => distance),
    futures: futures.slice(0, reached), thought_s: timeSpent(track, time).thought,
    fell_at_step: fell_at_step !== null && fell_at_step < made ? fell_at_step : null,
  };
}

/** Mean distance of all steps [m]. @param {Walked} lane */
const meanStep = ({ ends_m, made, stride }) =>
  ((ends_m.at(-1) ?? 0) - ends_m[0]) / Math.min(made, (ends_m.length - 1) * stride);

/** Mean distance of the steps from one to another, counted from 0 [m]. */
/** @param {number[]} ends_m @param {number} from @param {number} to */
const meanBetween = (ends_m, from, to) => (ends_m[to] - ends_m[from]) / (to - from);

/** Whether the timeline has each step of it. @param {Walked[]} lanes */
const areWhole = (...lanes) => lanes.every(({ stride }) => stride === 1);

/** @type {(a: Walked, b: Walked) => string | null} */
const fallOf = (a, b) =>
  b.fell_at_step === null || a.fell_at_step !== null
    ? null
    : t("{robot} has fallen at step {step}.", { robot: b.title, step: b.fell_at_step + 1 });

/** @param {Walked} b */
function marchOf(b) {
  if (!areWhole(b) || b.made < FEW_STEPS) return null;
  const last_m = b.ends_m[b.made] - b.ends_m[b.made - FEW_STEPS];
  if (last_m >= MARCHING_M) return null;
  const gained = fixed(100 * last_m, 1).replace("-", "−");
  return t("{robot} marches on the spot: {gained}\u00a0cm in its last ten steps.", { robot: b.title, gained });
}

/**
 * The disturbance after which the second lane's steps are shorter, and more so than the leader's.
 * @param {Walked} a
 * @param {Walked} b
 * @param {Happening[]} happened
 */
function slowedBy(a, b, happened) {
  if (!areWhole(a, b)) return null;
  for (const event of happened.toReversed()) {
    const change = (/** @type {Walked} */ { ends_m, made }) => {
      const to = Math.min(made, event.until_step ?? Infinity);
      if (event.at_step < FEWEST_STEPS || to - event.at_step < FEWEST_STEPS) return null;
      return { before: meanBetween(ends_m, 0, event.at_step), after: meanBetween(ends_m, event.at_step, to) };
    };
    const [leader, other] = [change(a), change(b)];
    const isSlower = leader && other && other.before > 0 && other.after < (1 - SHORTER) * other.before;
    if (isSlower && other.before - other.after > leader.before - leader.after) {
      const [before, after] = [other.before, other.after].map(inMillimetres);
      const values = { event: event.words, robot: b.title, before, after };
      return t("{event}: {robot} went {before} a step before, {after} after.", values);
    }
  }
  return null;
}

/** @type {(a: Walked, b: Walked) => string | null} */
function longerSteps(a, b) {
  const [first, second] = [meanStep(a), meanStep(b)];
  if (first <= (1 + LONGER) * second) return null;
  const futures = a.futures.reduce((sum, n) => sum + n, 0) / Math.min(a.made, a.futures.length * a.stride);
  const isAlways = a.futures.every((n) => n === futures);
  const search = isAlways ? t("It simulates {moves} moves before each.", { moves: futures })
    : t("It simulates about {moves} moves before each.", { moves: futures });
  const values = { first: inMillimetres(first), second: inMillimetres(second), robot: b.title };
  const longer = t("Its steps are longer: {first} against {second} of {robot}.", values);
  return futures >= 1 ? `${longer} ${search}` : longer;
}

/** @type {(a: Walked, b: Walked) => string | null} */
const shorterThinking = (a, b) =>
  a.made > b.made && a.thought_s < b.thought_s
    ? t("It thinks less: {more} steps made against {fewer} of {robot}.", {
      more: a.made, fewer: b.made, robot: b.title,
    }) : null;

/** @type {(a: Walked, b: Walked) => string | null} */
function betterStart(a, b) {
  if (!areWhole(a, b) || meanStep(b) > (1 + LONGER) * meanStep(a)) return null;
  const leadAfter = (/** @type {number} */ step) => a.ends_m[step] - b.ends_m[step];
  const last = Math.min(a.made, b.made);
  if (last < FEW_STEPS || leadAfter(FEW_STEPS) < Math.max(LEVEL_M, SHARE_OF_LEAD * leadAfter(last))) return null;
  const lead_m = distanceApart(leadAfter(FEW_STEPS));
  return t("Both walk alike; {robot} began {distance} better.", { robot: a.title, distance: lead_m });
}

/**
 * Why the first of two lanes is ahead: "Its steps are longer: 10.2 mm against 7.1 mm of Q-learning."
 * @param {Row[]} rows the leader first
 * @param {Track[]} tracks of the timeline, by lane
 * @param {{ time_s: number, isPast: boolean }} until the moment; `isPast`: before the one that is shown
 * @param {Happening[]} happened
 * @returns {string | null} null where the lanes are level, or where no recorded figure tells why
 */
export function reasonOf(rows, tracks, { time_s, isPast }, happened) {
  if (rows.length < 2 || distanceOf(rows[0]) - distanceOf(rows[1]) < LEVEL_M) return null;
  const [a, b] = rows.slice(0, 2).map((row) => {
    const track = tracks[row.lane];
    const made = isPast && track ? madeAt(track, time_s) : row.made;
    return made === null ? null : walked(row, track, made, time_s);
  });
  if (!a || !b) return null;
  return fallOf(a, b) ?? marchOf(b) ?? slowedBy(a, b, happened) ?? longerSteps(a, b) ?? shorterThinking(a, b) ??
    betterStart(a, b);
}

/**
 * What the winner did with its time: "It thought 12 % of the time: 46 of 50 steps."
 * @param {Track | undefined} track of the winner
 * @param {number} time_s at which the race is ranked
 * @param {number} steps of each lane
 */
export function workOf(track, time_s, steps) {
  const made = track ? madeAt(track, time_s) : null;
  if (!track || made === null) return null;
  const { thought, walked: walking } = timeSpent(track, time_s);
  if (thought + walking <= 0 || thought < LEAST_THOUGHT * (thought + walking)) return null;
  const share = percentage(thought / (thought + walking));
  return t("It thought {share} of the time: {made} of {steps} steps.", { share, made, steps });
}
