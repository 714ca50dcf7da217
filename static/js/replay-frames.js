// Frames of a run: decodes them, and tells what to send to the 3D view to be at one of them.
// Their encoder: hexapods/drawing/replay_encoding.py.

/** @import { Playhead, ReplayPlan } from "./types.js" */

/** A message of viser. @typedef {Record<string, any> & { type: string }} Message */
/** Position of each view on the ground [m]. @typedef {Record<string, [number, number]>} FollowPoints */
/** @typedef {{ time_s: number, messages: Message[], follow: FollowPoints, scene: object | null }} Frame */
/** Effect of a type of message: kind of entity, phase of its life, field with its id. @typedef {string | null} Part */
/** @typedef {{ frames: Frame[], lifecycles?: Record<string, [Part, Part, Part]>, world?: string }} Frames */

/** @type {Record<string, (new (buffer: ArrayBuffer) => ArrayBufferView)>} */
const ARRAYS = {
  "<f4": Float32Array, "<f8": Float64Array, "|u1": Uint8Array, "<u2": Uint16Array, "<u4": Uint32Array,
  "|i1": Int8Array, "<i2": Int16Array, "<i4": Int32Array,
};
/**
 * Times of a run that differ by no more are one moment, as on the server (hexapods/runs/clocks.py): it tells
 * milliseconds, and sums of steps' durations differ in their last bits. A step lasts longer.
 */
export const SAME_MOMENT_S = 0.001;
/** Time constant with which the leader is followed, [s]. */
const SMOOTHING_S = 0.25;
/** Of so many frames at once only the last is shown. */
const MAX_STEPS = 4;
const HEAD_BYTES = 4;
/** Of an encoding without messages that are just poses. */
const NO_POSES = { step: 1, planes: 0, series: [], tracks: [] };
const ALIGNMENT_BYTES = 8;

/**
 * Poses that nodes share: values in a frame, and frames. @typedef {[number, number]} Series
 * Pose of a node in the frames in which it changes: a message without it, its property, the number of its series.
 * @typedef {{ message: Message, property: string, series: number }} Track
 */

/**
 * Decode frames. Each array has memory of its own, so that it can be sent by itself.
 * @param {ArrayBuffer} data
 * @returns {Frames}
 */
export function decode(data) {
  const size = new DataView(data).getUint32(0, true);
  const head = JSON.parse(new TextDecoder().decode(new Uint8Array(data, HEAD_BYTES, size)));
  const { poses = NO_POSES, lengths, arrays, ...frames } = head;
  const packed = new Uint8Array(data, HEAD_BYTES + size, poses.planes * countOf(poses.series));
  const nextPose = posesOf(packed, poses);
  let at = HEAD_BYTES + size + packed.length;
  const blocks = lengths.map((/** @type {number} */ length) => {
    at += (ALIGNMENT_BYTES - (at % ALIGNMENT_BYTES)) % ALIGNMENT_BYTES;
    at += length;
    return [at - length, at];
  });
  /** @type {(index: number) => ArrayBuffer} */
  const arrayAt = (index) => data.slice(...blocks[arrays[index]]);
  /** @type {(value: any) => any} */
  const resolve = (value) => {
    if (Array.isArray(value)) return value.map(resolve);
    if (value === null || typeof value !== "object") return value;
    if ("__binary_index" in value) return new (ARRAYS[value.dtype] ?? Uint8Array)(arrayAt(value.__binary_index));
    return Object.fromEntries(Object.entries(value).map(([name, item]) => [name, resolve(item)]));
  };
  for (const frame of frames.frames) {
    frame.messages = frame.messages.map((/** @type {number | Message} */ message) =>
      typeof message === "number" ? nextPose(message) : resolve(message));
  }
  return frames;
}

/** Number of values. @type {(series: Series[]) => number} */
const countOf = (series) => series.reduce((count, [size, frames]) => count + size * frames, 0);

/**
 * A function that returns the next message of a track. Poses are packed as byte planes, low bytes first, of zigzag
 * codes of differences from the frame before, by series, value and frame (hexapods/drawing/pose_tracks.py).
 * @param {Uint8Array} packed
 * @param {{ step: number, planes: number, series: Series[], tracks: Track[] }} poses
 * @returns {(track: number) => Message}
 */
