// Frames of a replay: decodes them, and tells what to send to the 3D view to be at one of them.
// Their encoder: hexapods/drawing/replay_encoding.py.

/** @import { ReplayPlan } from "./types.js" */

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
/** Time constant with which the leader is followed, as in the live view (hexapods/drawing/scene.py) [s]. */
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

/** The messages about one entity by their slots. @typedef {Map<string, Message>} Slots */

/**
 * State of the 3D view of a run: the newest message for each slot. A newer message replaces the one in its slot; a node
 * that is created or removed loses all earlier messages about it, as in app/viewer/snapshot.py.
 */
export class SceneState {
  /** @param {Frames} scene the scene at the start of the run, on which every segment is based */
  constructor({ frames, lifecycles = {}, world = "" }) {
    this.lifecycles = lifecycles;
    /** The node that all others are in. */
    this.world = world;
    this.start = frames.flatMap(({ messages }) => messages);
    /** @type {Map<string, Slots>} */
    this.base = new Map();
    for (const message of this.start) this.put(this.base, message);
    this.clear();
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

/** @type {(entity: string) => Message} */
const removal = (entity) => ({ type: "RemoveSceneNodeMessage", name: entity.slice(entity.indexOf(" ") + 1) });

/** Keeps what the camera follows in the middle of the world: a lane at once, the leader smoothly. */
export class Follower {
  constructor() {
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
    const [x, y] = follow[view] ?? [0, 0];
    if (view === "leader") this.y = y + (this.y - y) * Math.exp(-elapsed_s / SMOOTHING_S);
    const at = view === "leader" ? this.y : y;
    return { type: "SetPositionMessage", name: world, position: [-x, -at, 0], owner: "" };
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

// ---- the segments that this page has: requests them when they are first needed, and again when the run has
// recorded more

/** A segment; `end_s` is the end of the recording when it was last requested. */
/** @typedef {{ frames: Frames | null, end_s: number, isPending: boolean }} Segment */

const MAX_KEPT_SEGMENTS = 60;
const SAME_FRAME_S = 1e-6;

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

/** @type {(level: number, number: number) => string} */
const addressOf = (level, number) => `segments/${level}/${number}`;

/**
 * The place of a moment's frame: its index in a segment of the level that fits a speed. `next` is the segment after
 * that, null where none is recorded.
 * @type {(plan: ReplayPlan, speed: number, time_s: number) => { address: string, next: string | null, index: number }}
 */
export function placeOf(plan, speed, time_s) {
  const { frame_s, segment_frames, lowest_level, highest_level } = plan;
  const level = Math.min(Math.max(Math.round(Math.log2(speed)), lowest_level), highest_level);
  const interval_s = frame_s * 2 ** level;
  // The server has no frame after the end, however close.
  const isRecorded = (/** @type {number} */ frame) => frame * interval_s <= endOf(plan);
  const rounded = Math.floor(time_s / interval_s + SAME_FRAME_S);
  const frame = isRecorded(rounded) ? rounded : rounded - 1;
  const number = Math.floor(frame / segment_frames);
  return {
    address: addressOf(level, number),
    next: isRecorded((number + 1) * segment_frames) ? addressOf(level, number + 1) : null,
    index: frame % segment_frames,
  };
}

export class Segments {
  /**
   * @param {(address: string) => Promise<Frames>} load
   * @param {(error: unknown, again: () => void) => void} refuse takes an error, and lets the request be made again
   */
  constructor(load, refuse) {
    this.load = load;
    this.refuse = refuse;
    /** Those that were needed last come last. @type {Map<string, Segment>} */
    this.kept = new Map();
  }

  /** Forget all; answers that are still to come are ignored. */
  clear() {
    this.kept.clear();
  }

  /**
   * The frames of a segment that are here; null before the first answer.
   * @param {string} address
   * @param {number} most frames that a segment can have
   * @param {number} end_s of what is recorded
   */
  get(address, most, end_s) {
    const segment = this.kept.get(address) ?? { frames: null, end_s: -Infinity, isPending: false };
    this.kept.delete(address);
    this.kept.set(address, segment);
    for (const oldest of this.kept.keys()) {
      if (this.kept.size <= MAX_KEPT_SEGMENTS) break;
      this.kept.delete(oldest);
    }
    const isWhole = (segment.frames?.frames.length ?? 0) >= most;
    if (!isWhole && !segment.isPending && segment.end_s < end_s) this.request(address, segment, end_s);
    return segment.frames;
  }

  /**
   * @private
   * @type {(address: string, segment: Segment, end_s: number) => Promise<void>}
   */
  async request(address, segment, end_s) {
    segment.isPending = true;
    try {
      segment.frames = await this.load(address);
      segment.end_s = end_s;
      segment.isPending = false;
    } catch (error) {
      if (this.kept.get(address) === segment) this.refuse(error, () => (segment.isPending = false));
    }
  }
}
