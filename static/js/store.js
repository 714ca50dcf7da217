// The server's state as signals. Written by the events of its stream, and by answers to requests that no event has
// overtaken.
import { batch, computed, effect, signal } from "@preact/signals";
import { addressOf, getOptions, RequestError } from "./api.js";
import { options } from "./settings.js";

/** @import { Signal } from "@preact/signals" */
/** @import { DamagedRun, Evaluation, EventBodies, Rates, Run, Scene, Stage } from "./types.js" */

export { options, served } from "./settings.js";

/** @type {Signal<"connecting" | "live" | "reconnecting">} */
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
export const commonStage = signal(null);
/** Its moment, updated about five times a second. @type {Signal<Scene | null>} */
const commonScene = signal(null);
/** The page's own stage while it plays a run by itself, shaped as the common one. @type {Signal<Stage | null>} */
export const ownStage = signal(null);
/** @type {Signal<Scene | null>} */
export const ownScene = signal(null);
/** The stage of this page: its own, or else the common one. */
export const stage = computed(() => ownStage.value ?? commonStage.value);
/** The moment that this page shows; null while its own replay has none yet. */
export const scene = computed(() => (ownStage.value ? ownScene.value : commonScene.value));
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

/** Those of features are added to them. @type {{ [Name in keyof EventBodies]?: (data: EventBodies[Name]) => void }} */
const handlers = {
  snapshot(data) {
    // It tells of the stage and of the newest runs; an answer about an older run is still news.
    newestEvents.set("stage", eventCount);
    for (const { id } of data.runs ?? []) newestEvents.set(id, eventCount);
    version.value = data.version ?? null;
    role.value = data.role ?? "operator";
    viewers.value = data.viewers ?? null;
    robotsVersion.value = data.robots_version ?? 0;
    runs.value = new Map();
    damagedRuns.value = new Map();
    rates.value = {};
    (data.runs ?? []).forEach(upsertRun);
    commonStage.value = data.stage ?? null;
    commonScene.value = data.scene ?? null;
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
    commonStage.value = data;
  },
  viewers: (data) => (viewers.value = data.count),
  robots: (data) => (robotsVersion.value = data.version),
  scene: (data) => (commonScene.value = data),
};

/** The names of the events that are applied. */
export const eventNames = () => Object.keys(handlers);

/** Apply events of a feature, too. @param {Record<string, (data: any) => void>} more handlers by the events' names */
export const addHandlers = (more) => { Object.assign(handlers, more); };

/**
 * Apply a server-sent event. Unknown names are ignored.
 * @param {string} name
 * @param {unknown} data
 */
export const applyEvent = (name, data) =>
  batch(() => {
    eventCount += 1;
    /** @type {Record<string, (data: unknown) => void>} */ (handlers)[name]?.(data);
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
  if (answer && isNews("stage")) commonStage.value = answer;
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

// ---- the stream of server-sent events

const FIRST_WAIT_MS = 500;
const LONGEST_WAIT_MS = 8000;

/**
 * Open the stream, and open it again after every break with exponential back-off.
 * @param {string[]} names of events that are wanted
 * @param {(name: string, data: any) => void} onEvent
 * @param {(state: "connecting" | "live" | "reconnecting") => void} onState
 * @param {string} [address] of the stream; that of the page's own stage without one
 * @returns {() => void} closes it for good
 */
export function openEvents(names, onEvent, onState, address = addressOf("events")) {
  /** @type {EventSource | null} */
  let source = null;
  let wait = FIRST_WAIT_MS;
  /** @type {ReturnType<typeof setTimeout> | undefined} */
  let timer;

  const open = () => {
    clearTimeout(timer);
    source?.close();
    const opened = new EventSource(address);
    source = opened;
    for (const name of names) {
      opened.addEventListener(name, ({ data }) => {
        if (name === "snapshot") {
          wait = FIRST_WAIT_MS;
          onState("live");
        }
        onEvent(name, JSON.parse(data));
      });
    }
    opened.onerror = () => {
      // The browser's own retry gives up on some answers.
      opened.close();
      onState("reconnecting");
      timer = setTimeout(open, wait);
      wait = Math.min(2 * wait, LONGEST_WAIT_MS);
    };
  };

  let isOver = false;
  const openNow = () => {
    if (!isOver && source?.readyState === EventSource.CLOSED) open();
  };
  addEventListener("online", openNow);
  document.addEventListener("visibilitychange", () => {
    if (!document.hidden) openNow();
  });
  onState("connecting");
  open();
  return () => {
    isOver = true;
    clearTimeout(timer);
    source?.close();
  };
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