function posesOf(packed, { step, planes, series, tracks }) {
  const codes = new Int32Array(countOf(series));
  for (let plane = 0; plane < planes; plane += 1) {
    const start = plane * codes.length;
    for (let at = 0; at < codes.length; at += 1) codes[at] |= packed[start + at] << (8 * plane);
  }
  let at = 0;
  const steps = series.map(([size, count]) => {
    const frames = Array.from({ length: count }, () => new Int32Array(size));
    for (let value = 0; value < size; value += 1) {
      let sum = 0;
      for (let frame = 0; frame < count; frame += 1, at += 1) {
        sum = (sum + ((codes[at] >>> 1) ^ -(codes[at] & 1))) | 0;
        frames[frame][value] = sum;
      }
    }
    return frames;
  });
  const taken = tracks.map(() => 0);
  return (track) => {
    const { message, property, series: number } = tracks[track];
    const pose = steps[number][taken[track]];
    taken[track] += 1;
    if (!("updates" in message)) return { ...message, [property]: Array.from(pose, (value) => value * step) };
    const floats = new Float32Array(pose.length);
    for (let value = 0; value < pose.length; value += 1) floats[value] = pose[value] * step;
    return { ...message, updates: { [property]: floats } };
  };
}

/** Decode frames that are sent as text, compressed. @param {string} text in base 64 */
export async function unpack(text) {
  const bytes = Uint8Array.from(atob(text), (letter) => letter.charCodeAt(0));
  const unpacked = new Blob([bytes]).stream().pipeThrough(new DecompressionStream("gzip"));
  return decode(await new Response(unpacked).arrayBuffer());
}

/** The messages about one entity by their slots. @typedef {Map<string, Message>} Slots */

/**
 * State of the 3D view of a run: the newest message for each slot. A newer message replaces the one in its slot; a node
 * that is created or removed loses all earlier messages about it.
 */
export class SceneState {
  /** @param {Frames} scene the scene at the start of the run, on which every segment is based */
  constructor({ frames, lifecycles = {}, world = "" }) {
    this.lifecycles = lifecycles;
    /** The node that all others are in. */
    this.world = world;
    this.start = frames.flatMap(({ messages }) => messages);
    this.base = this.stateAfter(this.start);
    this.clear();
  }

  /**
   * Base the frames that follow on another version of the scene. What is shown stays until the next jump, which sends
   * no more of the scene than what differs.
   * @param {Frames} scene
   */
  rebase({ frames }) {
    const before = this.base;
    this.start = frames.flatMap(({ messages }) => messages);
    this.base = this.stateAfter(this.start);
    for (const [entity, slots] of this.base) {
      const known = before.get(entity);
      if (known && isEqual([...known], [...slots])) this.base.set(entity, known);
      else this.changed.add(entity);
    }
  }

  /** @private @param {Message[]} messages */
  stateAfter(messages) {
    /** @type {Map<string, Slots>} */
    const state = new Map();
    for (const message of messages) this.put(state, message);
    return state;
  }

  /** Forget what is shown, and return the messages that show the start of the run instead. */
  restart() {
    this.clear();
    return this.start;
  }

  /** @private */
  clear() {
    /** Entities shown. @type {Map<string, Slots>} */
    this.shown = new Map(this.base);
    /** The entities that differ from the start. @type {Set<string>} */
    this.changed = new Set();
  }

  /**
   * Show what follows what is shown.
   * @param {Message[]} messages
   */
  follow(messages) {
    for (const message of messages) {
      for (const entity of this.put(this.shown, message)) this.changed.add(entity);
    }
    return messages;
  }

  /**
   * Show another moment, which messages tell from the start of the run on; returns what to send.
   * @param {Message[]} messages
   */
  jump(messages) {
    const target = new Map(this.base);
    const changed = new Set(messages.flatMap((message) => this.put(target, message)));
    const touched = [...target.keys()].filter((entity) => this.changed.has(entity) || changed.has(entity));
    const gone = [...this.shown.keys()].filter((entity) => !target.has(entity));
    const sent = gone.map(removal);
    for (const entity of touched) {
      const before = this.shown.get(entity);
      const now = /** @type {Slots} */ (target.get(entity));
      // A value that was set since cannot be taken back but by making its node again.
      const isAnew = !before || [...before.keys()].some((key) => !now.has(key));
      for (const [key, message] of now) if (isAnew || before.get(key) !== message) sent.push(message);
    }
    this.shown = target;
    this.changed = new Set([...changed, ...gone.filter((entity) => this.base.has(entity))]);
    return sent;
  }

