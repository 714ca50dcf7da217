// Every sentence about the run on stage and the moment of it that is shown: one table of states × what is said, from
// what the API tells. The page, phones and projectors show what it returns, and say no more.
import { labelInWords, nameOf, sentence, t, times } from "../format.js";
import { earlyEndOf, isActive, isTimedOutIn, rowsOf } from "./moment.js";
import {
  brokenOff, halting, lead, leaderOf, leftOff, practised, practising, reasonOf, ruleAfter, ruleBefore, ruleOfNone,
  verdict, whyBrokenOff, whyPractised, whyPractising, workOf,
} from "./sentences.js";

/** @import { CurvePoint } from "../training.js" */
/** @import { Run, Scene, Stage } from "../types.js" */
/** @import { Happening, KnownRace, Row } from "./moment.js" */
/** @import { KnownPractice } from "./sentences.js" */

/**
 * What is known of the run on stage and its moment, in plain data. `scene` is of that run.
 * @typedef {KnownRace & {
 *   run: Run | null, stage: Pick<Stage, "run_id" | "phase" | "playing" | "ended"> | null,
 *   tests: CurvePoint[], happened: Happening[], conditions: string[], clockTitle: string,
 *   recordedStep: number | null, goesOnWith: Run | null, ghosts: string | null, problem: string | null,
 *   isAway: boolean, isOwn: boolean, isOfGuest: boolean, isBuffering: boolean, canPlay: boolean, canResume: boolean,
 * }} Known
 * `tests`: of a practice, in its own steps. `recordedStep`: the last of a practice that is recorded. `goesOnWith`: the
 * run that going on with this one resumes. `ghosts`: of which run they are. `problem`: why there is no replay. `isOwn`:
 * whether it is a replay of this page's own, of the guest's own robot if `isOfGuest`.
 */

/**
 * Where a run is at the moment that is shown.
 * @typedef {"nothing" | "loading" | "lost" | "void" | "waiting" | "practising" | "practised" | "broken off"
 *   | "racing" | "halting" | "left off" | "timed out"} State
 */

/** What is known, with what follows of it. @typedef {Known & { state: State, rows: Row[] | null }} Facts */

/**
 * What is said in a state; what is left out is said by `SILENT`. `rule`: by which a race is ranked. `bar`: in place of
 * the time bar. `board`: above the lanes before there is a board. `isEnd`: the run goes on no more from here, which is
 * announced. `isOfRun`: it is about the run on stage. `isUnseen`: without the server it may have gone on.
 * @typedef {object} Narration
 * @property {(facts: Facts) => string} headline
 * @property {(facts: Facts) => string | null} reason
 * @property {(facts: Facts) => string | null} rule
 * @property {(facts: Facts) => string} bar
 * @property {(facts: Facts) => string} board
 * @property {boolean} isEnd
 * @property {boolean} isOfRun
 * @property {boolean} isUnseen
 */

/** @type {Narration} */
const SILENT = {
  headline: () => "", reason: () => null, rule: () => null, bar: firstSteps, board: () => "",
  isEnd: false, isOfRun: false, isUnseen: false,
};

/** @type {<Value>(tell: (known: KnownPractice) => Value) => (facts: Facts) => Value} */
const ofPractice = (tell) => (facts) => tell(knownPractice(facts));
/** Of a state in which there are rows. @type {<Value>(tell: (rows: Row[]) => Value) => (facts: Facts) => Value} */
const ofRows = (tell) => ({ rows }) => tell(/** @type {Row[]} */ (rows));
/** @type {(tell: (known: KnownRace, rows: Row[]) => string) => (facts: Facts) => string} */
const ofHalted = (tell) => (facts) => tell(facts, /** @type {Row[]} */ (facts.rows));
/** @type {(facts: Facts) => string} */
const ruleToCome = (facts) => ofRows((rows) => ruleBefore(facts.clockTitle, rows))(facts);
/** @type {(facts: Facts) => string} */
const ruleOfRanks = (facts) => ofRows((rows) => ruleAfter(facts.clockTitle, facts, rows))(facts);
/** @type {(facts: Facts) => string} */
const whyNotRanked = (facts) => ruleOfNone(facts.clockTitle, facts);
const ABOUT = t("It tries moves, keeps what each was worth, and races against two that think ahead.");

