// A run in words: its name, what is told beside it, and what came of it.
import { kindOf } from "./features.js";
import { count, distanceApart, metres, nameOf, percentage, sentence, whole } from "./format.js";
import { commonInWords, differenceInWords, fieldsOf, variedIn } from "./run-settings.js";
import { distanceOf } from "./runs.js";
import { earlyEndOf } from "./narrative/moment.js";
import { isActive, isWalk } from "./selectors.js";
import { agentOf } from "./settings.js";
import { references } from "./store.js";

/** @import { AnyRun } from "./runs.js" */
/** @import { LaneResult, Run } from "./types.js" */

/** Of a run that a link names, or that was open. */
export const NO_SUCH_RUN = "There is no such run: it was deleted, or the link is wrong.";

// ---- names

/** Whether a person has named a run; a damaged one has the name that could be read. @param {AnyRun} run */
export const isNamed = (run) => "damaged" in run || run.is_named;

/** The name of a run by itself. @param {AnyRun} run */
export function titleOf(run) {
  if ("damaged" in run) return run.name || `A ${run.kind ?? "run"} that cannot be read`;
  return kindOf(run)?.titleOf(run) ?? (nameOf(run) || sentence(run.kind));
}

/** Words that begin a line: a symbol stays as it is. @param {string} words */
export const beginning = (words) => (/^[a-z]/.test(words) ? sentence(words) : words);

/** A text as it is compared: names that people type have plain spaces. @param {string} text */
const plain = (text) => text.toLowerCase().replaceAll("\u00a0", " ");

/**
 * What is told of a run beside its name: what its name has, and what is by default, is left out.
 * @param {Run} run
 */
export function factsOf(run) {
  if (!isWalk(run)) return [kindOf(run)?.describe(run) ?? ""].filter(Boolean);
  const title = plain(titleOf(run));
  return commonInWords([fieldsOf(run)], []).filter((fact) => !title.includes(plain(fact)));
}

// ---- what came of it

/** @param {Run} run @returns {number | null} */
export const greedyOf = ({ id, kind, greedy_distance_m, result }) =>
  (kind === "training" ? greedy_distance_m ?? references.value[id] ?? result?.greedy_distance_m ?? null : null);

/** Share of greedy's distance on the same robot; null where either is not known. @param {Run} run */
export function shareOf(run) {
  const [distance, greedy] = [distanceOf(run), greedyOf(run)];
  return run.kind === "training" && distance !== null && greedy ? percentage(distance / greedy) : null;
}

/** The lanes of a race at time-out under the paper clock, the first before the others. @param {Run} run */
export const ranked = ({ result }) => (result?.lanes ?? [])
  .map((lane, number) => ({ number, lane, ...lane.clocks.paper }))
  .sort((a, b) => (a.rank ?? Infinity) - (b.rank ?? Infinity));

/**
 * The first lane of a race; null without ranks, and of a race that was stopped before its time-out, which earlier
 * versions ranked.
 * @param {Run} run
 * @returns {LaneResult | null}
 */
export function winnerOf(run) {
  const [first] = ranked(run);
  const isTimedOut = run.result?.lanes?.some(({ steps }) => steps >= run.config.steps);
  return first?.rank === 1 && isTimedOut ? first.lane : null;
}

/** Why the lanes of a race have no ranks: "Stopped at step 26 of 50, before its time-out: not ranked." */
/** @param {Run} run */
export function unrankedInWords(run) {
  const reached = (run.result?.lanes ?? []).map(({ steps }) => steps);
  const end = earlyEndOf(run);
  if (!end || !reached.length) return "Not ranked: no robot has used all its steps.";
  const [first, last] = [Math.min(...reached), Math.max(...reached)];
  const at = first === last ? `step ${whole(first)}` : `steps ${whole(first)} to ${whole(last)}`;
  return `${end.word} at ${at} of ${whole(run.config.steps)}, before its time-out: not ranked.`;
}

