// The moment of a replay and its camera, and what of both the 3D view is to draw.
import { Follower, inRecording, SceneState, shotOf } from "../replay-frames.js";
import { DIRECTED, FREE, LEADER } from "./commands.js";

/** @import { Frames } from "../replay-frames.js" */
/** @import { ReplayPlan } from "../types.js" */
/** @import { CameraPlace, Command } from "./commands.js" */
/** @import { ViewFrame } from "./view-frame.js" */

/**
 * The run: its plan by each of the clocks that this file has, the first of which it begins with, and which frames are
 * in the file: those of some segments at one level.
 * @typedef {{ title: string, level: number, notes: string[], clocks: Record<string, string>, plans: ReplayPlan[] }
 *   } RecordedReplay
 * Reads frames out of a block of the page; null if it has none of this name.
 * @typedef {(id: string) => Promise<Frames | null>} Read
 */

const FIRST_SPEED = 1;
const LONGEST_TICK_S = 0.25;
const KEPT_SEGMENTS = 8;
const UPDATE_MS = 250;
const SAME_S = 1e-6;
const NOWHERE = { number: -1, index: -1 };

/** The clock of a plan; of a training, the motion alone. @param {ReplayPlan} plan */
export const clockOf = (plan) => plan.clock ?? "free";

/** The interface of the page, `window.hexapods`. */
export class Player extends EventTarget {
  #time_s = 0;
  #speed = FIRST_SPEED;
  #isPlaying = false;
  /** @type {ReplayPlan} */
  #plan;
  /** @type {SceneState | null} */
  #scene = null;
  /** Name of a segment → frames; null while they are read. @type {Map<string, Frames | null>} */
  #segments = new Map();
  #shown = NOWHERE;
  #follower = new Follower();
  #followed = DIRECTED;
  /** Where the camera was placed last, or taken by hand. @type {CameraPlace & { fov?: number }} */
  #placed = {};
  /** The figures of the moment that is shown. @type {any} */
  #figures = null;
  /** From which of its sides a shot is taken. */
  #angle = 0;
  #lastTick = 0;
  #toldAt = -Infinity;

