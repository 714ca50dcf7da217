// What this page plays: the run on stage at the moment of the stage's playhead, or a run that it replays by itself, at
// a position of its own. Both are loaded, drawn (`picture.js`) and told in the same way. Which run is replayed, and
// where it is held, is of the page's state.
import { batch, computed, effect, signal, untracked } from "@preact/signals";
import { getReplay, isLasting } from "./api.js";
import { t } from "./format.js";
import { sceneOf } from "./narrative/moment.js";
import { change, page } from "./page-state.js";
import { isStill } from "./page.js";
import { drawWith, Picture, requestOf } from "./picture.js";
import {
  approached, endOf, inRecording, momentOf, nextStep, SAME_MOMENT_S, stepsUntil, timeOutOf, unpack,
} from "./replay-frames.js";
import { connection, isAway, isGone, newestPiece, playhead, scene, serverClock, stage } from "./store.js";

/** @import { ReadonlySignal, Signal } from "@preact/signals" */
/** @import { RequestError } from "./api.js" */
/** @import { Wanted } from "./picture.js" */
/** @import { Message } from "./replay-frames.js" */
/** @import { Clock, Playback, ReplayPlan, Scene } from "./types.js" */

const FIRST_SPEED = 2;
/** How often the page is told the figures, and the position of the stage. */
const [SCENES_PER_S, POSITIONS_PER_S] = [5, 10];
/** At its end, a run that is still computed is asked for more after so long. */
const [GROWTH_MS, RETRY_MS, HELD_MS] = [1000, 1500, 250];
/** A replay of this page's own skips nothing after a stall. */
const LONGEST_TICK_S = 0.25;
/** The figures of a page that is not seen follow so often. */
const HIDDEN_TICK_MS = 1000;

/** Whether this page replays a run by itself. */
export const isOwn = computed(() => page.run.value !== null);
/** Plan of the own replay; null until it is known. @type {Signal<ReplayPlan | null>} */
export const plan = signal(null);
/** Why the run cannot be played. @type {Signal<string | null>} */
export const replayProblem = signal(null);
/** The position in the run's own time [s]. */
export const position = signal(0);
/** Whether the picture waits for frames. */
export const isBuffering = signal(false);
const isGoing = computed(() => page.moment.value === null);
const speed = signal(FIRST_SPEED);
const { clock } = /** @type {{ clock: Signal<Clock> }} */ (page);

/** How far the run can be shown, how long it is, and where its time-out is [s]; null where that is not known. */
const bounds = computed(() => {
  if (!isOwn.value) return playhead.value ?? { computed_s: 0, duration_s: null, time_out_s: null };
  const { duration_s = null } = plan.value ?? {};
  return { computed_s: plan.value ? endOf(plan.value) : 0, duration_s, time_out_s: timeOutOf(plan.value) };
});

/** Time-out of the race, if the own replay is to end there [s]; null where it is to go on, or is later already. */
const endAtTimeOut = computed(() => {
  const timeOut = timeOutOf(plan.value);
  const isLater = timeOut !== null && position.value > timeOut + SAME_MOMENT_S;
  return page.end.value === "time-out" && !isLater ? timeOut : null;
});
/** The moment at which the own replay ends [s]. */
export const endTime = computed(() => endAtTimeOut.value ?? (plan.value ? endOf(plan.value) : 0));
const hasEnded = computed(() => plan.value?.complete === true && position.value >= endTime.value - SAME_MOMENT_S);

/** What is played, and how: as the stage, or as the own replay. @type {ReadonlySignal<Playback | null>} */
export const playback = computed(() => (isOwn.value ? {
  run_id: page.run.value, next_run_id: null, origin: "chosen", playing: isGoing.value, ended: hasEnded.value,
  phase: plan.value?.complete === false ? "live" : hasEnded.value ? "ended" : "showing",
  speed: speed.value, clock: clock.value, announced: null,
  end_at_time_out: page.end.value === "time-out",
} : stage.value));

/** Whether the bar ends at the time-out. */
export const isCutAtTimeOut = computed(() =>
  (isOwn.value ? endAtTimeOut.value !== null : stage.value?.end_at_time_out));

// ---- loading

/** Whether this page shows the stage while it has no replay of its own. */
const followsStage = signal(false);
/** Whether there is a 3D view. */
const hasView = signal(false);
/** What is to be played, as a text: the own replay's run and ghost, or the run on stage; "" for nothing. */
const source = computed(() => {
  if (isStill.value) return "";
  if (isOwn.value) return JSON.stringify({ id: page.run.value, ghost: page.ghost.value });
  // The start line has nothing but a picture.
  const isSeen = stage.value !== null && (stage.value.run_id !== null || hasView.value);
  return followsStage.value && isSeen ? JSON.stringify({ onStage: stage.value?.run_id }) : "";
});
/** The source that is loaded, or being loaded. */
let opened = "";
/** @type {Picture | null} */
let picture = null;
let isGrowthPending = false;

