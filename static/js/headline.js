// Who leads or has won and by which rule, in sentences; and what is announced to screen readers.
import { computed, effect, signal } from "@preact/signals";
import { count, listed, metres } from "./format.js";
import { raceInView, shownRun } from "./on-stage.js";
import { firstTimedOut, isTimedOut, shownEarlyEnd, standings } from "./race.js";
import { connection } from "./store.js";

/** @import { Standing } from "./race.js" */

// ---- announcements for screen readers, each made once: results, failures, a lost connection

/** The text of the page's live region. */
export const announcement = signal("");

/** Leader, or winner and time, in one sentence; null before the race. */
export const headline = computed(() => {
  const rows = standings.value;
  if (!rows?.length) return null;
  const steps = raceInView.value?.config.steps ?? 0;
  if (shownEarlyEnd.value) return earlyEndOf(rows, shownEarlyEnd.value, steps);
  return isTimedOut.value ? verdictOf(rows, firstTimedOut.value, steps) : leadOf(rows);
});

export function announceOutcomes() {
  const decided = computed(() =>
    isTimedOut.value && raceInView.value ? `${raceInView.value.id} ${headline.value}` : "",
  );
  effect(() => {
    const [, ...words] = decided.value.split(" ");
    if (words.length) announcement.value = words.join(" ");
  });
  effect(() => {
    const run = shownRun.value;
    if (run?.state === "failed") announcement.value = `The ${run.kind} failed: ${run.error ?? ""}`;
  });
  effect(() => {
    if (connection.value === "reconnecting") announcement.value = "Connection lost, reconnecting";
  });
}

// ---- who leads or has won and by which rule, in sentences

const MIN_MM = 1;

/** @type {(row: Standing) => number} */
const distanceOf = (row) => row.finished_m ?? row.distance_m ?? 0;

/** @type {(rows: Standing[]) => string} */
const titlesOf = (rows) => listed(rows.map(({ title }) => title));

/**
 * The leader of a race that has not timed out.
 * @param {Standing[]} rows
 */
function leadOf(rows) {
  const best = Math.max(...rows.map((row) => row.distance_m ?? 0));
  if (best <= 0) return rows.some(({ step }) => step > 0) ? "Nobody has gained ground" : "On the start line";
  const ahead = rows.filter(({ rank }) => rank === 1);
  return ahead.length > 1 ? "Level" : `${ahead[0].title} leads with ${metres(best)}`;
}

/**
 * The outcome of a race, with the moment that decided it: "Greedy wins: 0.37 m when Q-learning had used its 50 steps".
 * @param {Standing[]} rows
 * @param {number[]} first numbers of the lanes that used all their steps first; none if no lane did
 * @param {number} steps of each lane
 */
function verdictOf(rows, first, steps) {
  const winners = rows.filter(({ rank }) => rank === 1);
  const distance = metres(distanceOf(winners[0]));
  const when = momentOf(rows, winners, first, steps);
  if (winners.length > 1) return `${titlesOf(winners)} tie: ${distance} ${when}`;
  const [{ title, failure, step }] = winners;
  return `${title} wins${failure ? `, stopped at step ${step}` : marginOf(rows, winners[0])}: ${distance} ${when}`;
}

/** @type {(rows: Standing[], winners: Standing[], first: number[], steps: number) => string} */
function momentOf(rows, winners, first, steps) {
  const used = count(steps, "step");
  // Neither the timeline nor the result is loaded yet.
  if (!first.length) return "at time-out";
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
  return millimetres < MIN_MM ? ` by under ${MIN_MM} mm` : ` by ${millimetres} mm`;
}

/**
 * How far the lanes came in a race that ended before its time-out: "Stopped at step 26 of 50: Greedy came farthest, …".
 * @param {Standing[]} rows
 * @param {string} end "Stopped", for example
 * @param {number} steps of each lane
 */
function earlyEndOf(rows, end, steps) {
  const halted = rows.filter(({ isHalted }) => isHalted);
  const reached = (halted.length ? halted : rows).map(({ step }) => step);
  const [first, last] = [Math.min(...reached), Math.max(...reached)];
  const best = Math.max(...rows.map((row) => row.distance_m ?? 0));
  const at = `${end} at ${first === last ? `step ${first}` : `steps ${first} to ${last}`} of ${steps}`;
  if (best <= 0) return at;
  return `${at}: ${titlesOf(rows.filter((row) => (row.distance_m ?? 0) === best))} had come farthest, ${metres(best)}`;
}

/** @type {Record<string, string>} */
const EARLY_END_VERBS = { Stopped: "was stopped", Failed: "failed", Interrupted: "was interrupted" };

/**
 * The rule of the ranking, in one sentence.
 * @param {number} steps of each lane
 * @param {string} clockTitle
 */
export function ruleOf(steps, clockTitle) {
  const verb = EARLY_END_VERBS[shownEarlyEnd.value ?? ""];
  return verb
    ? `No ranking: the race ${verb} before its time-out (${clockTitle}).`
    : `The farthest at time-out wins: when the first robot has used its ${count(steps, "step")} (${clockTitle}).`;
}
