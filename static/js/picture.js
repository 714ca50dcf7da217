// The picture of a run: keeps the frames that have come, requests those that lack, and sends the 3D view what it needs
// to be at a moment.
import { signal } from "@preact/signals";
import { getReplayFrames, getStartLine } from "./api.js";
import { decode, Follower, SceneState } from "./replay-frames.js";

/** @import { Frame, Frames, Message } from "./replay-frames.js" */
/** @import { Clock } from "./types.js" */

// ---- frames. At level 0 there are FRAMES_PER_S in a second of the run's time, at each level above half as many, as
// hexapods/shows/replay.py has them

const FRAMES_PER_S = 30;
const SEGMENT_FRAMES = 64;
const [LOWEST_LEVEL, HIGHEST_LEVEL] = [-3, 7];
const SLOWEST = 1e-3;
const MAX_KEPT_PIECES = 60;
const MAX_KEPT_MOMENTS = 8;
const SAME_FRAME_S = 1e-6;
/** Times are told in a ten thousandth of a second. */
const SAME_TIME_S = 2e-4;

/**
 * Consecutive frames of a level, the first of which has the number `first`. `isSegment`: this page has requested them,
 * of a run that is computed perhaps before it had them all; else the stage has pushed them.
 * @typedef {{ level: number, first: number, frames: Frame[], isSegment: boolean }} Piece
 */
/** A frame that is here; `isExact`: it is that of the very moment. */
/** @typedef {{ piece: Piece, index: number, isExact: boolean }} Place */
/** The frame that is nearest to a time [s]. @typedef {{ time_s: number, frame: Frame }} Exact */

/** The level with about FRAMES_PER_S frames in a second of the picture. @param {number} rate its speed */
const levelOf = (rate) =>
  Math.min(Math.max(Math.round(Math.log2(Math.max(rate, SLOWEST))), LOWEST_LEVEL), HIGHEST_LEVEL);

/**
 * The number of a moment's frame. The server has no frame after the end, however close.
 * @type {(level: number, time_s: number, end_s: number) => number}
 */
function numberOf(level, time_s, end_s) {
  const interval_s = 2 ** level / FRAMES_PER_S;
  const number = Math.floor(time_s / interval_s + SAME_FRAME_S);
  return number > 0 && number * interval_s > end_s ? number - 1 : number;
}

/** @typedef {(address: string, query?: Record<string, string>) => Promise<Frames>} Request of frames of a run */
/** Requests frames of a run; without one the start line, which is a scene alone. */
/** @type {(id: string | null, ghost: string | null) => Request} */
export const requestOf = (id, ghost) => async (address, query = {}) => {
  if (id === null) return decode(await getStartLine());
  return decode(await getReplayFrames(id, address, { ...query, ...(ghost === null ? {} : { ghost }) }));
};
/** Takes an error, and lets the request be made again. @typedef {(error: unknown, again: () => void) => void} Refuse */

/** The frames of a version of a run under a clock, and the scene on which they are based. */
class Edition {
  /** @param {Request} request @param {Refuse} refuse @param {Clock} clock @param {string | null} version */
  constructor(request, refuse, clock, version) {
    this.request = request;
    this.refuse = refuse;
    this.clock = clock;
    this.version = version;
    /** @type {Frames | null} */
    this.scene = null;
    /** Those that were shown last come last. @type {Piece[]} */
    this.pieces = [];
    /** @type {Exact[]} */
    this.moments = [];
    /** Address of a segment → where the recording ended when it was requested. @type {Map<string, number>} */
    this.ends = new Map();
    /** Addresses of what is requested, or not to be requested again yet. @type {Set<string>} */
    this.pending = new Set();
  }

  /** @param {Piece} piece */
  put(piece) {
    const isOther = (/** @type {Piece} */ { level, first, frames }) =>
      level !== piece.level || first !== piece.first || frames.length > piece.frames.length;
    this.pieces = [...this.pieces.filter(isOther), piece].slice(-MAX_KEPT_PIECES);
  }

  /** @param {Exact} moment */
  putMoment(moment) {
    this.moments = [...this.moments, moment].slice(-MAX_KEPT_MOMENTS);
  }

