// The stream of server-sent events: opened again after every break, and made up for by asking for snapshots where it
// does not come through. And the server's clock, by the time stamps of what it sends.
import { effect, signal, untracked } from "@preact/signals";

// ---- the server's clock

const CLOCK_WINDOW_S = 60;
/** A greater step of the clock is that of another process: the server was started anew. */
const OTHER_CLOCK_S = 2;

/**
 * The clock of the server as this page can know it. A message can only be late, so that its clock is ahead of this
 * page's by the most that any message of the last minute says.
 */
export class ServerClock {
  constructor() {
    /** Messages that are less late than all that came after them. @type {{ at_s: number, delay_s: number }[]} */
    this.delays = [];
  }

  /**
   * Take the time stamp of a message.
   * @param {number} sent_s by the server's clock [s]
   * @param {number} now_s by this page's [s]
   * @param {boolean} [isFirst] whether it may be that of another process than the messages before
   */
  note(sent_s, now_s, isFirst = false) {
    const delay_s = now_s - sent_s;
    if (isFirst && delay_s - (this.delays[0]?.delay_s ?? delay_s) > OTHER_CLOCK_S) this.delays = [];
    this.delays = this.delays.filter(({ at_s, delay_s: other }) => now_s - at_s < CLOCK_WINDOW_S && other < delay_s);
    this.delays.push({ at_s: now_s, delay_s });
  }

  /** The server's time at a time of this page's clock [s]. @param {number} now_s */
  at(now_s) {
    return now_s - (this.delays[0]?.delay_s ?? 0);
  }
}

// ---- the stream

const FIRST_WAIT_MS = 500;
const LONGEST_WAIT_MS = 8000;
/** A stream that brings nothing for so long is closed: at first, and later, when the server sends its clock. */
const FIRST_SILENCE_MS = 4000;
const LONGEST_SILENCE_MS = 25_000;
const POLL_MS = 2000;
/** How often it is looked whether the page has slept; nothing heard for so long is no pause of the server's. */
const [BEAT_MS, GAP_MS] = [1000, 15_000];
/** A stream that is held back is tried so seldom, as the server goes on to write into it. */
const LONGEST_HELD_BACK_MS = 60_000;

/** Whether streams do not come through the network, though answers do: the page asks every POLL_MS. */
export const isPolling = signal(false);

/** @typedef {"connecting" | "live" | "reconnecting"} Connection */
/** @typedef {ReturnType<typeof setTimeout> | undefined} Timer */
/**
 * Takes an event. `isContinued`: of a snapshot, whether the connection has held since the one before.
 * @typedef {(name: string, data: any, isContinued: boolean) => void} OnEvent
 */

/** A stream that is opened again after every break, and what is asked for meanwhile. */
class Stream {
  /**
   * @param {string[]} names of events that are wanted
   * @param {OnEvent} onEvent
   * @param {(state: Connection) => void} onState
   */
  constructor(names, onEvent, onState) {
    this.names = names;
    this.onEvent = onEvent;
    this.onState = onState;
    this.address = "";
    /** Address of the snapshot with which the stream would begin. */
    this.snapshot = "";
    /** @type {EventSource | null} */
    this.source = null;
    this.wait_ms = FIRST_WAIT_MS;
    /** When the stream is opened again, is given up, and is made up for. @type {Record<string, Timer>} */
    this.timers = {};
    /** Counts the polls: the answer of one that was given up is late. */
    this.polls = 0;
    this.isPolling = false;
    this.isLive = false;
    /** Whether the newest stream has brought nothing at all. */
    this.isMute = false;
    /** When something was heard last, by the clock that goes on while a machine sleeps [ms]. */
    this.heardAt = Date.now();
  }

  open() {
    this.close();
    const source = new EventSource(this.address);
    this.source = source;
    this.expectWithin(FIRST_SILENCE_MS, true);
    for (const name of this.names) {
      source.addEventListener(name, ({ data }) => {
        if (source === this.source) this.take(name, JSON.parse(data));
      });
    }
    // The browser's own retry gives up on some answers.
    source.onerror = () => source === this.source && this.lose();
  }

