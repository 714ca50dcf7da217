// The first lesson: cards that are tied to what happens on the page. A card comes when that happens, or when the
// highlighted button of the card before it is pressed, which is the only one. What this page may not start or change,
// it watches or replays. A vote before the race is answered by the race itself.
import { computed } from "@preact/signals";
import { adopt, attempt, pending } from "../../js/actions.js";
import { startRace, startTraining } from "../../js/api.js";
import { decimal, metres, percentage, t, whole } from "../../js/format.js";
import { narrative } from "../../js/headline.js";
import { distanceOf, earlyEndOf, isShownToEnd } from "../../js/narrative/moment.js";
import { clock, phase, raceInView, raceScene, shownRun, trainingInView } from "../../js/on-stage.js";
import { page } from "../../js/page-state.js";
import { closeReplay, isOwn, openReplay, playReplay, position } from "../../js/player.js";
import { isTimedOut, standings } from "../../js/race.js";
import {
  everyRun, hasTable, isActive, isOperator, mayStart, simulatedPerDecision, trainingIds,
} from "../../js/selectors.js";
import { agentOf, laneTitle, learns, served } from "../../js/settings.js";
import { isAway, scene, stage } from "../../js/store.js";
import { curve, presentRates, rateChanges } from "../../js/training.js";
import { explainingTab, openExplanation, openTab, setDepth, tab } from "../../js/workspace.js";
import { isComing, isInPicture, keep, KINDS, lessonProgress, practice, race } from "./lesson.js";

/** @import { Progress } from "./lesson.js" */
/** @import { Standing } from "../../js/race.js" */
/** @import { Rates, Run } from "../../js/types.js" */

/** The highlighted button. @typedef {{ label: string, run: () => unknown, isHeld?: boolean }} Press */
/**
 * What a card says now. `press`: null where its vote is what is to be pressed.
 * @typedef {{ title: string, text: string, press: Press | null }} Said
 */
/**
 * `comes`: whether what brings it is on the page; without it, a press alone brings it. `holds`: whether what happens
 * does not turn it. `of`: the run that has to be in the picture. `shows`: what of the page it is about. `isThere`:
 * whether this page has it; without it, each has.
 * @typedef {{
 *   name: string, say: () => Said, comes?: () => boolean, holds?: () => boolean, of?: "practice" | "race",
 *   shows: string, isThere?: () => boolean,
 * }} FirstCard
 */

// ---- what it is about

/** Whether α can be changed in its practice: only in one that this page has started, as others watch theirs. */
const steers = computed(() =>
  isOperator.value && (lessonProgress.value.practice === null || lessonProgress.value.isMine));

/** A practice to watch: that of the lesson, of the page, or the newest; of who may start runs only one that goes on. */
const practiceToWatch = computed(() => {
  const all = [practice.value, trainingInView.value, ...everyRun.value.filter(({ kind }) => kind === "training")];
  return all.find((run) => run && run.progress.done > 0 && (isActive(run) || !mayStart.value)) ?? null;
});

/** A race to watch: one of the practice; for those who can start none, else that of the page, or the newest. */
const raceToWatch = computed(() => {
  const races = everyRun.value.filter((run) => run.kind === "race" && run.progress.done > 0 && !earlyEndOf(run));
  const itsRace = races.find((run) => trainingIds(run).includes(lessonProgress.value.practice ?? ""));
  const inView = races.find(({ id }) => id === raceInView.value?.id);
  return itsRace ?? (mayStart.value ? null : inView ?? races[0] ?? null);
});

/** Whether a practice that this page is to follow has begun in the picture. */
const hasPracticeBegun = () => {
  const run = practice.value ?? practiceToWatch.value;
  const isToFollow = lessonProgress.value.practice !== null || isActive(run);
  return isToFollow && isInPicture(run) && (scene.value?.lanes[0]?.steps_made ?? 0) > 0;
};

/** The tests of the practice that are shown. */
const tests = () => (curve.value && curve.value.run.id === practice.value?.id
  ? curve.value.points.filter(({ step }) => step > (curve.value?.from ?? 0)) : []);

/** α in the practice now; null of a learner without it. */
const alphaNow = () => {
  const run = practice.value;
  const value = run && (presentRates(run).alpha ?? run.config.settings.alpha);
  return typeof value === "number" ? value : null;
};

/** The last change of α while it practised. */
const alphaChange = () =>
  (practice.value ? rateChanges(practice.value).findLast(({ name }) => name === "alpha") : undefined);

