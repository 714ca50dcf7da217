// Every sentence about the run on stage and the moment of it that is shown: one table of states × what is said, from
// what the API tells. The page, phones and projectors show what it returns, and say no more.
import { sentence, times, whole } from "../format.js";
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
const ABOUT = "It tries moves, keeps what each was worth, and races against two that think ahead.";

/** @type {Record<State, Partial<Narration>>} */
const TABLE = {
  "nothing": {
    headline: () => "A hexapod learns to walk", reason: () => ABOUT,
    bar: () => "The robots stand on the start line.", board: () => "The lanes of the next race.",
  },
  "loading": {
    headline: ({ isAway }) => (isAway ? "Waiting for the server" : "Loading…"),
    bar: (facts) => (facts.isOwn ? loading(facts) : "Its first steps are being computed."),
    board: () => "Loading the run on the stage…",
  },
  "lost": {
    headline: () => "No run is shown", bar: () => "No run is shown.",
    board: () => "No run is shown, so there are no figures.",
  },
  "void": { headline: noStep, bar: noStep, board: (facts) => `${noStep(facts)}.`, isEnd: true, isOfRun: true },
  "waiting": {
    headline: () => "On the start line",
    board: ({ run }) => (isActive(run) ? "The race is about to begin." : "Its figures come with the picture."),
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
const STOOD = "This is the last that is known.";

// ---- the sentences of single states

/** @param {Facts} facts */
function noStep({ run }) {
  return `${earlyEndOf(run)?.word} before its first step`;
}

/** @param {Facts} facts */
function firstSteps({ run }) {
  if (run && !isActive(run)) return "Its picture is not here yet.";
  return run?.state === "queued" ? "It waits for its turn." : "Its first steps are being computed.";
}

/** @param {Facts} facts */
function beforeRace({ race }) {
  return race ? "The race starts when practice is over." : "The lanes of the next race.";
}

/** @param {Facts} facts */
function loading({ isAway }) {
  return isAway ? "Your replay waits for the server." : "Loading your replay…";
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
const announced = ({ run }, end) => (run?.state === "failed" ? `The ${run.kind} failed: ${run.error ?? ""}` : end);

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
    what: `The ${run.kind} ${end.verb}${done ? whereLeft(run) : " before its first step"}.`,
    words: done ? lastPicture(run, recordedStep) : "",
    action: goesOnWith && canResume ? { label: goOnLabel(run, goesOnWith), does: "resume", run: goesOnWith } : null,
  };
}

/** Of a race the headline tells it, by lane. @param {Run} run */
const whereLeft = ({ kind, progress: { done, total } }) =>
  (kind === "training" ? ` at step ${whole(done)} of ${whole(total)}` : "");

/** @param {Run} run @param {Run} resumed */
const goOnLabel = (run, resumed) => (resumed.id === run.id ? "Go on" : `Go on with the ${resumed.kind}`);

/** A crash loses the steps since the last checkpoint, which count as done. */
/** @param {Run} run @param {number | null} recorded */
function lastPicture({ kind, progress: { done } }, recorded) {
  if (kind !== "training" || recorded === null || recorded >= done) return "This is its last picture.";
  return `What came after step ${whole(recorded)} is lost: this is its last picture.`;
}

// ---- labels over the picture, and of the button that plays

/** @typedef {{ kind: string, words: string }} Chip */

/** @param {Facts} facts @returns {Chip[]} */
function chipsOf(facts) {
  const { scene, conditions, ghosts } = facts;
  const phase = PHASES[scene?.phase ?? ""];
  return [
    { kind: "strong", words: scene?.label || nothing(facts) },
    ...(phase ? [phase] : []),
    ...(conditions.length ? [{ kind: "disturbance", words: sentence(conditions.join(", ")) }] : []),
    ...replayOf(facts),
    ...(ghosts === null ? [] : [{ kind: "ghosts", words: ghosts }]),
    ...speedOf(facts),
  ];
}

/** @type {Record<string, Chip | undefined>} */
const PHASES = {
  "photo-finish": { kind: "accent", words: "Time-out: photo finish" },
  "waiting": { kind: "", words: "Waiting for a robot that is still deciding" },
};

/** @param {Facts} facts @returns {Chip[]} */
function replayOf(facts) {
  const { scene, isOwn, isOfGuest, isAway, isBuffering, problem } = facts;
  if (!isOwn) return scene?.replay ? [{ kind: "", words: "Recorded" }] : [];
  if (problem) return [];
  // While the server is away a note says so.
  const words = isBuffering && !isAway ? loading(facts) : isOfGuest ? "Your robot" : "Your replay";
  return [{ kind: "accent", words }];
}

/** @param {Facts} facts */
function nothing(facts) {
  if (!facts.isOwn) return "On the start line";
  return facts.problem ? "No run is shown" : loading(facts);
}

/** Whose picture this page shows: everyone's, or one of its own. @param {Facts} facts */
const pictureName = ({ isOwn }) => (isOwn ? "replay" : "stage");

/** @param {Facts} facts @returns {Chip[]} */
function speedOf(facts) {
  const { scene, stage, isAway, isOwn, isBuffering } = facts;
  if (!scene || scene.kind === "idle" || stage?.ended) return [];
  if (stage?.playing === false) return [{ kind: "", words: `${sentence(pictureName(facts))} paused` }];
  const isStill = (isAway && !isOwn) || isBuffering || !(scene.shown_speed > 0);
  return isStill ? [] : [{ kind: "speed", words: times(scene.shown_speed) }];
}

/** @param {Facts} facts */
function playLabel(facts) {
  const { stage, isAway, isOwn, canPlay } = facts;
  const isPlaying = Boolean(stage?.playing && !stage.ended && (!isAway || isOwn));
  // Who may not play the stage begins a replay with it.
  const what = isOwn ? "your replay" : canPlay ? "the stage" : "in a replay";
  const again = stage?.ended ? " again" : "";
  return { isPlaying, label: `${isPlaying ? "Pause" : "Play"} ${what}${again}` };
}