  /** @param {string} name @param {any} data */
  take(name, data) {
    // What comes after a sleep was sent before it, or while the page could not hear.
    if (name !== "snapshot" && this.hasGap()) {
      this.renew();
      return;
    }
    this.heardAt = Date.now();
    this.isMute = false;
    this.expectWithin(LONGEST_SILENCE_MS, false);
    this.onEvent(name, data, this.isLive);
    if (name !== "snapshot") return;
    this.wait_ms = FIRST_WAIT_MS;
    this.stopPolling();
    this.tell(true);
  }

  /** @param {boolean} isLive */
  tell(isLive) {
    this.isLive = isLive;
    isPolling.value = isLive && this.isMute;
    this.onState(isLive ? "live" : "reconnecting");
  }

  /** Give the stream up where it brings nothing for so long. @param {number} most_ms @param {boolean} isMute */
  expectWithin(most_ms, isMute) {
    clearTimeout(this.timers.silence);
    this.timers.silence = setTimeout(() => {
      this.isMute = isMute;
      this.lose();
    }, most_ms);
  }

  /** Whether nothing was heard for longer than a server is silent. */
  hasGap() {
    return Date.now() - this.heardAt > GAP_MS;
  }

  /** Open the stream at once, and ask for what it would begin with: the page has slept, or the network is another. */
  renew() {
    this.heardAt = Date.now();
    this.wait_ms = FIRST_WAIT_MS;
    this.tell(false);
    this.open();
    clearTimeout(this.timers.polling);
    this.poll();
  }

  close() {
    clearTimeout(this.timers.silence);
    clearTimeout(this.timers.opening);
    this.source?.close();
    this.source = null;
  }

  lose() {
    this.close();
    this.timers.opening = setTimeout(() => this.open(), this.wait_ms);
    this.wait_ms = Math.min(2 * this.wait_ms, this.isMute ? LONGEST_HELD_BACK_MS : LONGEST_WAIT_MS);
    if (!this.isPolling) this.poll();
  }

  async poll() {
    this.isPolling = true;
    this.polls += 1;
    const number = this.polls;
    const data = await read(this.snapshot);
    if (number !== this.polls) return;
    this.timers.polling = setTimeout(() => this.poll(), POLL_MS);
    if (data !== null) {
      this.heardAt = Date.now();
      this.onEvent("snapshot", data, this.isLive);
    }
    this.tell(data !== null);
  }

  stopPolling() {
    this.isPolling = false;
    this.polls += 1;
    clearTimeout(this.timers.polling);
  }
}

/**
 * Open the stream, and open it again after every break with exponential back-off. Meanwhile snapshots are asked for;
 * while they come the connection is live.
 * @param {string[]} names of events that are wanted
 * @param {OnEvent} onEvent
 * @param {(state: Connection) => void} onState
 * @param {() => { stream: string, snapshot: string }} addresses of the stream, and of the snapshot with which it would
 *   begin; reads signals, and where they change another stream takes its place
 * @returns {() => void} closes it for good
 */
export function openEvents(names, onEvent, onState, addresses) {
  const stream = new Stream(names, onEvent, onState);
  onState("connecting");
  const stop = effect(() => {
    ({ stream: stream.address, snapshot: stream.snapshot } = addresses());
    untracked(() => stream.open());
  });
  let isOver = false;
  const renew = () => isOver || stream.renew();
  const wake = () => {
    const isLost = stream.source === null && !stream.isLive;
    if (!document.hidden && (isLost || stream.hasGap())) renew();
  };
  addEventListener("online", renew);
  addEventListener("pageshow", wake);
  document.addEventListener("resume", wake);
  document.addEventListener("visibilitychange", wake);
  // A machine that sleeps with the page in view tells nothing of it.
  let beatAt = Date.now();
  const beat = setInterval(() => {
    const before = beatAt;
    beatAt = Date.now();
    if (beatAt - before > GAP_MS) wake();
  }, BEAT_MS);
  return () => {
    isOver = true;
    clearInterval(beat);
    stop();
    stream.close();
    stream.stopPolling();
  };
}

/** A snapshot; null if it cannot be had. @param {string} address */
async function read(address) {
  try {
    const answer = await fetch(address, { signal: AbortSignal.timeout(FIRST_SILENCE_MS) });
    return answer.ok ? await answer.json() : null;
  } catch {
    return null;
  }
}
