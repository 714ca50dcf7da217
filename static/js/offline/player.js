// Plays a replay out of the file that it is in, without a server. hexapods/exports/replay_page.py puts it there, with
// the modules that it imports, the frames of the run and viser's client. The interface is described in docs/exports.md.
import { Follower, inRecording, SceneState, shotOf, unpack } from "../replay-frames.js";

/** @import { Frames } from "../replay-frames.js" */
/** @import { ReplayPlan } from "../types.js" */

/**
 * The run, and which frames of it are in this file: those of some segments at one level.
 * @typedef {ReplayPlan & { title: string, level: number, notes: string[] }} RecordedReplay
 */

const FIRST_SPEED = 1;
const SPEEDS = [0.25, 0.5, 1, 2, 4, 8, 16];
const LONGEST_TICK_S = 0.25;
const KEPT_SEGMENTS = 8;
const UPDATE_MS = 250;
const SAME_S = 1e-6;
/** The camera's coordinates may be as far from what it follows, and its place from what it looks at as near [m]. */
const [FARTHEST_M, NEAREST_M] = [100, 0.01];
/** What the camera may follow, but lanes, which are numbered from 1. */
const [DIRECTED, LEADER, FREE] = ["directed", "leader", "free"];

/** @param {string} id */
const textOf = (id) => document.getElementById(id)?.textContent ?? null;

/** @type {RecordedReplay} */
const replay = JSON.parse(/** @type {string} */ (textOf("replay")));
const interval_s = replay.frame_s * 2 ** replay.level;
const end_s = replay.recorded_s.at(-1)?.[1] ?? 0;
const stepEnds = replay.step_ends_s.flat().sort((a, b) => a - b);

/** Frames out of a block of this page; null if it has none of this name. @param {string} id */
async function read(id) {
  const text = textOf(id);
  return text === null ? null : await unpack(text);
}

/** @param {unknown} value */
const isPlace = (value) => Array.isArray(value) && value.length === 3
  && value.every((number) => typeof number === "number" && Math.abs(number) <= FARTHEST_M);

/** @param {string} name @param {object} detail */
const emit = (name, detail) => dispatchEvent(new CustomEvent(name, { detail }));

/** The interface of this page, `window.hexapods`. */
class Player extends EventTarget {
  #time_s = 0;
  #speed = FIRST_SPEED;
  #isPlaying = false;
  /** @type {SceneState | null} */
  #scene = null;
  /** Number of a segment → frames; null while they are read. @type {Map<number, Frames | null>} */
  #segments = new Map();
  #shown = { number: -1, index: -1 };
  #follower = new Follower();
  #followed = DIRECTED;
  /** The figures of the moment that is shown. @type {any} */
  #figures = null;
  /** From which of its sides a shot is taken. */
  #angle = 0;
  #lastTick = 0;
  #toldAt = -Infinity;