/** @type {Record<State, Partial<Narration>>} */
const TABLE = {
  "nothing": {
    headline: () => t("A hexapod learns to walk"), reason: () => ABOUT,
    bar: () => t("The robots stand on the start line."), board: () => t("The lanes of the next race."),
  },
  "loading": {
    headline: ({ isAway }) => (isAway ? t("Waiting for the server") : t("Loading…")),
    bar: (facts) => (facts.isOwn ? loading(facts) : t("Its first steps are being computed.")),
    board: () => t("Loading the run on the stage…"),
  },
  "lost": {
    headline: () => t("No run is shown"), bar: () => t("No run is shown."),
    board: () => t("No run is shown, so there are no figures."),
  },
  "void": { headline: noStep, bar: noStep, board: (facts) => `${noStep(facts)}.`, isEnd: true, isOfRun: true },
  "waiting": {
    headline: () => t("On the start line"),
    board: ({ run }) => (isActive(run) ? t("The race is about to begin.") : t("Its figures come with the picture.")),
    isUnseen: true,
  },
  "practising": {
    headline: ofPractice(practising), reason: ofPractice(whyPractising), board: beforeRace, isOfRun: true,
    isUnseen: true,
  },
  "practised": {
    headline: ofPractice(practised), reason: ofPractice(whyPractised), board: beforeRace, isOfRun: true,
  },
  "broken off": {
    headline: ofPractice(brokenOff), reason: ofPractice(whyBrokenOff), board: beforeRace, isEnd: true, isOfRun: true,
  },
  "racing": { headline: ofRows(lead), reason: whyAhead, rule: ruleToCome, isOfRun: true, isUnseen: true },
  "halting": { headline: ofHalted(halting), rule: whyNotRanked, isOfRun: true, isUnseen: true },
  "left off": { headline: ofHalted(leftOff), rule: whyNotRanked, isEnd: true, isOfRun: true },
  "timed out": { headline: ofRows(verdict), reason: whyWon, rule: ruleOfRanks, isEnd: true, isOfRun: true },
};

/** @param {Known} known @param {Row[] | null} rows @returns {State} */
function stateOf({ run, scene, stage, isOwn, problem }, rows) {
  if (!run && problem) return "lost";
  if (!run) return isOwn || stage?.run_id ? "loading" : "nothing";
  if (earlyEndOf(run) && !run.progress.done) return "void";
  if (!scene || scene.run_id !== run.id || (run.kind === "race" && !rows)) return "waiting";
  return run.kind === "race" ? stateOfRace(run, scene) : stateOfPractice(run, scene);
}

/** @param {Run} run @param {Scene} scene @returns {State} */
function stateOfPractice(run, scene) {
  if (scene.phase === "start-line" && !scene.ended) return "waiting";
  if (isActive(run) || !scene.ended) return "practising";
  return earlyEndOf(run) ? "broken off" : "practised";
}

/** @param {Run} run @param {Scene} scene @returns {State} */
function stateOfRace(run, scene) {
  if (isTimedOutIn(scene)) return "timed out";
  if (!earlyEndOf(run)) return "racing";
  if (scene.ended) return "left off";
  return scene.lanes.some(({ halted }) => halted) ? "halting" : "racing";
}

/**
 * All that is said of a run and its moment.
 * @param {Known} context
 */
export function narrativeOf(context) {
  const rows = rowsOf(context);
  const facts = { ...context, rows, state: stateOf(context, rows) };
  const entry = { ...SILENT, ...TABLE[facts.state] };
  const headline = entry.headline(facts);
  return {
    state: facts.state,
    rows,
    headline,
    reason: entry.isUnseen && context.isAway && !context.isOwn ? STOOD : entry.reason(facts),
    rule: entry.rule(facts),
    bar: entry.bar(facts),
    board: entry.board(facts),
    isOfRun: entry.isOfRun,
    leader: facts.state === "racing" ? leaderOf(/** @type {Row[]} */ (rows)) : null,
    color: rows ? colorOfLanes(facts, rows) : colorOf(facts),
    note: noteOf(facts),
    chips: chipsOf(facts),
    play: playLabel(facts),
    announcement: announced(facts, entry.isEnd ? headline : ""),
  };
}

