// Who leads or has won a race, and by which rule, in sentences.
import { count, distanceApart, listed, metres, SAME_MOMENT_S } from "../format.js";
import { distanceOf, LEVEL_M } from "./moment.js";
import { earlyEndOf } from "./states.js";

/** @import { KnownRace, Row } from "./moment.js" */

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
  if (best <= 0) return rows.some(({ step }) => step > 0) ? "Nobody has gained ground" : "On the start line";
  const ahead = rows.filter((row) => best - distanceOf(row) < LEVEL_M);
  if (ahead.length > 1) return `${titlesOf(ahead)} are level`;
  return `${ahead[0].title} leads ${rows.length > 1 ? `by ${distanceApart(leadIn(rows))}` : `with ${metres(best)}`}`;
}

/** The outcome of a race: "Greedy wins by 3 cm". @param {Row[]} rows */
export function verdict(rows) {
  const winners = rows.filter(({ rank }) => rank === 1);
  if (winners.length > 1) return `${titlesOf(winners)} tie`;
  const [{ title, failure, step }] = winners;
  if (failure) return `${title} wins, stopped at step ${step}`;
  const margin = rows.length > 1 ? `by ${distanceApart(leadIn(rows))}` : `with ${metres(distanceOf(winners[0]))}`;
  return `${title} wins ${margin}`;
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
  const at = first === last ? `step ${first}` : `steps ${first} to ${last}`;
  return `${earlyEndOf(race)?.word} at ${at} of ${race?.config.steps}`;
}

/** While others are still on their way to where they were left, nobody leads. */
/** @param {KnownRace} known @param {Row[]} rows */
export const halting = (known, rows) => leftAt(known, rows);

/**
 * How far the lanes came: "Stopped at step 26 of 50: Greedy had come farthest, 0.31 m".
 * @param {KnownRace} known
 * @param {Row[]} rows
 */
export function leftOff(known, rows) {
  const best = Math.max(...rows.map((row) => row.distance_m ?? 0));
  const at = leftAt(known, rows);
  if (best <= 0) return at;
  return `${at}: ${titlesOf(rows.filter((row) => (row.distance_m ?? 0) === best))} had come farthest, ${metres(best)}`;
}

// ---- the rule

/** @param {string} clockTitle @param {Row[]} rows */
export const ruleBefore = (clockTitle, [{ steps }]) =>
  `The farthest at time-out wins: when the first robot has used its ${count(steps, "step")} (${clockTitle}).`;

/** @param {string} clockTitle @param {KnownRace} known */
export const ruleOfNone = (clockTitle, { race }) =>
  `No ranking: the race ${earlyEndOf(race)?.verb} before its time-out (${clockTitle}).`;

/** @param {string} clockTitle @param {KnownRace} known @param {Row[]} rows */
export const ruleAfter = (clockTitle, known, rows) =>
  `Ranked at time-out${decidedWhen(rows, firstTimedOut(known))} (${clockTitle}).`;

/**
 * The moment that decided a race: "when Q-learning had used its 50 steps".
 * @param {Row[]} rows
 * @param {number[]} first numbers of the lanes that used all their steps first; none while that is not known
 */
function decidedWhen(rows, first) {
  const used = count(rows[0].steps, "step");
  if (!first.length) return "";
  if (first.length === rows.length) return `, after ${used} each`;
  const timedOut = rows.filter(({ lane }) => first.includes(lane));
  return `, when ${titlesOf(timedOut)} had used ${timedOut.length > 1 ? "their" : "its"} ${used}`;
}

/** Numbers of the lanes that use all their steps first; none while it is not known. @param {KnownRace} known */
export function firstTimedOut(known) {
  const ends = known.race?.config.lanes.map((_, number) => endOf(known, number)) ?? [];
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
