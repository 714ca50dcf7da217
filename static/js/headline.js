// Who leads or has won, by which rule and why, in sentences from recorded figures; and what is announced to screen
// readers.
import { computed, effect, signal } from "@preact/signals";
import { disturbancesOf, inTime, joinedBySteps } from "./disturbances.js";
import { count, distanceApart, listed, metres, percentage, sentence, whole } from "./format.js";
import { isStale, raceInView, shownRun } from "./on-stage.js";
import {
  firstTimedOut, isTimedOut, LEVEL_M, shownEarlyEnd, shownTime, standings, timeline, timeSpent,
} from "./race.js";
import { isActive } from "./selectors.js";
import { agentOf } from "./settings.js";
import { connection, scene } from "./store.js";
import { curve } from "./training.js";

/** @import { Signal } from "@preact/signals" */
/** @import { Standing } from "./race.js" */
/** @import { Disturbance, Run, TimelineLane } from "./types.js" */

// ---- announcements for screen readers, each made once: results, failures, a lost connection

const LOST = "Connection lost, reconnecting";

/** The text of the page's live region. */
export const announcement = signal("");

/** Leader, or winner and time, in one sentence; null before the race. */
export const headline = computed(() => {
  const rows = standings.value;
  if (!rows?.length) return null;
  const steps = raceInView.value?.config.steps ?? 0;
  if (shownEarlyEnd.value) return earlyEndOf(rows, shownEarlyEnd.value, steps);
  return isTimedOut.value ? verdictOf(rows) : leadOf(rows);
});

/** The colour of who leads, or of the learner that practises. */
export const leaderColor = computed(() => {
  const [first] = standings.value ?? [];
  const agent = shownRun.value?.config.agent;
  return first?.color ?? (agent ? agentOf(agent).color : "transparent");
});

/**
 * The move that the explanation is about, told by its tab while it is open; null without one.
 * @type {Signal<{ title: string, reason: string, color: string } | null>}
 */
export const moveTold = signal(null);

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
    if (connection.value === "reconnecting") announcement.value = LOST;
    else if (connection.value === "live" && announcement.peek() === LOST) announcement.value = "Connected again";
  });
}

// ---- who leads or has won and by which rule, in sentences


/** @type {(row: Standing) => number} */
const distanceOf = (row) => row.finished_m ?? row.distance_m ?? 0;

/** @type {(rows: Standing[]) => string} */
const titlesOf = (rows) => listed(rows.map(({ title }) => title));

/**
 * The leader of a race that has not timed out.
 * @param {Standing[]} rows
 */
function leadOf(rows) {
  const best = Math.max(...rows.map(distanceOf));
  if (best <= 0) return rows.some(({ step }) => step > 0) ? "Nobody has gained ground" : "On the start line";
  const ahead = rows.filter((row) => row.rank === 1 || best - distanceOf(row) < LEVEL_M);
  if (ahead.length > 1) return `${titlesOf(ahead)} are level`;
  return `${ahead[0].title} leads ${rows.length > 1 ? `by ${distanceApart(leadIn(rows))}` : `with ${metres(best)}`}`;
}

/** How far the first of several is ahead of the second [m]. @param {Standing[]} rows */
function leadIn(rows) {
  const [first, second] = rows.map(distanceOf).sort((a, b) => b - a);
  return first - second;
}

/**
 * The outcome of a race: "Greedy wins by 3 cm".
 * @param {Standing[]} rows
 */
function verdictOf(rows) {
  const winners = rows.filter(({ rank }) => rank === 1);
  if (winners.length > 1) return `${titlesOf(winners)} tie`;
  const [{ title, failure, step }] = winners;
  if (failure) return `${title} wins, stopped at step ${step}`;
  const margin = rows.length > 1 ? `by ${distanceApart(leadIn(rows))}` : `with ${metres(distanceOf(winners[0]))}`;
  return `${title} wins ${margin}`;
}

/**
 * The moment that decided a race: "when Q-learning had used its 50 steps".
 * @param {Standing[]} rows
 * @param {number[]} first numbers of the lanes that used all their steps first; none while that is not known
 * @param {number} steps of each lane
 */