/** Whether a race that this page is to follow has begun in the picture: its own, or one that others watch now. */
const hasRaceBegun = () => {
  const run = race.value ?? raceToWatch.value;
  const isNew = isActive(run) || (!isOwn.value && stage.value?.origin === "started" && phase.value === "showing");
  const isToFollow = isNew || lessonProgress.value.race !== null;
  return isToFollow && isInPicture(run) && ((raceScene.value?.time_s ?? 0) > 0 || isTimedOut.value);
};

/** Whether the race is decided in the picture. */
const isDecided = () => isInPicture(race.value) && isTimedOut.value;

// ---- the vote

/** The lanes that can be voted for: of the race, or of the one to come. */
export const candidates = computed(() => {
  const { lanes } = (race.value ?? raceInView.value)?.config ?? served().defaults.race;
  return lanes.map((lane) => ({ agent: lane.agent, title: laneTitle(lane), color: agentOf(lane.agent).color }));
});

export const vote = computed(() => lessonProgress.value.vote);

const voteInWords = () =>
  t("Your vote: {robot}.", { robot: vote.value === null ? "" : agentOf(vote.value).title });

/** Vote for an agent, until the race is decided in the picture. @param {string} agent */
export function voteFor(agent) {
  if (isDecided()) return;
  keep({ vote: agent, ...(lessonProgress.peek().at === "vote" ? { at: "ready" } : {}) });
}

// ---- what is pressed

/** Times real time at which its practice can be watched and changed, and that at which it is soon over. */
const [PACE, FASTER] = [2, 8];
/** The α that is tried where it is low, and where it is high. */
const [HIGH, LOW] = [0.9, 0.1];
/** Fields of a training that a race with its table has, too. */
const WALK = ["gait", "robot", "simulator", "divisions", "grid_side_m", "tolerance", "reward"];

export const isStarting = () => Boolean(pending.value.start) || isAway.value;

/** Start its practice: as it is by default, whatever the form says. */
const startPractice = () => attempt("start", async () => {
  openTab("board");
  const run = await adopt(() => startTraining(
    { ...served().defaults.training, ...(isOperator.peek() ? { pace: PACE } : {}) }));
  if (run?.id) keep({ at: "start", practice: run.id, race: null, outcome: null, isMine: true });
});

/** Race what it has learned against the others of a race by default. */
const startItsRace = () => attempt("start", async () => {
  openTab("board");
  const { id = null, config } = /** @type {Run} */ (practice.peek());
  const { lanes, steps, seed } = served().defaults.race;
  const walk = Object.fromEntries(Object.entries(config).filter(([name]) => WALK.includes(name)));
  const run = await adopt(() => startRace({
    ...walk, steps, seed,
    lanes: lanes.map((lane) => (learns(lane.agent) ? { agent: config.agent, training_id: id } : lane)),
  }));
  if (run?.id) keep({ race: run.id, outcome: null });
});

/** Go to another card. @param {string} at @param {() => unknown} [act] what the press does besides */
export const goTo = (at, act = () => {}) => () => {
  act();
  keep({ at });
};

/** Show a run where it is: on the stage, or else as a replay of this page's own. @param {Run} run */
export function show(run) {
  openTab("board");
  if (stage.peek()?.run_id === run.id && isActive(run)) closeReplay();
  else openReplay(run.id, { clock: clock.peek() });
}

/** @param {Run} run */
const showPractice = (run) => () => {
  keep({ practice: run.id });
  show(run);
};

/** @param {Run} run */
const showRace = (run) => () => {
  keep({ race: run.id });
  show(run);
};

/** Hold the step in the picture of this page, and open its explanation. */
function explain() {
  const run = practice.peek();
  if (run) openReplay(run.id, { time_s: position.peek(), isPlaying: false });
  openExplanation();
}

/** Go on from the step that was explained. */
function goOn() {
  openTab("board");
  if (!isOwn.peek() || page.moment.peek() === null) return;
  if (stage.peek()?.run_id === lessonProgress.peek().practice) closeReplay();
  else playReplay(true);
}

/** Hold the practice where it is computed to, which is its newest test. */
const showNewest = () => {
  const run = practice.peek();
  if (run) openReplay(run.id, { time_s: Number.MAX_SAFE_INTEGER, isPlaying: false });
};

/** Change the practice while it goes on. @param {Rates} changes */
const tuneIt = async (changes) => {
  goOn();
  (await import("../../js/live-changes.js")).tune(changes);
};