  /** The frame of the very moment; null if it is not here. @param {number} time_s */
  exactly(time_s) {
    const isAt = (/** @type {number} */ other) => Math.abs(other - time_s) < SAME_TIME_S;
    return this.moments.findLast((moment) => isAt(moment.time_s) || isAt(moment.frame.time_s)) ?? null;
  }

  /**
   * The frame of a moment, of the level that fits a speed best; else the last one of its segment that is here.
   * @type {(time_s: number, rate: number, end_s: number) => Place | null}
   */
  at(time_s, rate, end_s) {
    const fit = Math.log2(Math.max(rate, SLOWEST));
    const candidates = this.pieces
      .map((piece) => ({ piece, index: numberOf(piece.level, time_s, end_s) - piece.first }))
      .filter(({ piece, index }) => index >= 0 && index < (piece.isSegment ? SEGMENT_FRAMES : piece.frames.length))
      .sort((a, b) => Math.abs(a.piece.level - fit) - Math.abs(b.piece.level - fit));
    const best = candidates.find(({ piece, index }) => index < piece.frames.length) ?? candidates[0];
    return best ? { ...best, index: Math.min(best.index, best.piece.frames.length - 1), isExact: false } : null;
  }

  /**
   * Whether the frame of a moment is here: one that was pushed, or one of the level that fits the speed.
   * @type {(time_s: number, rate: number, end_s: number) => boolean}
   */
  has(time_s, rate, end_s) {
    const level = levelOf(rate);
    return this.pieces.some((piece) => {
      const index = numberOf(piece.level, time_s, end_s) - piece.first;
      return (!piece.isSegment || piece.level === level) && index >= 0 && index < piece.frames.length;
    });
  }

  /** Keep a piece longest, as it is shown. @param {Piece} piece */
  use(piece) {
    if (this.pieces.at(-1) !== piece) this.pieces = [...this.pieces.filter((other) => other !== piece), piece];
  }

  /** Request the scene. */
  requestScene() {
    this.load("scene", {}, (scene) => (this.scene = scene));
  }

  /**
   * Request the segment of a moment, unless all that is recorded of it is here.
   * @type {(time_s: number, rate: number, end_s: number) => void}
   */
  requestSegment(time_s, rate, end_s) {
    const level = levelOf(rate);
    const number = Math.floor(numberOf(level, time_s, end_s) / SEGMENT_FRAMES);
    const first = SEGMENT_FRAMES * number;
    const address = `segments/${level}/${number}`;
    const isHere = this.pieces.some((piece) => piece.isSegment && piece.level === level && piece.first === first);
    if (isHere && (this.ends.get(address) ?? -Infinity) >= end_s) return;
    const query = { clock: this.clock, ...(this.version === null ? {} : { version: this.version }) };
    this.load(address, query, ({ frames }) => {
      this.ends.set(address, end_s);
      this.put({ level, first, frames, isSegment: true });
    });
  }

  /** Request the very moment; one at a time. @param {number} time_s */
  requestMoment(time_s) {
    const query = { time_s: String(time_s), clock: this.clock };
    this.load("moment", query, ({ frames: [frame] }) => this.putMoment({ time_s, frame }));
  }

  /**
   * @private
   * @type {(address: string, query: Record<string, string>, take: (frames: Frames) => void) => Promise<void>}
   */
  async load(address, query, take) {
    if (this.pending.has(address)) return;
    this.pending.add(address);
    const release = () => this.pending.delete(address);
    try {
      take(await this.request(address, query));
      release();
    } catch (error) {
      this.refuse(error, release);
    }
  }
}

// ---- the 3D view

/** Takes messages for the 3D view. @type {(messages: Message[]) => void} */
let draw = () => {};
/** Of the whole page: a camera that nothing moves stays where it is when another run is shown. */
const follower = new Follower();
/** Counts the scenes that the 3D view has begun. */
export const sceneCount = signal(0);

/** @type {(state: SceneState) => Message} */
const removal = ({ world }) => ({ type: "RemoveSceneNodeMessage", name: world, owner: "" });

// ---- the picture

/** What the stage pushes comes within this time; what has not come by then is requested [ms]. */
const [GRACE_MS, GRACE_OF_MOMENT_MS] = [400, 300];
/** Of a run that is computed pieces come when they are due, and later where the server has more to do than it can. */
const GRACE_OF_GROWING_MS = 1500;
/** The leader is followed smoothly over as much of the picture's time, and to where the picture stops [s]. */
const [LONGEST_STEP_S, LONGEST_STOP_S] = [1, 0.1];

