// A replay of this page's own: it plays a run by itself, without the stage that all pages share.
// The server gives frames (`replay-frames.js`); which run it is, and where it is held, is of the page's state.
import { batch, computed, effect, signal, untracked } from "@preact/signals";
import { getReplay, getReplayFrames, isLasting } from "./api.js";
import { SAME_MOMENT_S } from "./format.js";
import { change, linkTo, page } from "./page-state.js";
import { decode, endOf, Follower, inRecording, placeOf, SceneState, Segments } from "./replay-frames.js";
import { connection, isGone, ownScene, ownStage } from "./store.js";

/** @import { Signal } from "@preact/signals" */
/** @import { RequestError } from "./api.js" */
/** @import { Frame, Message } from "./replay-frames.js" */
/** @import { Clock, ReplayPlan, Scene } from "./types.js" */

const FIRST_SPEED = 2;
const SCENES_PER_S = 5;
/** At its end, a run that is still computed is asked for more after so long. */
const GROWTH_MS = 1000;
const RETRY_MS = 1500;
const HELD_MS = 250;
/** As on the stage, a stall does not skip what comes after it. */
const LONGEST_TICK_S = 0.25;
const SAME_S = 1e-6;

/** Plan of the replay; null until it is known. @type {Signal<ReplayPlan | null>} */
export const plan = signal(null);
/** Why the run cannot be played. @type {Signal<string | null>} */
export const replayProblem = signal(null);
/** The position in the run's own time [s]. */
export const replayTime = signal(0);
/** Whether the picture waits for frames. */
export const isBuffering = signal(false);
const playing = computed(() => page.moment.value === null);
const speed = signal(FIRST_SPEED);
const { clock } = /** @type {{ clock: Signal<Clock> }} */ (page);

/** Time-out of the race, if the replay is to end there [s]; null where it is to go on, or is later already. */
const endAtTimeOut = computed(() => {
  const timeOut = plan.value?.marks.find(({ kind }) => kind === "time-out")?.time_s ?? null;
  const isLater = timeOut !== null && replayTime.value > timeOut + SAME_MOMENT_S;
  return page.end.value === "time-out" && !isLater ? timeOut : null;
});
/** The last moment that can be shown [s]. */
const wholeEnd = computed(() => (plan.value ? endOf(plan.value) : 0));
/** The moment at which the replay ends [s]. */
export const endTime = computed(() => endAtTimeOut.value ?? wholeEnd.value);
const hasEnded = computed(() => plan.value?.complete === true && replayTime.value >= endTime.value - SAME_MOMENT_S);

// ---- what is loaded

/** The 3D view's place: takes viser's messages. @type {(messages: Message[]) => void} */
let draw = () => {};
/** @type {SceneState | null} */
let scene = null;
const segments = new Segments(
  (address) => request(address, { clock: clock.peek(), version: plan.peek()?.version ?? "" }),
  (error, again) => retryAfter(error, opening, again),
);
const NOTHING = { address: "", index: -1, time_s: NaN, frame: /** @type {Frame | null} */ (null), view: "" };
/** The newest frame that is drawn, by its segment and index or by its time, and the view that it is centred for. */
let shown = NOTHING;
/** Whether a moment is requested, or not to be requested again yet. */
let isMomentPending = false;
/** Whether the plan is requested again, as for a moment. */
let isGrowthPending = false;
/** Counts the runs and clocks that were opened: late answers are of an older one. */
let opening = 0;
let sceneSentAt = -Infinity;
const follower = new Follower();

/** The run and the ghost that are loaded, or being loaded. */
let opened = "";
const named = () => `${page.run.value ?? ""} ${page.ghost.value ?? ""}`.trim();

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
  load(0);
});

