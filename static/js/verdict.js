// Who leads or has won a race and by which rule, in sentences.
import { count, listed, metres } from "./format.js";

/** @import { Standing } from "./race.js" */

const LEAST_MM = 1;

/** @type {(row: Standing) => number} */
const distanceOf = (row) => row.finished_m ?? row.distance_m ?? 0;

/** @type {(rows: Standing[]) => string} */
const titlesOf = (rows) => listed(rows.map(({ title }) => title));

/**
 * The leader of a race that has not timed out.
 * @param {Standing[]} rows
 */
export function leadOf(rows) {
  const best = Math.max(...rows.map((row) => row.distance_m ?? 0));
  if (best <= 0) return "On the start line";
  const ahead = rows.filter(({ rank }) => rank === 1);
  return ahead.length > 1 ? "Level" : `${ahead[0].title} leads with ${metres(best)}`;
}

/**
 * The outcome of a race, with the moment that decided it: "Greedy wins: 0.37 m when Q-learning had used its 50 steps".
 * @param {Standing[]} rows
 * @param {number[]} first numbers of the lanes that used all their steps first; none if no lane did
 * @param {number} steps of each lane
 */
export function verdictOf(rows, first, steps) {
  const winners = rows.filter(({ rank }) => rank === 1);
  const distance = metres(distanceOf(winners[0]));
  if (!first.length) {
    return `${titlesOf(winners)} got furthest, ${distance}: no robot used its ${count(steps, "step")}`;
  }
  const when = momentOf(rows, winners, first, steps);
  if (winners.length > 1) return `${titlesOf(winners)} tie: ${distance} ${when}`;
  const [{ title, failure, step }] = winners;
  return `${title} wins${failure ? `, stopped at step ${step}` : marginOf(rows, winners[0])}: ${distance} ${when}`;
}

/** @type {(rows: Standing[], winners: Standing[], first: number[], steps: number) => string} */
function momentOf(rows, winners, first, steps) {
  const used = count(steps, "step");
  if (first.length === rows.length) return `after ${used} each`;
  const timedOut = rows.filter(({ lane }) => first.includes(lane));
  const isOwn = timedOut.length === 1 && winners.length === 1 && timedOut[0] === winners[0];
  return `when ${isOwn ? "it" : titlesOf(timedOut)} had used ${timedOut.length > 1 ? "their" : "its"} ${used}`;
}

/**
 * The margin, where distances to the centimetre do not show it.
 * @type {(rows: Standing[], winner: Standing) => string}
 */
function marginOf(rows, winner) {
  const others = rows.filter((row) => row !== winner).map(distanceOf);
  const next = Math.max(...others);
  if (!others.length || metres(next) !== metres(distanceOf(winner))) return "";
  const millimetres = Math.round(1000 * (distanceOf(winner) - next));
  return millimetres < LEAST_MM ? ` by under ${LEAST_MM} mm` : ` by ${millimetres} mm`;
}

/**
 * The rule of the ranking, in one sentence.
 * @param {number} steps of each lane
 * @param {string} clock its title
 */
export const ruleOf = (steps, clock) =>
  `The furthest at time-out wins: when the first robot has used its ${count(steps, "step")} (${clock}).`;

/** What flat parts of a lane's line are under each clock. @type {Record<string, string>} */
const FLAT_PARTS = {
  paper: "Flat parts are thinking, which takes as long as it did in the paper.",
  wall: "Flat parts are thinking, which takes as long as it did on this machine.",
  free: "Thinking takes no time without a clock: in a flat part a robot gains no ground.",
};

/** @param {string} clock */
export const flatParts = (clock) => FLAT_PARTS[clock] ?? "Flat parts are thinking.";