  /** @param {RecordedReplay} replay @param {Read} read @param {ViewFrame} view */
  constructor(replay, read, view) {
    super();
    this.replay = replay;
    this.read = read;
    this.view = view;
    [this.#plan] = replay.plans;
    // With its first picture the client has put the camera where it begins.
    view.addEventListener("drawn", () => this.isTaken && this.#place(this.#placed));
    view.addEventListener("lost", () => this.pause());
    view.addEventListener("kept", () => {
      if (this.isTaken && view.camera) this.#placed = view.camera;
    });
  }

  get time_s() { return this.#time_s; }
  get duration_s() { return this.#plan.recorded_s.at(-1)?.[1] ?? 0; }
  get paused() { return !this.#isPlaying; }
  get speed() { return this.#speed; }
  /** By which the run is timed: "free", the motion alone, "paper" or "wall". */
  get clock() { return clockOf(this.#plan); }
  /** What the camera follows. */
  get follow() { return this.#followed; }
  /** What is valid in this file. */
  get limits() { return { lanes: this.#plan.step_ends_s.length, clocks: this.replay.plans.map(clockOf) }; }
  /** Whether the camera is the viewer's, or that of the page around this one. */
  get isTaken() { return this.#followed !== DIRECTED; }
  get #interval_s() { return this.#plan.frame_s * 2 ** this.replay.level; }

  /** Go on; from the start if it has ended. */
  play() {
    if (this.#time_s >= this.duration_s - SAME_S) this.#time_s = 0;
    this.#isPlaying = true;
    this.#tell();
  }

  /** Hold. */
  pause() {
    this.#isPlaying = false;
    this.#tell();
  }

  /** Go to a moment [s], or to the nearest that is recorded. @param {number} time_s */
  seek(time_s) {
    if (!Number.isFinite(time_s)) return;
    this.#time_s = inRecording(this.#plan.recorded_s, Math.min(Math.max(time_s, 0), this.duration_s));
    this.#tell();
  }

  /** Hold, and go to the end of the next robot step, or of the one before. @param {number} direction */
  step(direction) {
    this.#isPlaying = false;
    const stepEnds = this.#plan.step_ends_s.flat().sort((a, b) => a - b);
    const next = direction > 0
      ? stepEnds.find((end) => end > this.#time_s + SAME_S) ?? this.duration_s
      : stepEnds.findLast((end) => end < this.#time_s - SAME_S) ?? 0;
    this.seek(next);
  }

  /** Times the run's own time. @param {number} times */
  setSpeed(times) {
    if (!(times > 0 && Number.isFinite(times))) return;
    this.#speed = times;
    this.#tell();
  }

  /** Time the run by another clock of this file, from the same share of it on. @param {string} clock */
  setClock(clock) {
    const plan = this.replay.plans.find((other) => clockOf(other) === clock);
    if (!plan || plan === this.#plan) return;
    const share = this.duration_s ? this.#time_s / this.duration_s : 0;
    this.#plan = plan;
    this.#shown = NOWHERE;
    this.seek(share * this.duration_s);
  }

  /** Move the camera; what is not there stays. @param {CameraPlace} camera */
  setCamera({ position, look_at, follow }) {
    const isPlaced = (position || look_at) && this.#followed === DIRECTED;
    const target = follow === undefined ? (isPlaced ? LEADER : this.#followed) : String(follow);
    if (target !== this.#followed) {
      this.#followed = target;
      this.#direct();
      this.#shown = NOWHERE; // the frame is drawn again, around something else
    }
    const moved = { ...(position && { position }), ...(look_at && { look_at }) };
    this.#placed = target === DIRECTED ? {} : { ...this.#placed, ...moved };
    this.#place({ position, look_at });
    this.dispatchEvent(new Event("camera"));
  }

  /** Take the directed camera from another of its sides. */
  nextAngle() {
    this.#angle += 1;
    this.#direct();
  }

  /** Do what a message or the address says. @param {Command} command */
  obey(command) {
    switch (command.name) {
      case "play": return this.play();
      case "pause": return this.pause();
      case "seek": return this.seek(command.time_s);
      case "step": return this.step(command.direction);
      case "speed": return this.setSpeed(command.speed);
      case "clock": return this.setClock(command.clock);
      case "camera": return this.setCamera(command.camera);
      default: return undefined;
    }
  }

  /** Draw in the view whenever it is there. */
  async open() {
    this.#scene = new SceneState(/** @type {Frames} */ (await this.read("scene")));
    this.view.addEventListener("connected", () => this.#restart());
    this.view.open(document.body);
    const loop = (/** @type {number} */ now) => {
      this.#tick(now);
      requestAnimationFrame(loop);
    };
    requestAnimationFrame(loop);
  }

  /** Draw all in a view that shows nothing yet. */
  #restart() {
    const scene = /** @type {SceneState} */ (this.#scene);
    this.view.draw(scene.restart());
    this.#shown = NOWHERE;
    this.#direct();
    this.#show(Infinity);
  }

  /** @param {CameraPlace & { fov?: number }} camera */
  #place({ position, look_at, fov }) {
    const messages = [];
    if (position) messages.push({ type: "SetCameraPositionMessage", position, initial: false });
    if (look_at) messages.push({ type: "SetCameraLookAtMessage", look_at, initial: false });
    if (fov) messages.push({ type: "SetCameraFovMessage", fov, initial: false });
    if (messages.length) this.view.draw(messages);
  }

  /** Let the camera know its shot: only the directed camera has any. */
  #direct() {
    const shot = shotOf(this.#figures, this.#followed === DIRECTED ? DIRECTED : FREE);
    this.view.show({ ...shot, angle: this.#angle });
  }

  #tick(/** @type {number} */ now) {
    const elapsed_s = Math.min((now - this.#lastTick) / 1000, LONGEST_TICK_S);
    this.#lastTick = now;
    // A picture that nobody sees would be over before it is drawn.
    const isSeen = this.view.isLive || !this.view.isAvailable;
    if (this.#isPlaying && isSeen && this.#show(elapsed_s)) {
      this.#time_s = inRecording(this.#plan.recorded_s, this.#time_s + elapsed_s * this.#speed);
      if (this.#time_s >= this.duration_s - SAME_S) this.#isPlaying = false;
      if (!this.#isPlaying || now - this.#toldAt >= UPDATE_MS) this.#tell(now);
    }
    this.#show(elapsed_s);
  }

  /** Show the frame at the position; whether it is there. @param {number} elapsed_s */
  #show(elapsed_s) {
    const { segment_frames } = this.#plan;
    const frame = Math.floor(this.#time_s / this.#interval_s + SAME_S);
    const number = Math.floor(frame / segment_frames);
    const loaded = this.#segment(number);
    if (!loaded || !this.#scene) return false;
    const isLast = this.#time_s >= this.duration_s - SAME_S;
    const index = isLast ? loaded.frames.length - 1 : Math.min(frame % segment_frames, loaded.frames.length - 1);
    if (index >= segment_frames / 2) this.#segment(number + 1);
    const { number: before, index: shown } = this.#shown;
    if (before === number && shown === index) return true;
    const messages = this.#scene.showFrame(loaded.frames, index, before === number ? shown : -1);
    const lag_s = before === number || before + 1 === number ? elapsed_s : Infinity;
    const centring = this.#follower.centring(this.#scene, loaded.frames[index], this.#followed, lag_s);
    this.view.draw([...messages, centring]);
    this.#shown = { number, index };
    const figures = /** @type {any} */ (loaded.frames.slice(0, index + 1).findLast((earlier) => earlier.scene)?.scene);
    if (figures) {
      this.#figures = figures;
      this.#direct();
      this.view.show({ lanes: figures.lanes.map((/** @type {{ color: string }} */ { color }) => color) });
    }
    if (!this.#isPlaying) this.view.settle();
    return true;
  }

  /** @param {number} number */
  #segment(number) {
    const name = `segment-${this.clock}-${number}`;
    const segment = this.#segments.get(name);
    if (segment !== undefined) return segment;
    this.#segments.set(name, null);
    for (const oldest of this.#segments.keys()) {
      if (this.#segments.size <= KEPT_SEGMENTS) break;
      this.#segments.delete(oldest);
    }
    this.read(name).then((frames) => frames && this.#segments.set(name, frames));
    return null;
  }

  /** Let others know the moment. */
  #tell(now = performance.now()) {
    this.#toldAt = now;
    this.dispatchEvent(new Event("timeupdate"));
  }
}