/**
 * Open a run at a time, in the view of the race, where the stage is.
 * @param {string} id
 * @param {{ time_s?: number, isPlaying?: boolean, clock?: Clock, ghost?: string | null }} [at]
 */
export function openReplay(id, { time_s = 0, isPlaying = true, clock: timedBy = clock.peek(), ghost = null } = {}) {
  return batch(() => {
    change({ view: "race", run: id, ghost, moment: isPlaying ? null : time_s });
    clock.value = timedBy;
    return load(time_s);
  });
}

/** Show the stage again that all pages share. */
export const closeReplay = () => batch(() => {
  change({ run: null, ghost: null, moment: null });
  if (source.peek() !== opened) load(0);
});

/** Load what is to be played, in place of what was. @param {number} time_s where the own replay begins */
async function load(time_s) {
  opened = source.peek();
  const isReplay = isOwn.peek();
  const id = playback.peek()?.run_id ?? null;
  const ghost = isReplay ? page.ghost.peek() : null;
  const isPushed = !isReplay && picture !== null && picture.isPushed;
  if (opened === "") picture?.remove();
  forget();
  position.value = isReplay ? time_s : stagePosition();
  if (isReplay || scene.peek()?.run_id !== id) scene.value = null;
  if (opened !== "") await open(id, ghost, isPushed, time_s);
}

/** @type {(id: string | null, ghost: string | null, isPushed: boolean, time_s: number) => Promise<void>} */
async function open(id, ghost, isPushed, time_s) {
  const isReplay = isOwn.peek();
  const opening = new Picture(requestOf(id, ghost), (error, again) => retryAfter(error, opening, again), isPushed);
  picture = opening;
  try {
    const answer = isReplay ? getReplay(String(id), clock.peek(), ghost) : null;
    await Promise.all([answer, opening.open()]);
    if (picture !== opening) return;
    plan.value = await answer;
    opening.begin(page.camera.peek());
    if (isReplay) seekReplay(time_s);
  } catch (error) {
    retryAfter(error, opening, () => load(time_s));
  }
}

/**
 * Tell an error that will be the same the next time, else try again after a while: of the stage always, which may show
 * another run by then.
 * @param {unknown} error
 * @param {Picture} refused the picture that the request belongs to
 * @param {() => unknown} again
 */
function retryAfter(error, refused, again) {
  if (picture !== refused) return;
  const { message } = /** @type {RequestError} */ (error);
  if (isOwn.peek() && isLasting(/** @type {RequestError} */ (error))) replayProblem.value = message;
  else setTimeout(() => picture === refused && again(), RETRY_MS);
}

/** End the replay of a run that was deleted. Of one that was never loaded, what the server says stands. */
const lose = () => batch(() => {
  picture?.remove();
  forget();
  scene.value = null;
  replayProblem.value = t("This run was deleted. It can be replayed no more.");
});

/** Forget what is known of what was played. */
function forget() {
  picture = null;
  isGrowthPending = false;
  plan.value = null;
  replayProblem.value = null;
  isBuffering.value = false;
  followed_s = NaN;
}

/** Take the 3D view in which to draw; what it had is gone. @param {(messages: Message[]) => void} take */
export function drawIn(take) {
  drawWith(take);
  hasView.value = true;
  picture?.begin(page.camera.peek());
}

/** Take frames that the stage has pushed. @param {NonNullable<typeof newestPiece.value>} message */
async function takePiece({ run_id, clock: timedBy, version, level, first, time_s, data }) {
  const pushedTo = picture;
  if (isOwn.peek() || !pushedTo || opened !== JSON.stringify({ onStage: run_id })) return;
  const { frames } = await unpack(data);
  if (level !== null && first !== null) pushedTo.put(timedBy, version, { level, first, frames });
  else if (time_s !== null) pushedTo.putMoment(timedBy, version, { time_s, frame: frames[0] });
}

// ---- what the user can do with a replay of this page's own

/** @type {ReturnType<typeof setTimeout> | undefined} */
let heldTimer;

/** Seek to a time [s], or to the nearest that is recorded. @param {number} time_s */
export function seekReplay(time_s) {
  position.value = Math.min(Math.max(time_s, 0), plan.peek() ? bounds.peek().computed_s : Infinity);
  // Not at each pixel of a drag: browsers slow down pages that write their address often.
  clearTimeout(heldTimer);
  heldTimer = setTimeout(() => isGoing.peek() || hold(true), HELD_MS);
}