  /**
   * Show a frame of a segment; returns what to send.
   * @param {Frame[]} frames of the segment
   * @param {number} index of the frame
   * @param {number} shown index of the frame of this segment that is shown, -1 if none is
   */
  showFrame(frames, index, shown) {
    const isNext = shown >= 0 && shown < index && index - shown <= MAX_STEPS;
    const messages = frames.slice(isNext ? shown + 1 : 0, index + 1).flatMap((frame) => frame.messages);
    return isNext ? this.follow(messages) : this.jump(messages);
  }

  /**
   * Put a message into its slot; returns the entities that it changes.
   * @private
   * @param {Map<string, Slots>} state
   * @param {Message} message
   */
  put(state, message) {
    const { entity, phase, key } = this.slotOf(message);
    if (phase === "remove") {
      const removed = [...state.keys()].filter((name) => name === entity || name.startsWith(`${entity}/`));
      for (const name of removed) state.delete(name);
      return removed;
    }
    // A copy, since states share what they have in common.
    const slots = new Map(phase === "create" ? [] : state.get(entity));
    slots.delete(key);
    slots.set(key, message);
    state.set(entity, slots);
    return [entity];
  }

  /**
   * @private
   * @param {Message} message
   */
  slotOf(message) {
    const [kind, phase, idField] = this.lifecycles[message.type] ?? [null, null, null];
    let entity = message.type;
    if (kind && idField) entity = `${kind} ${message[idField]}`;
    else if ("name" in message) entity = `scene ${message.name}`;
    if (phase === "create") return { entity, phase, key: phase };
    const fields = phase === "update_dict" ? Object.keys(message.updates).sort().join() : "";
    return { entity, phase, key: `${message.type} ${fields}` };
  }
}

/** Whether two values of messages are the same in all their parts. @type {(a: any, b: any) => boolean} */
function isEqual(a, b) {
  if (a === b) return true;
  if (a === null || b === null || typeof a !== "object" || a.constructor !== b?.constructor) return false;
  const keys = Object.keys(a);
  return keys.length === Object.keys(b).length && keys.every((key) => isEqual(a[key], b[key]));
}

/** @type {(entity: string) => Message} */
const removal = (entity) => ({ type: "RemoveSceneNodeMessage", name: entity.slice(entity.indexOf(" ") + 1) });

// ---- the camera

/** The figures of a moment that decide the shot. */
/** @typedef {{ kind: string, phase: string, lanes: { step: number }[] }} Shown */
/** The shot, null where the viewer has the camera, and the lane of its robot, null for all of them. */
/** @typedef {{ shot: "start" | "race" | "finish" | "practice" | "close" | null, lane: number | null }} Shot */

/**
 * The shot of a moment (viewer/shots.js has from where it is taken): the start line until the first step is made, the
 * race, its end; or the robot of a lane.
 * @type {(scene: Shown | null, target: string) => Shot}
 */
export function shotOf(scene, target) {
  const lane = Number(target) - 1;
  const lanes = scene?.lanes ?? [];
  if (target === "free") return { shot: null, lane: null };
  if (lanes[lane] && lanes.length > 1) return { shot: "close", lane };
  if (scene?.kind === "training") return { shot: "practice", lane: null };
  if (scene?.kind !== "race" || lanes.every(({ step }) => step <= 1)) return { shot: "start", lane: null };
  return { shot: ["photo-finish", "finished"].includes(scene.phase) ? "finish" : "race", lane: null };
}

/**
 * Keeps what the camera follows in the middle of the world: a lane at once, the leader smoothly; "free" nothing. Where
 * the camera is directed it goes along, so that who takes it by hand has it in the middle.
 */
export class Follower {
  constructor() {
    this.x = 0;
    this.y = 0;
  }