/** @returns {Press} */
function pressOfTest() {
  const alpha = alphaNow();
  if (!steers.value) return { label: t("See its newest test"), run: goTo("newest", showNewest) };
  if (alpha === null) return { label: t("Next"), run: goTo("newest", goOn) };
  if (!isActive(practice.value)) return { label: t("Practise again"), run: startPractice, isHeld: isStarting() };
  const other = alpha < (HIGH + LOW) / 2 ? HIGH : LOW;
  const label = t("Set α to {alpha}", { alpha: decimal(other) });
  return { label, run: goTo("changed", () => tuneIt({ alpha: other })), isHeld: isAway.value };
}

/** Practise faster, and then as fast as it can be computed. @returns {Press} */
function pressOfChange() {
  const pace = practice.value && presentRates(practice.value).pace;
  const isFast = pace === FASTER || pace === "max";
  return {
    label: isFast ? t("As fast as it can") : t("Practise faster"), run: () => tuneIt({ pace: isFast ? "max" : FASTER }),
    isHeld: isAway.value || pace === "max",
  };
}

/** @returns {Press} */
function pressOfNewest() {
  if (!isActive(practice.value) || !steers.value) return { label: t("On to the race"), run: goTo("vote") };
  return { label: t("Finish the practice"), run: goTo("vote", () => tuneIt({ pace: "max" })), isHeld: isAway.value };
}

/** @returns {Press | null} */
function pressOfVote() {
  const toWatch = race.value ?? raceToWatch.value;
  if (toWatch && (!isInPicture(toWatch) || !mayStart.value)) {
    return { label: t("Watch the race"), run: showRace(toWatch), isHeld: isComing(toWatch) };
  }
  if (!mayStart.value) return null;
  const isHeld = isStarting() || toWatch !== null || !hasTable(practice.value);
  return { label: t("Start the race"), run: startItsRace, isHeld };
}

/** Look at the robot that has thought longest, and back at all. @returns {Press} */
function pressOfRace() {
  const [most] = (standings.value ?? []).toSorted((a, b) => b.spent.thought - a.spent.thought);
  const isClose = most !== undefined && page.camera.value === String(most.lane + 1);
  return {
    label: isClose || !most ? t("Look at all") : t("Look at {robot}", { robot: most.title }), isHeld: !most,
    run: () => (page.camera.value = isClose ? "directed" : String(most.lane + 1)),
  };
}

// ---- the cards

/** What is noted when a card comes: the run that it is about, and how the race was decided; replays come later. */
/** @param {FirstCard} card @returns {Partial<Progress>} */
export function notedAt({ name, of }) {
  const shown = shownRun.peek();
  const isNew = of && lessonProgress.peek()[of] === null && shown?.kind === KINDS[of];
  const work = () => (standings.peek() ?? []).map(workInWords).join(" ");
  return {
    ...(isNew ? { [of]: shown.id } : {}),
    ...(name === "finish" ? { outcome: { headline: narrative.peek().headline, work: work() } } : {}),
  };
}

const learner = () => agentOf(practice.value?.config.agent ?? served().defaults.training.agent).title;

/** What the searches of a race do before each step: "Greedy simulates 12 moves, Two-step 156". @param {Run} run */
const simulated = ({ config }) => config.lanes.filter(({ agent }) => agentOf(agent).steps_ahead)
  .map(({ agent }, n) => {
    const { title, steps_ahead } = agentOf(agent);
    const moves = simulatedPerDecision(steps_ahead ?? 0, config);
    return n ? `${title} ${whole(moves)}` : t("{robot} simulates {moves} moves", { robot: title, moves });
  }).join(", ");

/** A robot that has thought for more of its time is told to have done so. */
const MUCH = 0.5;
/** What each robot did until the time-out: "Greedy: 36 steps of 10 mm". @param {Standing} row */
function workInWords(row) {
  const { title, made, spent: { thought, walked } } = row;
  const share = thought / Math.max(thought + walked, Number.MIN_VALUE);
  if (share > MUCH) return t("{robot} thought {share} of the time.", { robot: title, share: percentage(share) });
  const length = Math.round((1000 * distanceOf(row)) / Math.max(made, 1));
  return t("{robot}: {made} {made|step|steps} of {length}\u00a0mm.", { robot: title, made, length });
}

export const LEARNING = "[aria-labelledby=learning-title]";