/** Said of what may go on unseen. */
const STOOD = t("This is the last that is known.");

// ---- the sentences of single states

/** @param {Facts} facts */
function noStep({ run }) {
  return t("{end} before its first step", { end: earlyEndOf(run)?.word ?? "" });
}

/** @param {Facts} facts */
function firstSteps({ run }) {
  if (run && !isActive(run)) return t("Its picture is not here yet.");
  return run?.state === "queued" ? t("It waits for its turn.") : t("Its first steps are being computed.");
}

/** @param {Facts} facts */
function beforeRace({ race }) {
  return race ? t("The race starts when practice is over.") : t("The lanes of the next race.");
}

/** @param {Facts} facts */
function loading({ isAway }) {
  return isAway ? t("Your replay waits for the server.") : t("Loading your replay…");
}

/** @param {Facts} facts */
function knownPractice({ run, scene, agents, tests, state }) {
  const training = /** @type {Run} */ (run);
  const stepsMade = state === "practising" ? scene?.lanes[0]?.steps_made ?? 0 : Infinity;
  const name = training.config.agent;
  return {
    training, title: agents.find((agent) => agent.name === name)?.title ?? name,
    newest: tests.findLast(({ step }) => step > 0 && step <= stepsMade) ?? null,
  };
}

/** @param {Facts} facts */
function whyAhead({ rows, timeline, scene, happened }) {
  if (!rows || !timeline || !scene) return null;
  return reasonOf(rows, timeline.lanes, { time_s: scene.time_s, isPast: false }, happened);
}

/** Of the race at its time-out. @param {Facts} facts */
function whyWon({ rows, timeline, happened }) {
  const time_s = timeline?.first_finish_s ?? null;
  if (!rows || !timeline || time_s === null) return null;
  const why = reasonOf(rows, timeline.lanes, { time_s, isPast: true }, happened);
  const isTie = rows.filter(({ rank }) => rank === 1).length > 1;
  const work = isTie ? null : workOf(timeline.lanes[rows[0].lane], time_s, rows[0].steps);
  if (!work) return why;
  // Of 25 words: the time of thinking tells what simulating moves cost.
  const [first = null] = why?.split(/(?<=\.) /) ?? [];
  return [first, work].filter(Boolean).join(" ");
}

/** The colour of the first lane; of none while others are on their way to where they were left. */
/** @param {Facts} facts @param {Row[]} rows */
const colorOfLanes = ({ state }, [first]) => (state === "halting" ? "transparent" : first.color);

/** The colour of the learner that practises. @param {Facts} facts */
const colorOf = ({ run, agents }) =>
  (run?.kind === "training" && agents.find(({ name }) => name === run.config.agent)?.color) || "transparent";

/** A failure is announced at once, other outcomes when the picture shows them. */
/** @param {Facts} facts @param {string} end */
const announced = ({ run }, end) =>
  (run?.state === "failed" ? t("The {run} failed: {reason}", { run: nounOf(run), reason: run.error ?? "" }) : end);

// ---- the note of a run that ended early, and what can be done

/**
 * Where it ended, and what goes on from there; null while nothing has ended so, or the picture is not there.
 * @param {Facts} facts
 * @returns {{ what: string, words: string, action: { label: string, does: "resume", run: Run } | null } | null}
 */
function noteOf({ run, stage, state, isAway, isOwn, goesOnWith, canResume, recordedStep }) {
  const isThere = !isAway && !isOwn && (stage?.ended ?? true) && state !== "waiting";
  const end = earlyEndOf(run);
  if (!run || !end || !isThere) return null;
  const { done } = run.progress;
  return {
    what: whatEnded(run, end.verb),
    words: done ? lastPicture(run, recordedStep) : "",
    action: goesOnWith && canResume ? { label: goOnLabel(run, goesOnWith), does: "resume", run: goesOnWith } : null,
  };
}

/** A run by its kind. @param {Run} run */
const nounOf = ({ kind }) => (kind === "race" ? t("race") : t("training"));