/** Load the run that the page's state names, if any, in place of the one before. @param {number} time_s */
async function load(time_s) {
  opening += 1;
  const attemptNow = opening;
  const [id, ghost, timedBy] = [page.run.peek(), page.ghost.peek(), clock.peek()];
  if (scene && id === null) draw([removal(scene)]);
  forget();
  replayTime.value = time_s;
  if (id === null) return;
  try {
    const [answer, start] = await Promise.all([getReplay(id, timedBy, ghost), request("scene")]);
    if (attemptNow !== opening) return;
    scene = new SceneState(start);
    plan.value = answer;
    redraw();
    seekReplay(time_s);
  } catch (error) {
    retryAfter(error, attemptNow, () => load(time_s));
  }
}

/**
 * Tell an error that will be the same the next time, else try again after a while.
 * @param {unknown} error
 * @param {number} attemptOfThis the opening that the request belongs to
 * @param {() => unknown} again
 */
function retryAfter(error, attemptOfThis, again) {
  if (attemptOfThis !== opening) return;
  const refused = /** @type {RequestError} */ (error);
  if (isLasting(refused)) replayProblem.value = refused.message;
  else setTimeout(() => attemptOfThis === opening && again(), RETRY_MS);
}

/** End the replay of a run that was deleted. Of one that was never loaded, what the server says stands. */
const lose = () => batch(() => {
  opening += 1;
  if (scene) draw([removal(scene)]);
  forget();
  replayProblem.value = "This run was deleted. It can be replayed no more.";
});

/** Forget what is known of the run that was open. */
function forget() {
  opened = named();
  scene = null;
  segments.clear();
  shown = NOTHING;
  isMomentPending = false;
  isGrowthPending = false;
  plan.value = null;
  replayProblem.value = null;
  isBuffering.value = false;
  ownScene.value = null;
  if (page.run.peek() === null) ownStage.value = null;
}

/**
 * Take the 3D view in which to draw; what it had is gone.
 * @param {(messages: Message[]) => void} take
 */
export function drawIn(take) {
  draw = take;
  redraw();
}

/** Draw the scene anew, as the 3D view has none. */
function redraw() {
  if (!scene) return;
  draw([removal(scene), ...scene.restart()]);
  shown = NOTHING;
}

/** The message that removes all that is drawn. @type {(state: SceneState) => Message} */
const removal = ({ world }) => ({ type: "RemoveSceneNodeMessage", name: world, owner: "" });

/** @param {string} address @param {Record<string, string>} [query] */
async function request(address, query = {}) {
  const [id, ghost] = [/** @type {string} */ (page.run.peek()), page.ghost.peek()];
  return decode(await getReplayFrames(id, address, { ...query, ...(ghost === null ? {} : { ghost }) }));
}

// ---- what the user can do

/** Seek to a time [s], or to the nearest that is recorded. @param {number} time_s */
export function seekReplay(time_s) {
  replayTime.value = Math.min(Math.max(time_s, 0), plan.peek() ? wholeEnd.peek() : Infinity);
  // Not at each pixel of a drag: browsers slow down pages that write their address often.
  clearTimeout(heldTimer);
  heldTimer = setTimeout(() => playing.peek() || hold(true), HELD_MS);
}

/** @type {ReturnType<typeof setTimeout> | undefined} */
let heldTimer;

/** @param {boolean} isOn */
const hold = (isOn) => change({ moment: isOn ? replayTime.peek() : null });

/** Go on, hold, or play again from the start. @param {boolean} isOn */
export function playReplay(isOn) {
  if (isOn && hasEnded.peek()) replayTime.value = 0;
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
  const [attemptNow, choice, id, ghost] = [opening, clockChoice, page.run.peek(), page.ghost.peek()];
  if (!plan.peek() || !id || name === clock.peek()) return;
  const isObeyed = () => attemptNow === opening && choice === clockChoice;
  try {
    const after = await getReplay(id, name, ghost);
    if (!isObeyed()) return;
    const step = stepOf(plan.peek()?.step_ends_s[0] ?? [], replayTime.peek());
    const time_s = after.step_ends_s[0]?.[step - 1] ?? 0;
    await openReplay(id, { time_s, isPlaying: playing.peek(), clock: name, ghost });
  } catch (error) {
    if (isObeyed()) throw error;
  }
}