  /**
   * The message that centres the world.
   * @param {SceneState} state
   * @param {Frame} frame
   * @param {string} view
   * @param {number} elapsed_s since the picture before; Infinity for another moment
   * @returns {Message}
   */
  centring({ world }, { follow }, view, elapsed_s) {
    const isLane = view in follow && view !== "leader";
    const [x, y] = view === "free" ? [this.x, this.y] : follow[isLane ? view : "leader"] ?? [0, 0];
    const share = !isLane ? Math.exp(-elapsed_s / SMOOTHING_S) : 0;
    [this.x, this.y] = [x, y + (this.y - y) * share];
    return { type: "SetPositionMessage", name: world, position: [-this.x, -this.y, 0], owner: "" };
  }
}

/**
 * The time itself, or the next one that is recorded.
 * @type {(recorded_s: [number, number][], time_s: number) => number}
 */
export function inRecording(recorded_s, time_s) {
  const next = recorded_s.find(([, end]) => time_s <= end);
  return next ? Math.max(time_s, next[0]) : recorded_s.at(-1)?.[1] ?? 0;
}

/**
 * The moment of the stage's picture at a time of the server's clock, and how fast it moves there.
 * @param {Playhead} playhead
 * @param {number} server_s
 */
export function momentOf({ at_s, points, rate }, server_s) {
  const after_s = Math.max(server_s - at_s, points[0][0]);
  const next = points.findIndex(([point_s]) => point_s > after_s);
  const [begin_s, begin] = points.at(next - (next < 0 ? 0 : 1)) ?? points[0];
  const speed = next < 0 ? rate : (points[next][1] - begin) / (points[next][0] - begin_s);
  return { time_s: begin + (after_s - begin_s) * speed, rate: speed };
}

/** How much faster or slower the picture goes to be where it should, and what error is too great for that [s]. */
const [CATCH_UP, GREATEST_ERROR_S] = [0.1, 0.5];

/**
 * Where the picture goes from a moment, to be at another one: a small error is made up for by its speed.
 * @type {(from_s: number, to_s: number, rate: number, elapsed_s: number) => number}
 */
export function approached(from_s, to_s, rate, elapsed_s) {
  const step_s = rate * elapsed_s;
  const error_s = to_s - from_s - step_s;
  if (rate <= 0 || !(Math.abs(error_s) < GREATEST_ERROR_S * rate)) return to_s;
  return from_s + step_s + Math.sign(error_s) * Math.min(Math.abs(error_s), CATCH_UP * step_s);
}

// ---- what the plan of a replay tells

/** The last moment that is recorded [s]. @param {ReplayPlan} plan */
export const endOf = ({ recorded_s }) => recorded_s.at(-1)?.[1] ?? 0;

/**
 * The moment at which the first of the lanes has taken so many steps, or an earlier one [s].
 * @type {(plan: ReplayPlan | null, steps: number, earlier_s: number) => number}
 */
export const beginOfStep = (plan, steps, earlier_s) => {
  const ends = (plan?.step_ends_s ?? []).map((lane) => (steps ? lane[steps - 1] ?? Infinity : 0));
  return Math.min(earlier_s, ...ends);
};

/** Time-out of the race [s]; null until it is known. @param {ReplayPlan | null} plan */
export const timeOutOf = (plan) => plan?.marks.find(({ kind }) => kind === "time-out")?.time_s ?? null;

/** How many steps the first lane has taken until a time [s]. */
/** @type {(plan: ReplayPlan | null, time_s: number) => number} */
export const stepsUntil = (plan, time_s) =>
  (plan?.step_ends_s[0] ?? []).filter((end) => end <= time_s + SAME_MOMENT_S).length;

/**
 * The end of the next step or of the one before, of a lane or of all if there is none of this number [s]; null after
 * the last.
 * @type {(plan: ReplayPlan | null, lane: number, time_s: number, direction: 1 | -1) => number | null}
 */
export function nextStep(plan, lane, time_s, direction) {
  const lanes = plan?.step_ends_s ?? [];
  const ends = lanes[lane] ?? lanes.flat().sort((a, b) => a - b);
  return direction > 0
    ? ends.find((end) => end > time_s + SAME_MOMENT_S) ?? null
    : ends.findLast((end) => end < time_s - SAME_MOMENT_S) ?? 0;
}