/**
 * What of a run is to be shown: `next_s` is the moment a second later; at the rate 0 it is held. Nothing is recorded
 * after `end_s`, if `isGrowing` not yet.
 * @typedef {{
 *   clock: Clock, version: string | null, time_s: number, rate: number, next_s: number, end_s: number,
 *   isGrowing: boolean,
 * }} Wanted
 */

/** A moment as the only frame of a piece. @type {(exact: Exact) => Place} */
const alone = ({ frame }) =>
  ({ piece: { level: LOWEST_LEVEL, first: 0, frames: [frame], isSegment: false }, index: 0, isExact: true });

const NOTHING = {
  piece: /** @type {Piece | null} */ (null), index: -1, time_s: NaN, frame: /** @type {Frame | null} */ (null),
  figures: /** @type {object | null} */ (null), view: "", isExact: false,
};

export class Picture {
  /**
   * @param {Request} request
   * @param {Refuse} refuse
   * @param {boolean} isPushed whether its frames are expected to come by themselves
   */
  constructor(request, refuse, isPushed) {
    this.request = request;
    this.refuse = refuse;
    this.isPushed = isPushed;
    /** @type {SceneState | null} */
    this.state = null;
    /** The scene as it was when the picture was opened. @type {Frames | null} */
    this.firstScene = null;
    /** By clock and version. @type {Map<string, Edition>} */
    this.editions = new Map();
    /** The one that is shown. @type {Edition | null} */
    this.edition = null;
    /** The newest frame that is drawn, and the view that it is centred for. */
    this.shown = NOTHING;
    /** Since when there is no frame of the moment, and of a second later [ms]. @type {(number | null)[]} */
    this.lacking = [null, null];
  }

  /** Load the scene at the start of the run, and draw it in place of what the 3D view has. */
  async open() {
    this.firstScene = await this.request("scene");
  }

  /** Begin the scene in the 3D view, in place of what it has. @param {string} view */
  begin(view) {
    if (!this.firstScene) return;
    this.state = new SceneState(this.edition?.scene ?? this.firstScene);
    sceneCount.value += 1;
    const [start] = this.firstScene.frames;
    draw([removal(this.state), ...this.state.start, follower.centring(this.state, start, view, Infinity)]);
    this.shown = NOTHING;
  }

  /** The figures of what is drawn, and their time; of a run that has recorded nothing those of its start. */
  /** @param {number} end_s of what is recorded */
  figuresOf(end_s) {
    const { scene } = (this.edition?.scene ?? this.firstScene)?.frames[0] ?? { scene: null };
    return end_s > 0 ? this.shown : { figures: scene, time_s: 0 };
  }

  /** Remove what is drawn. */
  remove() {
    if (this.state) draw([removal(this.state)]);
    this.state = null;
  }

  /** @type {(clock: Clock, version: string | null) => Edition} */
  editionOf(clock, version) {
    const key = `${clock} ${version}`;
    const edition = this.editions.get(key) ?? new Edition(this.request, this.refuse, clock, version);
    this.editions.set(key, edition);
    return edition;
  }

  /**
   * Take frames that the stage has pushed.
   * @type {(clock: Clock, version: string, piece: Omit<Piece, "isSegment">) => void}
   */
  put(clock, version, piece) {
    this.isPushed = true;
    this.editionOf(clock, version).put({ ...piece, isSegment: false });
  }

  /** Request at once what lacks: what the stage has pushed was not heard. */
  expectNothing() {
    this.isPushed = false;
  }

  /** Take a moment that the stage has pushed. @type {(clock: Clock, version: string, exact: Exact) => void} */
  putMoment(clock, version, exact) {
    this.isPushed = true;
    this.editionOf(clock, version).putMoment(exact);
  }

