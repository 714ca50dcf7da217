// The server's state as signals. Written by the events of its stream, and by answers to requests that no event has
// overtaken.
import { batch, computed, effect, signal } from "@preact/signals";
import { getOptions, RequestError } from "./api.js";
import { ServerClock } from "./events.js";
import { page } from "./page-state.js";
import { options } from "./settings.js";

/** @import { Signal } from "@preact/signals" */
/** @import { Connection } from "./events.js" */
/** @import { DamagedRun, Evaluation, EventBodies, Playhead, Rates, Run, Scene, Stage } from "./types.js" */

export { options, served } from "./settings.js";

/** @type {Signal<Connection>} */
export const connection = signal("connecting");
/** Whether the server is not heard: all that is known is what was heard last. */
export const isAway = computed(() => connection.value === "reconnecting");
/** The server's version. @type {Signal<string | null>} */
export const version = signal(null);
/** Whether the server refuses this page because it lacks the link's token. */
export const isLockedOut = signal(false);
/** Null until the first snapshot. @type {Signal<NonNullable<EventBodies["snapshot"]["role"]> | null>} */
export const role = signal(null);
/** Number of pages that watch the stage. @type {Signal<number | null>} */
export const viewers = signal(null);
/** Of the stored robots, which the options have. */
export const robotsVersion = signal(0);
/** Every known run by id. @type {Signal<Map<string, Run>>} */
export const runs = signal(new Map());
/** Runs that the server cannot read, by id: listed, and can be deleted. @type {Signal<Map<string, DamagedRun>>} */
export const damagedRuns = signal(new Map());
/** The stage that all pages share, as GET /stage has it. @type {Signal<Stage | null>} */
export const stage = signal(null);
/** Where its picture is: the newest that was told. @type {Signal<Playhead | null>} */
export const playhead = signal(null);
/** The frames of the stage that were pushed last. @type {Signal<EventBodies["piece"] | null>} */
export const newestPiece = signal(null);
/** The moment that this page shows, of the stage or of its own replay: several times a second. */
/** @type {Signal<Scene | null>} */
export const scene = signal(null);
/** The clock by which the playhead moves. */
export const serverClock = new ServerClock();
/** Run id → evaluations received while the page was open. @type {Signal<Record<string, Evaluation[]>>} */
export const evaluations = signal({});
/** Run id → greedy's distance on the same robot [m]. @type {Signal<Record<string, number>>} */
export const references = signal({});
/**
 * Run id → the best known distance in the same world [m], null where there is none.
 * @type {Signal<Record<string, number | null>>}
 */
export const bestKnown = signal({});
/**
 * Run id → the pace and the live settings that were changed since the snapshot; earlier changes are in the run.
 * @type {Signal<Record<string, Rates>>}
 */
export const rates = signal({});

/**
 * Set one entry of a record in a signal.
 * @template Value
 * @param {Signal<Record<string, Value>>} record
 * @param {string} key
 * @param {Value} value
 */
export const setEntry = (record, key, value) => {
  record.value = { ...record.value, [key]: value };
};

/** Number of events received. */
let eventCount = 0;
/** Run id, or "stage" → the number of its newest event. @type {Map<string, number>} */
const newestEvents = new Map();
/** Ids of runs that were deleted while the page was open, or of which the server has said that there is none. */
const goneIds = signal(/** @type {Set<string>} */ (new Set()));

/** Whether there is no such run, or none any more. @param {string} id */
export const isGone = (id) => goneIds.value.has(id);