/** @param {boolean} isOn */
const hold = (isOn) => change({ moment: isOn ? position.peek() : null });

/** Go on, hold, or play again from the start. @param {boolean} isOn */
export function playReplay(isOn) {
  if (isOn && hasEnded.peek()) position.value = 0;
  hold(!isOn);
}

/** @param {number} times */
export const setReplaySpeed = (times) => (speed.value = times);

/** Counts the choices of a clock: only the newest is obeyed. */
let clockChoice = 0;
/**
 * Time the race by another clock, from the same step of the first lane on.
 * @param {Clock} name
 * @throws {RequestError} if that cannot be had; the clock stays as it is
 */
export async function setReplayClock(name) {
  clockChoice += 1;
  const [shown, choice, id, ghost] = [picture, clockChoice, page.run.peek(), page.ghost.peek()];
  if (!plan.peek() || !id || name === clock.peek()) return;
  const isObeyed = () => picture === shown && choice === clockChoice;
  try {
    const after = await getReplay(id, name, ghost);
    if (!isObeyed()) return;
    const step = stepsUntil(plan.peek(), position.peek());
    const time_s = after.step_ends_s[0]?.[step - 1] ?? 0;
    await openReplay(id, { time_s, isPlaying: isGoing.peek(), clock: name, ghost });
  } catch (error) {
    if (isObeyed()) throw error;
  }
}

/** Hold, and go to the end of the next robot step, or of the one before. @param {1 | -1} direction */
export function stepReplay(direction) {
  const next = nextStep(plan.peek(), Number(page.camera.peek()) - 1, position.peek(), direction);
  hold(true);
  seekReplay(next ?? endTime.peek());
}

// ---- playing

/** When the picture was drawn, and a position was told [ms]; where that of the stage is [s]. */
let [lastTick, positionAt, followed_s] = [NaN, -Infinity, NaN];

/** Advance the position, and draw. @param {number} now of the browser's clock [ms] */
export function tick(now) {
  const elapsed_s = ((now - lastTick) || 0) / 1000;
  lastTick = now;
  const shown = picture;
  if (!shown || replayProblem.peek() !== null) return;
  const wanted = isOwn.peek() ? ownMoment(Math.min(elapsed_s, LONGEST_TICK_S)) : stageMoment(now, elapsed_s);
  if (wanted) {
    const isHere = shown.show(wanted, page.camera.peek(), now, elapsed_s);
    isBuffering.value = wanted.rate > 0 && !isHere;
    takePosition(wanted, isHere, now);
    tell(wanted, now);
  }
  shown.centreFor(page.camera.peek());
  if (isOwn.peek()) grow(now);
}

/** Where the picture of the stage is to be now [s]. */
function stagePosition() {
  const head = playhead.peek();
  return head ? momentOf(head, serverClock.at(performance.now() / 1000)).time_s : 0;
}

/** Advance the own replay. @param {number} elapsed_s @returns {Wanted | null} */
function ownMoment(elapsed_s) {
  const replayPlan = plan.peek();
  if (!replayPlan) return null;
  const after = (/** @type {number} */ s) => inRecording(replayPlan.recorded_s, position.peek() + s * speed.peek());
  const isMoving = () => isGoing.peek() && !hasEnded.peek();
  if (isMoving() && !isBuffering.peek()) position.value = Math.min(after(elapsed_s), endTime.peek());
  const [time_s, end_s] = [position.peek(), bounds.peek().computed_s];
  const rate = isMoving() ? speed.peek() : 0;
  const { version, complete } = replayPlan;
  return { clock: clock.peek(), version, time_s, rate, next_s: Math.min(after(1), end_s), end_s, isGrowing: !complete };
}

/** Follow the stage; while that is not heard its last picture stays. @returns {Wanted | null} */
function stageMoment(/** @type {number} */ now, /** @type {number} */ elapsed_s) {
  const [head, shownStage] = [playhead.peek(), stage.peek()];
  if (isAway.peek()) followed_s = NaN;
  if (!head || !shownStage || isAway.peek()) return null;
  const { clock: timedBy, version, live: isGrowing } = shownStage;
  const end_s = head.computed_s;
  const after = (/** @type {number} */ s) => momentOf(head, serverClock.at(now / 1000 + s));
  const { time_s, rate } = after(0);
  followed_s = Math.min(approached(followed_s, time_s, rate, elapsed_s), end_s);
  const next_s = Math.min(after(1).time_s, end_s);
  return { clock: timedBy, version, time_s: followed_s, rate, next_s, end_s, isGrowing };
}