/** Where a run has ended; of a race the headline tells it, by lane. @param {Run} run @param {string} verb */
function whatEnded(run, verb) {
  const { kind, progress: { done, total: steps } } = run;
  const values = { run: nounOf(run), verb, step: done, steps };
  if (!done) return t("The {run} {verb} before its first step.", values);
  return kind === "race" ? t("The {run} {verb}.", values) : t("The {run} {verb} at step {step} of {steps}.", values);
}

/** @param {Run} run @param {Run} resumed */
const goOnLabel = (run, resumed) =>
  (resumed.id === run.id ? t("Go on") : t("Go on with the {run}", { run: nounOf(resumed) }));

/** A crash loses the steps since the last checkpoint, which count as done. */
/** @param {Run} run @param {number | null} recorded */
function lastPicture({ kind, progress: { done } }, recorded) {
  if (kind !== "training" || recorded === null || recorded >= done) return t("This is its last picture.");
  return t("What came after step {step} is lost: this is its last picture.", { step: recorded });
}

// ---- labels over the picture, and of the button that plays

/** @typedef {{ kind: string, words: string }} Chip */

/** @param {Facts} facts @returns {Chip[]} */
function chipsOf(facts) {
  const { run, scene, conditions, ghosts } = facts;
  const label = scene?.label ?? "";
  const named = run && label.startsWith(run.name) ? nameOf(run) + label.slice(run.name.length) : label;
  const phase = PHASES[scene?.phase ?? ""];
  return [
    { kind: "strong", words: labelInWords(named) || nothing(facts) },
    ...(phase ? [phase] : []),
    ...(conditions.length ? [{ kind: "disturbance", words: sentence(conditions.join(", ")) }] : []),
    ...replayOf(facts),
    ...(ghosts === null ? [] : [{ kind: "ghosts", words: ghosts }]),
    ...speedOf(facts),
  ];
}

/** @type {Record<string, Chip | undefined>} */
const PHASES = {
  "photo-finish": { kind: "accent", words: t("Time-out: photo finish") },
  "waiting": { kind: "", words: t("Waiting for a robot that is still deciding") },
};

/** @param {Facts} facts @returns {Chip[]} */
function replayOf(facts) {
  const { scene, isOwn, isOfGuest, isAway, isBuffering, problem } = facts;
  if (!isOwn) return scene?.replay ? [{ kind: "", words: t("Recorded") }] : [];
  if (problem) return [];
  // While the server is away a note says so.
  const words = isBuffering && !isAway ? loading(facts) : isOfGuest ? t("Your robot") : t("Your replay");
  return [{ kind: "accent", words }];
}

/** @param {Facts} facts */
function nothing(facts) {
  if (!facts.isOwn) return t("On the start line");
  return facts.problem ? t("No run is shown") : loading(facts);
}

/** @param {Facts} facts @returns {Chip[]} */
function speedOf(facts) {
  const { scene, stage, isAway, isOwn, isBuffering } = facts;
  if (!scene || scene.kind === "idle" || stage?.ended) return [];
  if (stage?.playing === false) return [{ kind: "", words: isOwn ? t("Replay paused") : t("Stage paused") }];
  const isStill = (isAway && !isOwn) || isBuffering || !(scene.shown_speed > 0);
  return isStill ? [] : [{ kind: "speed", words: times(scene.shown_speed) }];
}

/** Of the button that plays: to play, to pause, to play again. */
const PLAY_LABELS = {
  own: [t("Play your replay"), t("Pause your replay"), t("Play your replay again")],
  stage: [t("Play the stage"), t("Pause the stage"), t("Play the stage again")],
  begin: [t("Play in a replay"), t("Pause in a replay"), t("Play in a replay again")],
};

/** @param {Facts} facts */
function playLabel(facts) {
  const { stage, isAway, isOwn, canPlay } = facts;
  const isPlaying = Boolean(stage?.playing && !stage.ended && (!isAway || isOwn));
  // Who may not play the stage begins a replay with it.
  const [play, pause, again] = isOwn ? PLAY_LABELS.own : canPlay ? PLAY_LABELS.stage : PLAY_LABELS.begin;
  return { isPlaying, label: isPlaying ? pause : stage?.ended ? again : play };
}