/** @type {FirstCard[]} */
export const FIRST = [
  {
    name: "start", shows: ".stage", say: () => {
      const text = t("{robot} will try moves and keep what each was worth. The others compute before each step.",
        { robot: learner() });
      const run = practiceToWatch.value;
      if (!run && !mayStart.value) {
        return { title: t("Who will win?"), text: t("It goes on once a practice is started here."), press: null };
      }
      const isHeld = isStarting() || lessonProgress.value.practice !== null;
      return {
        title: t("It knows nothing yet."), text,
        press: run ? { label: t("Watch it practise"), run: showPractice(run), isHeld: isComing(run) }
          : { label: t("Let it practise"), run: startPractice, isHeld },
      };
    },
  },
  {
    name: "tries", of: "practice", shows: ".stage", comes: hasPracticeBegun, say: () => ({
      title: t("It tries moves."), text: t("At random, as yet. What did this step bring?"),
      press: explainingTab.value === null
        ? { label: t("Next"), run: goTo("test") } : { label: t("Explain this step"), run: goTo("step", explain) },
    }),
  },
  {
    name: "step", of: "practice", shows: ".why-tab", holds: () => tab.value === explainingTab.value, say: () => ({
      title: t("One step."),
      text: t("What it brought changes the value of this move in the table, by a share: α."),
      press: { label: t("On with the practice"), run: goTo("test", goOn) },
    }),
  },
  {
    name: "test", of: "practice", shows: LEARNING, comes: () => tests().length > 0, say: () => {
      const [first] = tests();
      const isOver = steers.value && !isActive(practice.value);
      return {
        title: first ? t("First test: {distance}.", { distance: metres(first.distance_m) })
          : t("Tests come every 50 steps."),
        press: pressOfTest(),
        text: isOver ? t("α changes only while it practises.")
          : t("α, the share of a new try that counts, is {alpha}.", { alpha: decimal(alphaNow() ?? t("fixed")) }),
      };
    },
  },
  {
    name: "changed", of: "practice", shows: LEARNING, isThere: () => steers.value, say: () => {
      const step = alphaChange()?.step;
      const alpha = decimal(alphaNow() ?? "");
      return {
        title: step === undefined ? t("α is {alpha}.", { alpha })
          : t("α is {alpha} from step {step}.", { alpha, step }),
        text: t("The curve has its mark. Will the next test go farther?"), press: pressOfChange(),
      };
    },
  },
  {
    name: "newest", of: "practice", shows: LEARNING,
    comes: () => (steers.value
      ? tests().some(({ step }) => step > (alphaChange()?.step ?? Infinity))
      // The start line, too, is shown to its end.
      : practice.value !== null && isShownToEnd(scene.value, practice.value.id)),
    say: () => {
      const now = metres(tests().at(-1)?.distance_m);
      const before = tests().findLast(({ step }) => step <= (alphaChange()?.step ?? 0));
      return {
        title: before ? t("Newest test: {now}, before {before}.", { now, before: metres(before.distance_m) })
          : t("Newest test: {now}.", { now }),
        press: pressOfNewest(),
        text: before ? t("By α, or by practice? One robot does not tell.") : t("It has a table now."),
      };
    },
  },
  {
    name: "vote", shows: ".prediction", comes: hasRaceBegun, say: () => ({
      title: t("Who is ahead at time-out?"), press: null,
      text: t("In the race the clock runs on while a robot thinks."),
    }),
  },
  {
    name: "ready", shows: ".stage", say: () => ({
      title: voteInWords(), press: pressOfVote(),
      text: mayStart.value || (race.value ?? raceToWatch.value)
        ? t("The first robot to use its 50 steps ends the race.") : t("It goes on once a race is started here."),
    }),
  },
  {
    name: "race", of: "race", shows: ".board", comes: () => hasRaceBegun() && (vote.value !== null || isTimedOut.value),
    say: () => ({
      title: t("Hatched is thinking."), press: pressOfRace(),
      text: race.value ? t("{robots} before each step.", { robots: simulated(race.value) }) : "",
    }),
  },
  {
    name: "finish", of: "race", shows: ".board", comes: isDecided, say: () => ({
      title: `${lessonProgress.value.outcome?.headline ?? narrative.value.headline}.`,
      text: [vote.value === null ? "" : voteInWords(), t("What did each do with its time?")].join(" ").trim(),
      press: { label: t("Why?"), run: goTo("why") },
    }),
  },
  {
    name: "why", of: "race", shows: ".board", say: () => ({
      title: t("Longest way, not most steps."), text: lessonProgress.value.outcome?.work ?? "",
      press: { label: t("Your turn"), run: goTo("turn") },
    }),
  },
  {
    name: "turn", shows: ".foot", say: () => ({
      title: t("Your turn."), text: mayStart.value
        ? t("Would more practice win? Change one thing, and race again.")
        : t("Follow a step of the race, with its numbers."),
      press: { label: mayStart.value ? t("Change it") : t("Follow it"), run: goTo("done", () => {
        setDepth("try");
        openTab(mayStart.peek() ? "train" : explainingTab.peek() ?? "board");
      }) },
    }),
  },
];