/** Those of features are added to them. */
/** @type {{ [Name in keyof EventBodies]?: (data: EventBodies[Name], isContinued: boolean) => void }} */
const handlers = {
  snapshot(data, isContinued) {
    // It tells of the stage and of the newest runs; an answer about an older run is still news.
    newestEvents.set("stage", eventCount);
    for (const { id } of data.runs ?? []) newestEvents.set(id, eventCount);
    version.value = data.version ?? null;
    role.value = data.role ?? "operator";
    viewers.value = data.viewers ?? null;
    robotsVersion.value = data.robots_version ?? 0;
    forgetRuns(data.runs ?? [], isContinued);
    rates.value = {};
    (data.runs ?? []).forEach(upsertRun);
    stage.value = data.stage ?? null;
    playhead.value = null;
    if (data.stage) takePlayhead(data.stage, true);
    // What a replay of this page's own shows is not the stage's.
    if (page.run.peek() === null) scene.value = data.scene ?? null;
  },
  run(data) {
    newestEvents.set(data.id, eventCount);
    // A deleted run may have been imported again.
    if (goneIds.peek().has(data.id)) goneIds.value = new Set([...goneIds.peek()].filter((id) => id !== data.id));
    upsertRun(data);
  },
  "run-deleted"({ id }) {
    newestEvents.set(id, eventCount);
    markGone(id);
  },
  evaluation({ run_id, ...evaluation }) {
    setEntry(evaluations, run_id, [...(evaluations.value[run_id] ?? []), evaluation]);
  },
  reference({ run_id, greedy_distance_m, best_known_m }) {
    setEntry(references, run_id, greedy_distance_m);
    setEntry(bestKnown, run_id, best_known_m);
  },
  rates: ({ run_id, step: _, settings = {}, ...pace }) =>
    setEntry(rates, run_id, { ...rates.value[run_id], ...settings, ...pace }),
  stage(data) {
    newestEvents.set("stage", eventCount);
    stage.value = data;
    takePlayhead(data);
  },
  piece(data) {
    takePlayhead(data);
    newestPiece.value = data;
  },
  clock: ({ sent_s }) => serverClock.note(sent_s, performance.now() / 1000),
  viewers: (data) => (viewers.value = data.count),
  robots: (data) => (robotsVersion.value = data.version),
};

/** When the newest playhead was told [s of the server's clock]. */
let playheadSent_s = -Infinity;

/**
 * Take where the picture of the stage is, unless something newer has told of it, and the server's clock.
 * @param {{ sent_s: number, playhead: Playhead }} message
 * @param {boolean} [isFirst] whether the server may have been started anew since the message before
 */
function takePlayhead({ sent_s, playhead: newest }, isFirst = false) {
  serverClock.note(sent_s, performance.now() / 1000, isFirst);
  if (!isFirst && sent_s < playheadSent_s) return;
  playheadSent_s = sent_s;
  playhead.value = newest;
}

/**
 * Forget the runs that a snapshot replaces: all, or while the connection has held those that are not older than its.
 * @param {{ id: string }[]} newest
 * @param {boolean} isContinued
 */
function forgetRuns(newest, isContinued) {
  // Ids sort by the time of creation; of older runs a snapshot does not tell.
  const oldest = newest.map(({ id }) => id).sort()[0] ?? "";
  const isKept = (/** @type {[string, unknown]} */ [id]) => isContinued && id < oldest;
  runs.value = new Map([...runs.peek()].filter(isKept));
  damagedRuns.value = new Map([...damagedRuns.peek()].filter(isKept));
}

/** The names of the events that are applied. */
export const eventNames = () => Object.keys(handlers);

/** Apply events of a feature, too. @param {Record<string, (data: any) => void>} more handlers by the events' names */
export const addHandlers = (more) => { Object.assign(handlers, more); };

/**
 * Apply a server-sent event. Unknown names are ignored.
 * @param {string} name
 * @param {unknown} data
 * @param {boolean} [isContinued] of a snapshot, whether the connection has held since the one before
 */
export const applyEvent = (name, data, isContinued = false) =>
  batch(() => {
    eventCount += 1;
    /** @type {Record<string, (data: unknown, isContinued: boolean) => void>} */ (handlers)[name]?.(data, isContinued);
  });