function decidedWhen(rows, first, steps) {
  const used = count(steps, "step");
  if (!first.length) return "";
  if (first.length === rows.length) return `, after ${used} each`;
  const timedOut = rows.filter(({ lane }) => first.includes(lane));
  return `, when ${titlesOf(timedOut)} had used ${timedOut.length > 1 ? "their" : "its"} ${used}`;
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
/** The same of a run's state; null of one that was not ended early. @param {string} state */
const earlyEndVerb = (state) => EARLY_END_VERBS[sentence(state)] ?? null;

/**
 * By what the lanes are ranked, and once they are, when: in one sentence.
 * @param {Standing[]} rows
 * @param {string} clockTitle
 */
export function ruleOf(rows, clockTitle) {
  const [{ steps }] = rows;
  const verb = EARLY_END_VERBS[shownEarlyEnd.value ?? ""];
  if (verb) return `No ranking: the race ${verb} before its time-out (${clockTitle}).`;
  return isTimedOut.value
    ? `Ranked at time-out${decidedWhen(rows, firstTimedOut.value, steps)} (${clockTitle}).`
    : `The farthest at time-out wins: when the first robot has used its ${count(steps, "step")} (${clockTitle}).`;
}

/** @typedef {Pick<Standing, "lane" | "title" | "fell_at_step" | "isMarching">} Row a lane of the board */
/** @typedef {Pick<TimelineLane, "points" | "thinking" | "futures" | "total_s">} Track a lane of the timeline */
/**
 * A lane with what is recorded of it until the moment that is shown: `ends_m` are its distances at the start and after
 * each step, `futures` the transitions that it simulated before each step, `thought_s` its time of thinking.
 * @typedef {Row & { ends_m: number[], futures: number[], thought_s: number }} Walked
 */


/** A step is longer than another by more than this share, if that is to be the reason. */
const LONGER = 0.1;
/** Steps in which a robot marches on the spot, by the board's rule; and in which two lanes "began". */
const FEW_STEPS = 10;
/** A share of the time for thinking that is worth a sentence. */
const LEAST_THOUGHT = 0.005;
/** Fewer steps before or after a disturbance tell nothing of it. */
const FEWEST_STEPS = 3;
/** Steps after a disturbance are shorter at least by this share, if it is to be the reason. */
const SHORTER = 0.25;
/** Of the present lead, so much was there after the first steps, if the beginning is to be the reason. */
const SHARE_OF_LEAD = 0.5;

/**
 * The distances at the start and after each step that has ended until a race time [m]; null where the timeline does
 * not have the end of each step.
 * @param {Pick<Track, "points" | "thinking" | "futures">} track
 * @param {number} time [s]
 */
export function stepEnds({ points, thinking, futures }, time) {
  if (points.length - 1 !== thinking.length + futures.length) return null;
  // Each step adds the end of its motion, and before it the end of its thinking, if it took time.
  const thoughtUntil = new Set(thinking.map(([, to]) => to));
  return points.filter(([t], n) => t <= time && (n === 0 || !thoughtUntil.has(t))).map(([, distance]) => distance);
}

/**
 * What the reasons take of a lane; null without the ends of its steps, or before the first of them.
 * @param {Row} row
 * @param {Track | undefined} track
 * @param {number} time [s]
 * @returns {Walked | null}
 */
function walked(row, track, time) {
  const ends_m = track ? stepEnds(track, time) : null;
  if (!track || !ends_m || ends_m.length < 2) return null;
  const { thought } = timeSpent(track, time);
  return { ...row, ends_m, futures: track.futures.slice(0, ends_m.length - 1), thought_s: thought };
}

/** Mean distance of the steps from one to another, counted from 0 [m]. */
const meanStep = (/** @type {number[]} */ ends_m, from = 0, to = ends_m.length - 1) =>
  (ends_m[to] - ends_m[from]) / (to - from);

/** @param {number} distance_m of a step */
const ofStep = (distance_m) => `${(1000 * distance_m).toFixed(1).replace("-", "−")}\u00a0mm`;

/** @param {{ ends_m: number[] }} one */
const stepsOf = ({ ends_m }) => ends_m.length - 1;

// ---- the reasons, each a sentence, or null where it is not the reason

/** @param {Walked} a @param {Walked} b */
const fallOf = (a, b) =>
  b.fell_at_step === null || a.fell_at_step !== null
    ? null
    : `${b.title} has fallen at step ${whole(b.fell_at_step + 1)}.`;

/** @param {Walked} b */
function marchOf(b) {
  if (!b.isMarching || stepsOf(b) < FEW_STEPS) return null;
  const last_m = b.ends_m[stepsOf(b)] - b.ends_m[stepsOf(b) - FEW_STEPS];
  const gained = (100 * last_m).toFixed(1).replace("-", "−");
  return `${b.title} marches on the spot: ${gained}\u00a0cm in its last ten steps.`;
}

/** Why an agent's steps gain nothing. @param {string} agent */
export function whyMarching(agent) {
  const { learns, searches } = agentOf(agent);
  const gain = "under 1 cm in ten steps";
  if (learns) return `${gain}: moves that undo each other still have the highest values. More practice changes that.`;
  return searches ? `${gain}: no move that it simulates gains distance on this robot.` : `${gain}.`;
}

/**
 * The disturbance after which the second lane's steps are shorter, and more so than the leader's.
 * @param {Walked} a
 * @param {Walked} b
 * @param {Disturbance[]} disturbances
 */
function slowedBy(a, b, disturbances) {
  for (const one of disturbances.toReversed()) {
    const change = (/** @type {Walked} */ lane) => {
      const to = Math.min(stepsOf(lane), one.until_step ?? Infinity);
      if (one.at_step < FEWEST_STEPS || to - one.at_step < FEWEST_STEPS) return null;
      return { before: meanStep(lane.ends_m, 0, one.at_step), after: meanStep(lane.ends_m, one.at_step, to) };
    };
    const [leader, other] = [change(a), change(b)];
    const isSlower = leader && other && other.before > 0 && other.after < (1 - SHORTER) * other.before;
    if (isSlower && other.before - other.after > leader.before - leader.after) {
      const { before, after } = other;
      return `${sentence(inTime(one))}: ${b.title} went ${ofStep(before)} a step before, ${ofStep(after)} after.`;
    }
  }
  return null;
}

/** @param {Walked} a @param {Walked} b */
function longerSteps(a, b) {
  const [own, other] = [meanStep(a.ends_m), meanStep(b.ends_m)];
  if (own <= (1 + LONGER) * other) return null;
  const futures = a.futures.reduce((sum, n) => sum + n, 0) / a.futures.length;
  const moves = a.futures.every((n) => n === futures) ? whole(futures) : `about ${whole(futures)}`;
  const search = futures >= 1 ? ` It simulates ${moves} moves before each.` : "";
  return `Its steps are longer: ${ofStep(own)} against ${ofStep(other)} of ${b.title}.${search}`;
}

/** @param {Walked} a @param {Walked} b */
const shorterThinking = (a, b) =>
  stepsOf(a) > stepsOf(b) && a.thought_s < b.thought_s
    ? `It thinks less: ${whole(stepsOf(a))} steps made against ${whole(stepsOf(b))} of ${b.title}.`
    : null;

/** @param {Walked} a @param {Walked} b */
function betterStart(a, b) {
  const lead = (/** @type {number} */ step) => a.ends_m[step] - b.ends_m[step];
  const last = Math.min(stepsOf(a), stepsOf(b));
  if (last < FEW_STEPS || lead(FEW_STEPS) < Math.max(LEVEL_M, SHARE_OF_LEAD * lead(last))) return null;
  return `Both walk alike; ${a.title} began ${distanceApart(lead(FEW_STEPS))} better.`;
}

/**
 * Why the first of two lanes is ahead: "Its steps are longer: 10.2 mm against 7.1 mm of Q-learning."
 * @param {Row[]} rows the leader first
 * @param {Track[]} tracks of the timeline, by lane
 * @param {number} time [s]
 * @param {Disturbance[]} disturbances of the race
 * @returns {string | null} null where the lanes are level, or where no recorded figure tells why
 */
export function reasonOf(rows, tracks, time, disturbances) {
  const [a, b] = rows.slice(0, 2).map((row) => walked(row, tracks[row.lane], time));
  if (!a || !b || (a.ends_m.at(-1) ?? 0) - (b.ends_m.at(-1) ?? 0) < LEVEL_M) return null;
  return fallOf(a, b) ?? marchOf(b) ?? slowedBy(a, b, disturbances) ??
    longerSteps(a, b) ?? shorterThinking(a, b) ?? betterStart(a, b);
}

/**
 * What the winner did with its time: "It thought for 12 % of the time, and made 46 steps of 50."
 * @param {Row | undefined} winner
 * @param {Track[]} tracks
 * @param {number} time at which the race is ranked [s]
 * @param {number} steps of each lane
 */
export function workOf(winner, tracks, time, steps) {
  const track = winner && tracks[winner.lane];
  const ends_m = track ? stepEnds(track, time) : null;
  if (!track || !ends_m) return null;
  const { thought, walked: walking } = timeSpent(track, time);
  if (thought < LEAST_THOUGHT * (thought + walking) || thought + walking <= 0) return null;
  const share = percentage(thought / (thought + walking));
  return `It thought for ${share} of the time, and made ${whole(ends_m.length - 1)} steps of ${whole(steps)}.`;
}

/** Of the race at the moment that is shown, or at its time-out once that is past. */
const raceReason = computed(() => {
  const [race, rows, known, time] = [raceInView.value, standings.value, timeline.value, shownTime.value];
  if (!race || !rows || !known || time === null || shownEarlyEnd.value) return null;
  const until = Math.min(time, known.first_finish_s ?? Infinity);
  const why = reasonOf(rows, known.lanes, until, joinedBySteps(disturbancesOf(race)));
  const work = isTimedOut.value ? workOf(rows[0], known.lanes, until, race.config.steps) : null;
  if (!work) return why;
  // Of 25 words: the time of thinking tells what simulating moves cost.
  const [first = null] = why?.split(/(?<=\.) /) ?? [];
  return [first, work].filter(Boolean).join(" ");
});

/** A share of random steps that is not worth a sentence. */
const FEWEST_RANDOM = 0.005;

/**
 * What practice does at present: "33 of 100 steps are still random (ε 0.33): it finds out which moves pay."
 * @param {number | undefined} epsilon at the newest evaluation that is shown
 */
export function practiceReason(epsilon) {
  if (epsilon === undefined || epsilon < FEWEST_RANDOM) return null;
  const shown = Number(epsilon.toFixed(2));
  return `${whole(100 * epsilon)} of 100 steps are still random (ε\u00a0${shown}): it finds out which moves pay.`;
}

/**
 * How a practice has ended: "The training was stopped at step 26 of 500."
 * @param {Run} training that is computed no longer
 */
function endOfPractice({ state, progress: { done, total } }) {
  const verb = earlyEndVerb(state);
  if (!verb) return `It has practised ${count(done, "step")}.`;
  return `The training ${verb} at step ${whole(done)} of ${whole(total)}.`;
}

/** When the first test of a practice comes; null without one, as where it ended before. @param {Run} training */
function firstTest(training) {
  const step = training.config.evaluate_every;
  const isTested = step > 0 && (isActive(training) || training.progress.done > step);
  return isTested ? `Its first test is at step ${whole(step)}.` : null;
}

/** The training on stage: how far it walks and what it does, by its newest evaluation that is shown. */
const practice = computed(() => {
  const training = shownRun.value?.kind === "training" ? shownRun.value : null;
  if (!training) return null;
  const newest = curve.value?.run.id === training.id ? curve.value.points.at(-1) : null;
  const { title } = agentOf(training.config.agent);
  const walk = newest?.step ? metres(newest.distance_m) : null;
  // The last picture of one that has ended: nothing is found out any more.
  if (!isActive(training) && scene.value?.ended) {
    const what = walk === null ? "has practised" : `walked ${walk} in its last test`;
    return { title: `${title} ${what}`, reason: endOfPractice(training) };
  }
  if (walk === null) return { title: `${title} practises`, reason: firstTest(training) };
  return { title: `${title} walks ${walk} so far`, reason: practiceReason(newest?.epsilon) };
});

/** How far the learner on stage walks by now; null where no training is shown. */
export const practiceTitle = computed(() => practice.value?.title ?? null);

/** Said of what may go on unseen. */
const STOOD = "This is the last that is known.";

/** Why what the headline says is so; null where no recorded figure tells it. */
export const reason = computed(() => {
  if (standings.value) return isStale.value && !isTimedOut.value ? STOOD : raceReason.value;
  return isStale.value && practice.value && !scene.value?.ended ? STOOD : practice.value?.reason ?? null;
});