/** Tell where the picture is: of the stage not at each frame, and where it has none, where it stays. */
/** @type {(wanted: Wanted, isHere: boolean, now: number) => void} */
function takePosition({ time_s, rate }, isHere, now) {
  const drawn_s = picture?.shown.time_s ?? NaN;
  if (isOwn.peek()) {
    // In a gap of the recording the next moment is shown.
    if (rate === 0 && isHere && drawn_s > time_s + SAME_MOMENT_S) position.value = drawn_s;
  } else if (rate === 0 || now - positionAt >= 1000 / POSITIONS_PER_S) {
    positionAt = now;
    position.value = isHere || rate === 0 || Number.isNaN(drawn_s) ? time_s : drawn_s;
  }
}

/** Of what the page was told last: the figures, their time, how they are played, and how far that can go. */
let told = /** @type {unknown[]} */ ([]);
/** When that was, and when the plan was requested last [ms]. */
let [toldAt, grewAt] = [-Infinity, -Infinity];

/** Let the page know the moment: at once where it is held or something has changed. */
/** @type {(wanted: Wanted, now: number) => void} */
function tell({ rate, end_s }, now) {
  const { figures = null, time_s = 0 } = picture?.figuresOf(end_s) ?? {};
  const [known, how] = [bounds.peek(), playback.peek()];
  // What is said of a moment that is held is said of it alone, and not of the frame before.
  if (!figures || !how || (rate === 0 && end_s > 0 && !picture?.shown.isExact)) return;
  const state = [how, known.duration_s, known.time_out_s, rate, figures, time_s, known.computed_s];
  const isSame = (/** @type {unknown} */ value, /** @type {number} */ n) => value === told[n];
  const isDue = now - toldAt >= 1000 / SCENES_PER_S || !state.slice(0, rate > 0 ? 3 : 4).every(isSame);
  if (state.every(isSame) || !isDue) return;
  [told, toldAt] = [state, now];
  scene.value = sceneOf(/** @type {Scene} */ (figures), how, { ...known, time_s, rate, isOwn: isOwn.peek() });
}

/** Near its end, request the plan of a run that has computed more since. */
async function grow(/** @type {number} */ now) {
  const replayPlan = plan.peek();
  const isNearEnd = endTime.peek() - position.peek() <= speed.peek() * GROWTH_MS / 1000;
  if (!replayPlan || replayPlan.complete || !isNearEnd || isGrowthPending || now - grewAt < GROWTH_MS) return;
  grewAt = now;
  isGrowthPending = true;
  const shown = /** @type {Picture} */ (picture);
  try {
    const answer = await getReplay(replayPlan.run_id, clock.peek(), page.ghost.peek());
    if (picture !== shown) return;
    isGrowthPending = false;
    plan.value = answer;
  } catch (error) {
    retryAfter(error, shown, () => (isGrowthPending = false));
  }
}

/**
 * Play what is to be played, from now on.
 * @param {{ ofStage?: () => boolean }} [how] whether the stage is shown while there is no replay of this page's own
 */
export function followPlayer({ ofStage = () => true } = {}) {
  effect(() => { followsStage.value = ofStage(); });
  // A link, or "back", names another run or another moment; the stage shows another run.
  effect(() => {
    const [isOther, moment] = [source.value !== opened, page.moment.value];
    if (isOther) untracked(() => batch(() => load(moment ?? 0)));
    else if (isOwn.value && moment !== null && moment !== position.peek()) seekReplay(moment);
  });
  effect(() => {
    const message = newestPiece.value;
    if (message) untracked(() => takePiece(message));
  });
  // The bar follows a command before the picture does.
  effect(() => {
    const head = playhead.value;
    if (head && !isOwn.value) position.value = stagePosition();
  });
  // A server that was away may have come back with the run; what it has pushed meanwhile comes no more.
  let wasAway = false;
  effect(() => {
    wasAway ||= connection.value === "reconnecting";
    if (connection.value !== "live" || !wasAway) return;
    wasAway = false;
    picture?.expectNothing();
    if (replayProblem.peek() && isOwn.peek()) load(page.moment.peek() ?? 0);
  });
  effect(() => {
    const id = page.run.value;
    if (id !== null && isGone(id) && plan.peek()) untracked(lose);
  });
  const loop = (/** @type {number} */ now) => {
    tick(now);
    requestAnimationFrame(loop);
  };
  requestAnimationFrame(loop);
  // Browsers draw no frames of a page that is not seen; its title and what screen readers are told go on.
  /** @type {ReturnType<typeof setInterval> | undefined} */
  let timer;
  document.addEventListener("visibilitychange", () => {
    clearInterval(timer);
    if (document.hidden) timer = setInterval(() => isOwn.peek() || tick(performance.now()), HIDDEN_TICK_MS);
  });
}
