// The segments of a replay that this page has: requests them when they are first needed, and again when the run has
// recorded more.

/** @import { Frames } from "./replay-frames.js" */

/** A segment; `end_s` is the end of the recording when it was last requested. */
/** @typedef {{ frames: Frames | null, end_s: number, isPending: boolean }} Segment */

const KEPT_SEGMENTS = 60;

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