/**
 * Perform a request, and tell what of its answer is still news: an answer can arrive after the events of
 * what happened since it was written, and must not undo them.
 * @template Answer
 * @param {() => Promise<Answer>} send
 * @returns {Promise<{ answer: Answer, isNews: (key: string) => boolean }>}
 */
async function perform(send) {
  const sent = eventCount;
  const answer = await send();
  return { answer, isNews: (key) => (newestEvents.get(key) ?? 0) <= sent };
}

/**
 * Take in the run that a request answers with, if any, unless an event has told of it since.
 * @template {Run | DamagedRun | null} Answer
 * @param {() => Promise<Answer>} send
 */
export async function requestRun(send) {
  const { answer, isNews } = await perform(send);
  if (answer?.id && isNews(answer.id)) upsertRun(answer);
  return answer;
}

/**
 * Take in the runs of a page of a list, except those that an event has told of since.
 * @template {{ items: (Run | DamagedRun)[] }} Answer
 * @param {() => Promise<Answer>} send
 */
export async function requestRuns(send) {
  const { answer, isNews } = await perform(send);
  batch(() => answer.items.filter(({ id }) => isNews(id)).forEach(upsertRun));
  return answer;
}

/**
 * Take in the stage that a request answers with, unless an event has told of it since.
 * @param {() => Promise<Stage | null>} send
 */
export async function requestStage(send) {
  const { answer, isNews } = await perform(send);
  if (!answer || !isNews("stage")) return;
  batch(() => {
    stage.value = answer;
    takePlayhead(answer);
  });
}

/**
 * Insert a run, or replace the version that is known.
 * @param {Run | EventBodies["run"]} run
 */
const upsertRun = (run) =>
  batch(() => {
    forgetRun(run.id);
    if ("damaged" in run) damagedRuns.value = new Map(damagedRuns.value).set(run.id, run);
    else runs.value = new Map(runs.value).set(run.id, /** @type {Run} */ (run));
  });

/**
 * Remove a run that was deleted, or that there is not, and request it no more.
 * @param {string} id
 */
export const markGone = (id) => batch(() => {
  goneIds.value = new Set(goneIds.peek()).add(id);
  forgetRun(id);
});

/** @param {string} id */
const forgetRun = (id) =>
  batch(() => {
    if (runs.value.has(id)) runs.value = without(runs.value, id);
    if (damagedRuns.value.has(id)) damagedRuns.value = without(damagedRuns.value, id);
  });

/**
 * @template Value
 * @param {Map<string, Value>} map
 * @param {string} key
 */
function without(map, key) {
  const left = new Map(map);
  left.delete(key);
  return left;
}

// ---- the options of all forms: asked for until they come, and again when stored robots have changed since

const FIRST_RETRY_MS = 500;
const LONGEST_RETRY_MS = 8000;

/** @param {unknown} error */
export const isLockOut = (error) => error instanceof RequestError && (error.status === 401 || error.status === 403);

/** Whether the options are missing, or older than the stored robots. */
const isOutdated = () => (options.value?.robots_version ?? -1) < robotsVersion.value;

/**
 * Load the options, and keep them up to date.
 * @param {() => void} whenFirst called once they are there
 */
export function followOptions(whenFirst) {
  const isLoading = signal(false);
  /** An answer that was written before the robots changed counts as a failed attempt. */
  const load = async (attempt = 0) => {
    isLoading.value = true;
    const isFirst = options.peek() === null;
    try {
      options.value = await getOptions();
      isLockedOut.value = false;
    } catch (error) {
      isLockedOut.value = isLockOut(error);
    }
    if (isFirst && options.peek() !== null) whenFirst();
    if (isOutdated()) setTimeout(load, Math.min(FIRST_RETRY_MS * 2 ** attempt, LONGEST_RETRY_MS), attempt + 1);
    else isLoading.value = false;
  };
  effect(() => {
    if (isOutdated() && !isLoading.value) load();
  });
}