  get time_s() { return this.#time_s; }
  get duration_s() { return end_s; }
  get paused() { return !this.#isPlaying; }
  get speed() { return this.#speed; }
  /** By which the run is timed: "free", the motion alone, "paper" or "wall". */
  get clock() { return replay.clock ?? "free"; }

  /** Go on; from the start if it has ended. */
  play() {
    if (this.#time_s >= end_s - SAME_S) this.#time_s = 0;
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
    this.#time_s = inRecording(replay.recorded_s, Math.min(Math.max(time_s, 0), end_s));
    this.#tell();
  }

  /** Hold, and go to the end of the next robot step, or of the one before. @param {number} direction */
  step(direction) {
    this.#isPlaying = false;
    const next = direction > 0
      ? stepEnds.find((end) => end > this.#time_s + SAME_S) ?? end_s
      : stepEnds.findLast((end) => end < this.#time_s - SAME_S) ?? 0;
    this.seek(next);
  }

  /** Times the run's own time. @param {number} times */
  setSpeed(times) {
    if (!(times > 0 && Number.isFinite(times))) return;
    this.#speed = times;
    this.#tell();
  }

  /**
   * Move the camera; what is not given stays. Nothing happens if a value is not valid.
   * @param {{ position?: number[], look_at?: number[], follow?: string | number }} camera
   *   Its place and what it looks at, (x, y, z) [m] from what it follows on the ground: x to the right, y along the
   *   track, z up; and what it follows: "directed", where it moves by itself, "leader", "free" or the number of a lane,
   *   from 1.
   */
  setCamera({ position, look_at, follow }) {
    const places = [position, look_at].filter((place) => place !== undefined);
    const isPlaced = places.length > 0 && this.#followed === DIRECTED;
    const target = follow === undefined ? (isPlaced ? LEADER : this.#followed) : String(follow);
    const isThere = [DIRECTED, LEADER, FREE, ...replay.step_ends_s.map((_, lane) => String(lane + 1))].includes(target);
    if (!isThere || !places.every(isPlace)) return;
    if (position && look_at && Math.hypot(...position.map((x, axis) => x - look_at[axis])) < NEAREST_M) return;
    if (target !== this.#followed) {
      this.#followed = target;
      this.#direct();
      this.#shown = { number: -1, index: -1 }; // the frame is drawn again, around something else
    }
    const messages = [];
    if (position) messages.push({ type: "SetCameraPositionMessage", position, initial: false });
    if (look_at) messages.push({ type: "SetCameraLookAtMessage", look_at, initial: false });
    if (messages.length) emit("hexapods:draw", { messages });
  }

  /** Take the directed camera from another of its sides. */
  nextAngle() {
    this.#angle += 1;
    this.#direct();
  }

  /** Let the camera know its shot: only the directed camera has any. */
  #direct() {
    const shot = shotOf(this.#figures, this.#followed === DIRECTED ? DIRECTED : FREE);
    emit("hexapods:show", { ...shot, angle: this.#angle });
    this.dispatchEvent(new Event("camera"));
  }

  /** Whether the camera is the viewer's, or that of the page around this one. */
  get isTaken() { return this.#followed !== DIRECTED; }

  /** Draw in viser's client, which has an empty scene. */
  async open() {
    const start = /** @type {Frames} */ (await read("scene"));
    this.#scene = new SceneState(start);
    emit("hexapods:draw", { messages: this.#scene.restart() });
    this.#shown = { number: -1, index: -1 };
    const loop = (/** @type {number} */ now) => {
      this.#tick(now);
      requestAnimationFrame(loop);
    };
    requestAnimationFrame(loop);
  }

  #tick(/** @type {number} */ now) {
    const elapsed_s = Math.min((now - this.#lastTick) / 1000, LONGEST_TICK_S);
    this.#lastTick = now;
    if (this.#isPlaying && this.#show(elapsed_s)) {
      this.#time_s = inRecording(replay.recorded_s, this.#time_s + elapsed_s * this.#speed);
      if (this.#time_s >= end_s - SAME_S) this.#isPlaying = false;
      if (!this.#isPlaying || now - this.#toldAt >= UPDATE_MS) this.#tell(now);
    }
    this.#show(elapsed_s);
  }

  /** Show the frame at the position; whether it is there. @param {number} elapsed_s */
  #show(elapsed_s) {
    const frame = Math.floor(this.#time_s / interval_s + SAME_S);
    const number = Math.floor(frame / replay.segment_frames);
    const loaded = this.#segment(number);
    if (!loaded || !this.#scene) return false;
    const isLast = this.#time_s >= end_s - SAME_S;
    const index = isLast ? loaded.frames.length - 1 : Math.min(frame % replay.segment_frames, loaded.frames.length - 1);
    if (index >= replay.segment_frames / 2) this.#segment(number + 1);
    const { number: before, index: shown } = this.#shown;
    if (before === number && shown === index) return true;
    const messages = this.#scene.showFrame(loaded.frames, index, before === number ? shown : -1);
    const lag_s = before === number || before + 1 === number ? elapsed_s : Infinity;
    const centring = this.#follower.centring(this.#scene, loaded.frames[index], this.#followed, lag_s);
    emit("hexapods:draw", { messages: [...messages, centring] });
    this.#shown = { number, index };
    const scene = /** @type {any} */ (loaded.frames.slice(0, index + 1).findLast((earlier) => earlier.scene)?.scene);
    if (scene) {
      this.#figures = scene;
      this.#direct();
      emit("hexapods:scene", scene);
    }
    return true;
  }

  /** @param {number} number */
  #segment(number) {
    const segment = this.#segments.get(number);
    if (segment !== undefined) return segment;
    this.#segments.set(number, null);
    for (const oldest of this.#segments.keys()) {
      if (this.#segments.size <= KEPT_SEGMENTS) break;
      this.#segments.delete(oldest);
    }
    read(`segment-${number}`).then((frames) => frames && this.#segments.set(number, frames));
    return null;
  }

  /** Let others know the moment. */
  #tell(now = performance.now()) {
    this.#toldAt = now;
    this.dispatchEvent(new Event("timeupdate"));
  }
}

const player = new Player();
Object.assign(window, { hexapods: player });

// ---- the page that embeds this one: the same interface as messages, and nothing else

const isEmbedded = parent !== window;
const tellParent = (/** @type {string} */ type) => {
  const { time_s, duration_s, paused, speed, clock } = player;
  if (isEmbedded) parent.postMessage({ type, time_s, duration_s, paused, speed, clock }, "*");
};

addEventListener("message", ({ source, data }) => {
  if (!isEmbedded || source !== parent || data === null || typeof data !== "object") return;
  if (data.type === "hexapods:play") player.play();
  else if (data.type === "hexapods:pause") player.pause();
  else if (data.type === "hexapods:seek" && typeof data.time_s === "number") player.seek(data.time_s);
  else if (data.type === "hexapods:step" && typeof data.direction === "number") player.step(data.direction);
  else if (data.type === "hexapods:speed" && typeof data.speed === "number") player.setSpeed(data.speed);
  else if (data.type === "hexapods:camera") player.setCamera(data);
});
player.addEventListener("timeupdate", () => tellParent("hexapods:timeupdate"));

// ---- the controls

/** @type {(tag: string, properties?: object, ...children: (Node | string)[]) => any} */
const make = (tag, properties = {}, ...children) => {
  const element = Object.assign(document.createElement(tag), properties);
  element.append(...children);
  return element;
};

const play = make("button", { type: "button", onclick: () => (player.paused ? player.play() : player.pause()) });
const stepButton = (/** @type {number} */ direction, /** @type {string} */ label, /** @type {string} */ sign) =>
  make("button", { type: "button", ariaLabel: label, title: label, onclick: () => player.step(direction) }, sign);
const directed = make("button",
  { type: "button", className: "directed", hidden: true, onclick: () => player.setCamera({ follow: DIRECTED }) },
  "Directed camera");
const slider = make("input",
  { type: "range", min: "0", max: String(end_s), step: "any", ariaLabel: "Moment of the run" });
slider.addEventListener("input", () => player.seek(slider.valueAsNumber));
const clock = make("output", { className: "clock" });
const speeds = make("select", { ariaLabel: "Speed", onchange: () => player.setSpeed(Number(speeds.value)) },
  ...SPEEDS.map((times) => make("option", { value: String(times), selected: times === FIRST_SPEED }, `× ${times}`)));
const bar = make("div", { className: "player" }, play,
  stepButton(-1, "One robot step back", "◂"), stepButton(1, "One robot step on", "▸"), slider, clock, speeds, directed);
const heading = make("p", { className: "replay-title" }, make("b", {}, replay.title), " ",
  ...replay.notes.map((note) => make("span", {}, note)));

function showState() {
  const label = player.paused ? "Play" : "Pause";
  Object.assign(play, { textContent: player.paused ? "▶" : "❚❚", ariaLabel: label, title: label });
  slider.value = String(player.time_s);
  clock.textContent = `${player.time_s.toFixed(1)} of ${end_s.toFixed(1)} s`;
  if (Number(speeds.value) !== player.speed) speeds.value = String(player.speed);
}

/** Keep the scene's labels clear of the controls, and in the lanes' colours. */
function showCovered() {
  const covered = [bar, heading].map((element) => element.getBoundingClientRect().toJSON());
  emit("hexapods:show", { covered });
}

player.addEventListener("timeupdate", showState);
player.addEventListener("camera", () => (directed.hidden = !player.isTaken));
addEventListener("hexapods:taken", () => player.setCamera({ follow: LEADER }));
addEventListener("hexapods:scene", (event) => {
  const { detail } = /** @type {CustomEvent} */ (event);
  emit("hexapods:show", { lanes: detail.lanes.map((/** @type {{ color: string }} */ { color }) => color) });
});
addEventListener("resize", showCovered);
addEventListener("keydown", (event) => {
  if (event.ctrlKey || event.altKey || event.metaKey || event.target instanceof HTMLButtonElement) return;
  if (event.key === " ") play.click();
  else if (event.key === ",") player.step(-1);
  else if (event.key === ".") player.step(1);
  else if (event.key === "c") player.setCamera({ follow: DIRECTED });
  else if (event.key === "v") player.nextAngle();
});

// ---- the theme: of the address, or of the system

const theme = new URLSearchParams(location.search).get("theme");
const prefersDark = matchMedia("(prefers-color-scheme: dark)");
const showTheme = () => {
  const system = prefersDark.matches ? "dark" : "light";
  document.documentElement.dataset.theme = theme === "light" || theme === "dark" ? theme : system;
};
prefersDark.addEventListener("change", showTheme);
showTheme();

addEventListener("hexapods:connected", async () => {
  document.body.append(heading, bar);
  await player.open();
  showState();
  showCovered();
  player.dispatchEvent(new Event("ready"));
  tellParent("hexapods:ready");
  player.seek(0);
});