/** The result of a run in short: "0.33 m", "Greedy 0.32 m"; empty without one. @param {AnyRun} run */
export function resultInWords(run) {
  if ("damaged" in run || !isWalk(run)) return "";
  const distance = distanceOf(run);
  if (run.kind === "training") return run.result ? metres(distance) : "";
  const winner = winnerOf(run);
  return winner ? `${agentOf(winner.agent).title} ${metres(distance)}` : "";
}

/** A name with what came of it: "500 steps, α 0.3 → 0.33 m". @type {(name: string, run: AnyRun) => string} */
export const withResult = (name, run) => [name, resultInWords(run)].filter(Boolean).join(" → ");

/** A walk that gains under a centimetre in ten steps is none; it has fifty. */
const MARCHING_M = 0.05;
const LEVEL_M = 0.01;

/** What came of a run besides its distance: "marching on the spot", "Greedy 3 cm before Sarsa". @param {Run} run */
export function outcomeInWords(run) {
  if (!isWalk(run)) return kindOf(run)?.paceOf(run).label ?? "";
  if (run.state === "queued") return "";
  if (isActive(run)) return run.progress.total ? percentage(run.progress.done / run.progress.total) : "";
  return run.kind === "race" ? marginInWords(run) : practiceInWords(run);
}

/** @param {Run} run */
function practiceInWords({ state, progress, result }) {
  const { distance_m = null, fell_at_step: fell = null } = result ?? {};
  return [
    state === "finished" ? "" : `after ${count(progress.done, "step")}`,
    distance_m === null ? "" : walkInWords(distance_m),
    fell === null ? "" : `fell at step ${whole(fell + 1)}`,
  ].filter(Boolean).join(", ");
}

/** What a distance says of the walk; empty of one that goes on. @param {number} distance_m */
function walkInWords(distance_m) {
  if (distance_m <= -MARCHING_M) return "walks backwards";
  return distance_m < MARCHING_M ? "marching on the spot" : "";
}

/** By how much a race was won. @param {Run} run */
function marginInWords(run) {
  const winner = winnerOf(run);
  const [first, second] = ranked(run);
  const [a, b] = [first?.finished_distance_m ?? null, second?.finished_distance_m ?? null];
  if (!winner || a === null || b === null) return "";
  const [best, next] = [winner, second.lane].map(({ agent }) => agentOf(agent).title);
  return a - b < LEVEL_M ? `${best} level with ${next}` : `${best} ${distanceApart(a - b)} before ${next}`;
}

// ---- names among others

/** The fields of trainings, or of races; none where runs are of several kinds. @param {AnyRun[]} all */
export const fieldsOfAll = (all) =>
  (all.every((run) => !("damaged" in run) && isWalk(run) && run.kind === all[0].kind)
    ? /** @type {Run[]} */ (all).map(fieldsOf) : []);

/** What runs have in common, in words. @param {AnyRun[]} all */
export function commonFacts(all) {
  const fields = fieldsOfAll(all);
  return fields.length ? commonInWords(fields, variedIn(fields)) : [];
}

/** Runs that differ in more have their own names. */
const MAX_TOLD = 3;

/**
 * Short names for runs that are shown together, by what they differ in: "α 0.3"; those that people gave stay.
 * @param {AnyRun[]} runs
 * @returns {string[]}
 */
export function namesAmong(runs) {
  const fields = fieldsOfAll(runs);
  const varied = variedIn(fields);
  const isShort = varied.length > 0 && varied.length <= MAX_TOLD;
  const names = runs.map((run, n) =>
    (isNamed(run) || !isShort ? titleOf(run) : beginning(differenceInWords(fields[n], varied))));
  return names.map((name, n) => {
    const before = names.slice(0, n).filter((other) => other === name).length;
    return before ? `${name} (${before + 1})` : name;
  });
}
