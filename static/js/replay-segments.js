// The segments of a replay that this page has: requests them when they are first needed, and again when the run has
// recorded more.

/** @import { Frames } from "./replay-frames.js" */
/** @import { ReplayPlan } from "./types.js" */

/** A segment; `end_s` is the end of the recording when it was last requested. */
/** @typedef {{ frames: Frames | null, end_s: number, isPending: boolean }} Segment */

const KEPT_SEGMENTS = 60;
const SAME_S = 1e-6;

/** The last moment that is recorded [s]. @param {ReplayPlan} plan */
export const endOf = ({ recorded_s }) => recorded_s.at(-1)?.[1] ?? 0;

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
  const rounded = Math.floor(time_s / interval_s + SAME_S);
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
      if (this.kept.size <= KEPT_SEGMENTS) break;
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