/** @type {(ends: number[], time_s: number) => number} */
const stepOf = (ends, time_s) => ends.filter((end) => end <= time_s + SAME_MOMENT_S).length;

/** Hold, and go to the end of the next robot step, or of the one before. @param {1 | -1} direction */
export function stepReplay(direction) {
  const ends = stepEnds.peek();
  const now = replayTime.peek();
  const next = direction > 0
    ? ends.find((end) => end > now + SAME_MOMENT_S) ?? endTime.peek()
    : ends.findLast((end) => end < now - SAME_MOMENT_S) ?? 0;
  hold(true);
  seekReplay(next);
}

/** The ends of the steps of the lane that the camera follows, or of all [s], in order. */
const stepEnds = computed(() => {
  const lanes = plan.value?.step_ends_s ?? [];
  return lanes[Number(page.camera.value) - 1] ?? lanes.flat().sort((a, b) => a - b);
});

// ---- playing

/** @type {number | null} */
let lastTick = null;

/** Advance the position, and draw. @param {number} now of the browser's clock [ms] */
export function tick(now) {
  const elapsed_s = lastTick === null ? 0 : Math.min((now - lastTick) / 1000, LONGEST_TICK_S);
  lastTick = now;
  const replayPlan = plan.peek();
  if (!replayPlan || !scene || replayProblem.peek() !== null) return;
  if (playing.peek() && !hasEnded.peek() && !isBuffering.peek()) {
    const next = inRecording(replayPlan.recorded_s, replayTime.peek() + elapsed_s * speed.peek());
    replayTime.value = Math.min(next, endTime.peek());
  }
  if (playing.peek() && !hasEnded.peek()) playFrame(replayPlan, now, elapsed_s);
  else showMoment(now);
  const isNearEnd = endTime.peek() - replayTime.peek() <= speed.peek() * GROWTH_MS / 1000;
  if (!replayPlan.complete && isNearEnd) grow(now);
  if (shown.frame && shown.view !== page.camera.peek()) {
    draw([follower.centring(scene, shown.frame, page.camera.peek(), Infinity)]);
    shown = { ...shown, view: page.camera.peek() };
  }
}

/** Show the frame at the position, of a segment at the level that fits the speed. */
function playFrame(/** @type {ReplayPlan} */ replayPlan, /** @type {number} */ now, /** @type {number} */ elapsed_s) {
  const { address, next, index: wanted } = placeOf(replayPlan, speed.peek(), replayTime.peek());
  const loaded = segmentAt(address);
  if (!loaded) {
    isBuffering.value = true;
    showMoment(now);
    return;
  }
  const index = Math.min(wanted, loaded.frames.length - 1);
  isBuffering.value = false;
  if (next && index >= replayPlan.segment_frames / 2) segmentAt(next);
  if (shown.address === address && shown.index === index) return;
  const state = /** @type {SceneState} */ (scene);
  const newest = loaded.frames[index];
  const messages = state.showFrame(loaded.frames, index, shown.address === address ? shown.index : -1);
  draw([...messages, follower.centring(state, newest, page.camera.peek(), elapsed_s)]);
  shown = { address, index, time_s: newest.time_s, frame: newest, view: page.camera.peek() };
  tell(loaded.frames.slice(0, index + 1).findLast((frame) => frame.scene) ?? newest, now);
}

/** @param {string} address */
const segmentAt = (address) => segments.get(address, plan.peek()?.segment_frames ?? 0, wholeEnd.peek());

let grewAt = -Infinity;

