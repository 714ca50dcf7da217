// What is said of the run on stage at the moment that is shown, kept up to date; and what is announced to screen
// readers. The sentences are those of narrative/narrative.js.
import { computed, effect, signal } from "@preact/signals";
import { disturbancesOf, inTime, joinedBySteps } from "./disturbances.js";
import { metres, nameOf, sentence, t } from "./format.js";
import { canPlay, conditionsShown, raceInView, resumableOnStage, shownRun } from "./on-stage.js";
import { page } from "./page-state.js";
import { knownRace } from "./race.js";
import { isBuffering, isOwn, playback, replayProblem } from "./player.js";
import { narrativeOf } from "./narrative/narrative.js";
import { isOperator, guestRuns } from "./selectors.js";
import { agentOf } from "./settings.js";
import { connection, isAway, runs, scene } from "./store.js";
import { scale } from "./time.js";
import { clockTitle } from "./titles.js";
import { curve } from "./training.js";

/** @import { ReadonlySignal, Signal } from "@preact/signals" */
/** @import { Known } from "./narrative/narrative.js" */
/** @import { Run } from "./types.js" */

// ---- what is known of the run on stage and its moment

/** What happens in a run, in words. @param {Run | null} run */
const happenedIn = (run) => joinedBySteps(run ? disturbancesOf(run) : [])
  .map((disturbance) => {
    const { at_step, until_step } = disturbance;
    return { at_step, until_step, words: sentence(inTime(disturbance)) };
  });

/** The tests of the practice on stage, in its own steps. @param {Run | null} run */
function testsOf(run) {
  const learningCurve = curve.value?.run.id === run?.id ? curve.value : null;
  return (learningCurve?.points ?? []).map((point) => ({ ...point, step: point.step - (learningCurve?.from ?? 0) }));
}

/** Of which run the ghosts are, and how far they came; null without any. */
function ghostsInWords() {
  if (page.ghost.value === null) return null;
  const run = runs.value.get(page.ghost.value);
  const title = run ? nameOf(run) || sentence(run.kind) : t("another run");
  const distances = (scene.value?.ghost_lanes ?? []).map(({ name, distance_m }) => `${name} ${metres(distance_m)}`);
  return t("Ghosts: {run}", { run: title + (distances.length ? ` (${distances.join(", ")})` : "") });
}

/** The scene, if it is not that of another run than the one on stage. @param {Run | null} run */
const sceneOf = (run) => (!run || scene.value?.run_id === run.id ? scene.value : null);

/** @type {ReadonlySignal<Known>} */
const situation = computed(() => {
  const run = shownRun.value;
  return {
    ...knownRace.value, run, race: run?.kind === "race" ? run : raceInView.value,
    scene: sceneOf(run), stage: playback.value,
    tests: run?.kind === "training" ? testsOf(run) : [], happened: run?.kind === "race" ? happenedIn(run) : [],
    conditions: conditionsShown.value, clockTitle: clockTitle(knownRace.value.clock),
    recordedStep: run?.kind === "training" ? scale.value?.computed ?? null : null,
    goesOnWith: resumableOnStage.value, ghosts: ghostsInWords(), problem: replayProblem.value,
    isAway: isAway.value, isOwn: isOwn.value,
    isOfGuest: guestRuns.value.includes(page.run.value ?? ""), isBuffering: isBuffering.value,
    canPlay: canPlay.value, canResume: isOperator.value,
  };
});

/** All that is said of it: see `narrativeOf`. */
export const narrative = computed(() => narrativeOf(situation.value));

/** How it stands in one sentence, where it is one of the run on stage; else null. */
export const headline = computed(() => (narrative.value.isOfRun ? narrative.value.headline : null));

/**
 * The move that the explanation is about, told by its tab while it is open; null without one.
 * @type {Signal<{ title: string, reason: string, color: string } | null>}
 */
export const moveTold = signal(null);

/** Why an agent's steps gain nothing. @param {string} agent */
export function whyMarching(agent) {
  const { learns, searches } = agentOf(agent);
  const gain = t("under 1 cm in ten steps");
  if (learns) {
    return t("{gain}: moves that undo each other still have the highest values. More practice changes that.", { gain });
  }
  return searches ? t("{gain}: no move that it simulates gains distance on this robot.", { gain }) : `${gain}.`;
}

// ---- announcements for screen readers, each made once: who takes the lead, results, failures, a lost connection

const LOST = t("Connection lost, reconnecting");
/** Robots that overtake each other in turn are told of at most so often [ms]. */
const LEAD_PAUSE_MS = 4000;

/** The text of the page's live region. */
export const announcement = signal("");

export function announceOutcomes() {
  const outcome = computed(() => {
    const { announcement: words } = narrative.value;
    return words ? `${shownRun.value?.id} ${words}` : "";
  });
  announceLeads();
  effect(() => {
    const [, ...words] = outcome.value.split(" ");
    if (words.length) announcement.value = words.join(" ");
  });
  effect(() => {
    if (connection.value === "reconnecting") announcement.value = LOST;
    else if (connection.value === "live" && announcement.peek() === LOST) announcement.value = t("Connected again");
  });
}

/** Announce each new leader of a race, the newest of those who change within the pause. */
function announceLeads() {
  const leading = computed(() => {
    const { leader, state } = narrative.value;
    return leader ? `${shownRun.value?.id} ${leader.lane}` : state === "racing" ? "level" : "";
  });
  let told = "";
  let last_ms = -Infinity;
  /** @type {ReturnType<typeof setTimeout> | undefined} */
  let waiting;
  const tell = () => {
    waiting = undefined;
    const { leader } = narrative.peek();
    // Where it ends meanwhile the outcome is announced; who leads again has been told already.
    if (!leader || leading.peek() === told) return;
    [told, last_ms] = [leading.peek(), performance.now()];
    announcement.value = leader.words;
  };
  effect(() => {
    if (leading.value === "") told = "";
    if (leading.value === "level" || leading.value === told || waiting !== undefined) return;
    const pause_ms = last_ms + LEAD_PAUSE_MS - performance.now();
    if (pause_ms <= 0) tell();
    else waiting = setTimeout(tell, pause_ms);
  });
}