  /**
   * Draw a moment, or what is nearest to it of what is here.
   * @param {Wanted} wanted
   * @param {string} view
   * @param {number} now of the browser's clock [ms]
   * @param {number} elapsed_s since the picture before
   * @returns {boolean} whether its frame is here
   */
  show(wanted, view, now, elapsed_s) {
    const { state } = this;
    if (!state) return false;
    const { time_s, rate, end_s } = wanted;
    const newest = this.editionOf(wanted.clock, wanted.version);
    this.turnTo(newest, wanted, state);
    this.requestMissing(newest, wanted, now);
    const edition = this.edition ?? newest;
    const exact = rate === 0 ? edition.exactly(time_s) : null;
    const place = exact ? alone(exact) : edition.at(time_s, rate, end_s);
    if (!place) return false;
    if (!exact) edition.use(place.piece);
    const step_s = Math.abs(place.piece.frames[place.index].time_s - this.shown.time_s);
    const isNext = step_s < (exact ? LONGEST_STOP_S : LONGEST_STEP_S * Math.max(rate, 1));
    this.drawFrame(state, place, view, isNext ? elapsed_s : Infinity);
    return true;
  }

  /**
   * Show another version, or by another clock, once it can be drawn: the scene on which it is based, and a frame.
   * @private
   * @type {(newest: Edition, wanted: Wanted, state: SceneState) => void}
   */
  turnTo(newest, { time_s, rate, end_s }, state) {
    const before = this.edition;
    if (newest === before) return;
    if (before === null) newest.scene ??= this.firstScene;
    else if (newest.version === before.version) newest.scene ??= before.scene;
    const { scene } = newest;
    if (!scene) {
      newest.requestScene();
      return;
    }
    const isThere = end_s <= 0 || newest.at(time_s, rate, end_s) || (rate === 0 && newest.exactly(time_s));
    if (before !== null && !isThere) return;
    this.edition = newest;
    this.editions = new Map([[`${newest.clock} ${newest.version}`, newest]]);
    this.shown = { ...this.shown, piece: null };
    if (before === null || scene === before.scene) return;
    state.rebase(scene);
    if (end_s <= 0) draw(state.jump([]));
  }

  /**
   * Request what of the moment and of the next second has not come.
   * @private
   * @type {(edition: Edition, wanted: Wanted, now: number) => void}
   */
  requestMissing(edition, { time_s, next_s, rate, end_s, isGrowing }, now) {
    if (end_s <= 0) return;
    const isHeld = rate === 0;
    const grace_ms = isGrowing ? GRACE_OF_GROWING_MS : isHeld ? GRACE_OF_MOMENT_MS : GRACE_MS;
    const isNextDue = !isHeld && !(isGrowing && this.isPushed);
    const isHere = [
      isHeld ? edition.exactly(time_s) !== null : edition.has(time_s, rate, end_s),
      !isNextDue || edition.has(next_s, rate, end_s),
    ];
    this.lacking = this.lacking.map((since, n) => (isHere[n] ? null : since ?? now));
    for (const [n, since] of this.lacking.entries()) {
      if (since === null || (this.isPushed && now - since < grace_ms)) continue;
      if (isHeld) edition.requestMoment(time_s);
      else {
        this.isPushed = false;
        edition.requestSegment(n === 0 ? time_s : next_s, rate, end_s);
      }
    }
  }

  /**
   * @private
   * @type {(state: SceneState, place: Place, view: string, elapsed_s: number) => void}
   */
  drawFrame(state, { piece, index, isExact }, view, elapsed_s) {
    const { frames } = piece;
    const frame = frames[index];
    if (frame === this.shown.frame && this.shown.piece !== null) return;
    const figures = frames.slice(0, index + 1).findLast(({ scene }) => scene)?.scene ?? null;
    // A hidden 3D view draws nothing, and would keep all that it is told.
    if (document.hidden) {
      this.shown = { ...NOTHING, time_s: frame.time_s, frame, figures, isExact };
      return;
    }
    const before = this.shown.piece?.frames === frames ? this.shown.index : -1;
    draw([...state.showFrame(frames, index, before), follower.centring(state, frame, view, elapsed_s)]);
    this.shown = { piece, index, time_s: frame.time_s, frame, figures, view, isExact };
  }

  /** Centre what is drawn for another view. @param {string} view */
  centreFor(view) {
    const { frame } = this.shown;
    if (!this.state || !frame || this.shown.view === view || document.hidden) return;
    draw([follower.centring(this.state, frame, view, Infinity)]);
    this.shown = { ...this.shown, view };
  }
}

/** Take the 3D view in which to draw. @param {(messages: Message[]) => void} take */
export const drawWith = (take) => (draw = take);