/** Request the plan of a run that has computed more since. */
async function grow(/** @type {number} */ now) {
  if (isGrowthPending || now - grewAt < GROWTH_MS) return;
  grewAt = now;
  isGrowthPending = true;
  const attemptNow = opening;
  try {
    const answer = await getReplay(/** @type {string} */ (page.run.peek()), clock.peek(), page.ghost.peek());
    if (attemptNow !== opening) return;
    isGrowthPending = false;
    plan.value = answer;
  } catch (error) {
    retryAfter(error, attemptNow, () => (isGrowthPending = false));
  }
}

/** Show the very moment of the position: while it is held, or until its segment is there. */
async function showMoment(/** @type {number} */ now) {
  const time_s = replayTime.peek();
  if (isMomentPending || Math.abs(shown.time_s - time_s) < SAME_S) return;
  isMomentPending = true;
  const attemptNow = opening;
  try {
    const { frames: [frame] } = await request("moment", { time_s: String(time_s), clock: clock.peek() });
    if (attemptNow !== opening || !scene) return;
    isMomentPending = false;
    drawMoment(scene, frame, time_s, now);
  } catch (error) {
    retryAfter(error, attemptNow, () => (isMomentPending = false));
  }
}

/** @type {(state: SceneState, frame: Frame, time_s: number, now: number) => void} */
function drawMoment(state, frame, time_s, now) {
  draw([...state.jump(frame.messages), follower.centring(state, frame, page.camera.peek(), Infinity)]);
  shown = { ...NOTHING, time_s, frame, view: page.camera.peek() };
  if (frame.time_s > time_s + SAME_S && replayTime.peek() === time_s) {
    // In a gap of the recording: the next moment is shown.
    replayTime.value = frame.time_s;
    shown.time_s = frame.time_s;
  }
  sceneSentAt = -Infinity;
  tell(frame, now);
}

/** Let the page know the moment, as often as the stage does. @param {Frame} frame @param {number} now */
function tell(frame, now) {
  if (!frame.scene || now - sceneSentAt < 1000 / SCENES_PER_S) return;
  sceneSentAt = now;
  const sceneOfFrame = /** @type {Scene} */ (frame.scene);
  ownScene.value = { ...sceneOfFrame, time_s: replayTime.peek(), shown_speed: speed.peek() };
}

// ---- the page's stage

function ownPhase() {
  if (plan.value?.complete === false) return "live";
  return hasEnded.value ? "ended" : "showing";
}

/** Keep the page's own stage, which takes the place of the one that all share. */
export function followReplay() {
  effect(() => {
    const id = page.run.value;
    if (id === null) return;
    ownStage.value = {
      run_id: id, next_run_id: null, phase: ownPhase(), origin: "chosen", playing: playing.value,
      ended: hasEnded.value, speed: speed.value, clock: clock.value, announced: null,
      end_at_time_out: page.end.value === "time-out",
    };
  });
  // A server that was away may have come back with the run.
  let wasAway = false;
  effect(() => {
    wasAway ||= connection.value === "reconnecting";
    if (connection.value !== "live" || !wasAway) return;
    wasAway = false;
    if (replayProblem.peek() && page.run.peek()) load(page.moment.peek() ?? 0);
  });
  effect(() => {
    const id = page.run.value;
    if (id !== null && isGone(id) && plan.peek()) untracked(lose);
  });
  let isLooping = false;
  const loop = (/** @type {number} */ now) => {
    isLooping = page.run.peek() !== null;
    if (!isLooping) return;
    tick(now);
    requestAnimationFrame(loop);
  };
  effect(() => {
    if (page.run.value === null || isLooping) return;
    isLooping = true;
    requestAnimationFrame(loop);
  });
  // A link, or "back", names another run or another moment.
  effect(() => {
    const [isOther, moment] = [named() !== opened, page.moment.value];
    if (isOther) untracked(() => batch(() => load(moment ?? 0)));
    else if (moment !== null && moment !== replayTime.peek()) seekReplay(moment);
  });
}

/** A link to the moment that is shown. */
export const replayLink = () =>
  linkTo({ run: page.run.peek(), ghost: page.ghost.peek(), moment: replayTime.peek() });
