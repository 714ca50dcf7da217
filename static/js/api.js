// Client of the server: its REST API, one function per request.
import { computed, effect, untracked } from "@preact/signals";
import { inWords, languageHeader, said, t } from "./format.js";

/** @import { Signal } from "@preact/signals" */
/** @import { Annotations, Curve, Curves, Disturbance } from "./types.js" */
/** @import { Kind, Options } from "./types.js" */
/** @import { Page, Preview, Rates, ReplayPlan, Run, Stage } from "./types.js" */
/** @import { Timeline, Verb } from "./types.js" */

/**
 * Where the stage is, relative to the page: all that it asks for is below, which tells the stage that it is about.
 * A page that is elsewhere says so in its HTML.
 */
export const root = () => document.documentElement.dataset.root ?? "";
const base = () => new URL(`${root()}api/v1/`, document.baseURI);

/** Where something is that the browser loads by itself. @param {string} path of the API */
export const addressOf = (path) => new URL(path, base()).href;
/** Where something of a room's stage is. @param {string} code @param {string} path of the API */
export const roomAddressOf = (code, path) =>
  new URL(`${root()}r/${encodeURIComponent(code)}/api/v1/${path}`, document.baseURI).href;

/** A run, or enough of one to address it. @typedef {{ kind: Kind | null, id: string }} RunKey */
/** An entry of a problem document. @typedef {{ field?: string, loc?: string[], pointer?: string }} FieldError */
/**
 * @typedef {{ title?: string, detail?: string, errors?: FieldError[], field?: string, legs?: number[] }}
 *   ProblemDocument
 */

/**
 * A failed request. `message` is a sentence in which fields have the names of the API (`messageOf` gives those of the
 * form); `fields` names the ones that it is about.
 */
export class RequestError extends Error {
  /**
   * @param {string} message
   * @param {number} status HTTP status; 0 where no answer came
   * @param {string[]} fields
   * @param {number[]} legs of a robot that cannot be so
   */
  constructor(message, status = 0, fields = [], legs = []) {
    super(message);
    this.status = status;
    this.fields = fields;
    this.legs = legs;
    /** After how long the same request may be made again [s]; null where that is not told. @type {number | null} */
    this.retry_s = null;
  }
}

const LASTING = [403, 404, 409, 410, 422];

/** Whether a request would be refused again. @param {RequestError} error */
export const isLasting = ({ status }) => LASTING.includes(status);

/** After so long the server is asked again for an answer that takes it long to prepare. */
export const AGAIN_MS = 1000;
const TOO_EARLY = 429;

/** Whether the server needs longer for an answer. @param {RequestError} error */
export const needsLonger = ({ status }) => status === TOO_EARLY;

/**
 * Ask, and again while the server needs longer; null once the answer is wanted no more.
 * @template Answer
 * @param {() => Promise<Answer>} ask
 * @param {() => boolean} isWanted
 * @returns {Promise<Answer | null>}
 */
export async function patiently(ask, isWanted) {
  if (!isWanted()) return null;
  try {
    return await ask();
  } catch (error) {
    if (!needsLonger(/** @type {RequestError} */ (error))) throw error;
  }
  await new Promise((resolve) => {
    setTimeout(resolve, AGAIN_MS);
  });
  return patiently(ask, isWanted);
}

/**
 * Keep an answer to the newest question: one request at a time, then always for the newest key, and again after an
 * error that may pass; until the function that is returned is called.
 * @param {object} question
 * @param {() => string} question.key reads signals; "" where nothing is wanted
 * @param {(key: string) => Promise<void>} question.ask keeps the answer, or the error, and throws that
 * @param {() => void} [question.forget] the answer: nothing is wanted any more
 * @param {() => number} question.pause_ms after an answer
 */
export function askForNewest({ key, ask, forget = () => {}, pause_ms }) {
  const wanted = computed(key);
  /** The key of what is known; null after an error that may pass. @type {string | null} */
  let answered = "";
  let [isBusy, isOver] = [false, false];

  /** @param {string} now */
  async function send(now) {
    isBusy = true;
    try {
      await ask(now);
      answered = now;
    } catch (failure) {
      answered = isLasting(/** @type {RequestError} */ (failure)) ? now : null;
    }
    setTimeout(() => {
      isBusy = false;
      look();
    }, Math.max(answered === null ? AGAIN_MS : 0, pause_ms()));
  }

  function look() {
    const now = wanted.peek();
    if (isBusy || isOver || now === answered) return;
    if (now) {
      send(now);
      return;
    }
    answered = "";
    forget();
  }

  const stop = effect(() => {
    if (wanted.value !== answered) untracked(look);
  });
  return () => {
    isOver = true;
    stop();
  };
}

/**
 * The server's reply to the newest question. `again`: the server needs longer, and is asked again.
 * @template Answer
 * @typedef {{ answer: Answer | null, error: Error | null, again: boolean }} Reply
 */

/**
 * Keep the answer to the newest question in a signal.
 * @template Answer
 * @param {() => string} key "" where there is nothing to ask for
 * @param {(key: string) => Promise<Answer>} ask
 * @param {Signal<Reply<Answer>>} reply
 * @param {() => number} pause_ms after an answer
 */
export const keepAnswer = (key, ask, reply, pause_ms) => askForNewest({
  key,
  ask: async (of) => {
    try {
      reply.value = { answer: await ask(of), error: null, again: false };
    } catch (failure) {
      const error = /** @type {RequestError} */ (failure);
      const again = needsLonger(error);
      reply.value = { answer: again ? reply.value.answer : null, error, again };
      throw error;
    }
  },
  forget: () => (reply.value = { answer: null, error: null, again: false }),
  pause_ms,
});

/** No answer came: the server or the network is down. */
class Unreachable extends RequestError {
  constructor() {
    super(t("The server does not answer. Try again once it is back."));
  }
}

/**
 * The name of an error's field; of an item of a list, the name of the list.
 * @param {FieldError} error
 */
const fieldOf = (error) => {
  const path = error.field ?? error.loc ?? error.pointer ?? "";
  const names = (Array.isArray(path) ? path : path.split(/[./]/)).map(String);
  return names.findLast((name) => !/^\d+$/.test(name)) ?? "";
};

/**
 * The error that a problem document (RFC 9457) describes.
 * @param {number} status
 * @param {ProblemDocument} problem
 */
export const refusal = (status, problem) =>
  new RequestError(
    said(problem.detail || problem.title || "") || t("The server answered {status}.", { status }), status,
    [...problem.errors ?? [], { field: problem.field }].map(fieldOf).filter(Boolean), problem.legs,
  );

/** @param {string} text */
const parse = (text) => {
  try {
    return JSON.parse(text);
  } catch {
    return null;
  }
};

/** @param {Response} response */
async function refused(response) {
  const error = refusal(response.status, parse(await response.text()) ?? {});
  // Nothing was done where it is told.
  if (/^\d+$/.test(response.headers?.get("Retry-After") ?? "")) {
    error.retry_s = Number(response.headers.get("Retry-After"));
  }
  return error;
}

/**
 * @param {string} method
 * @param {string} path
 * @param {unknown} [body] a file as it is, all else as JSON
 * @param {Record<string, string>} [headers]
 * @returns {Promise<Response>}
 * @throws {RequestError}
 */
export async function request(method, path, body, headers = {}) {
  /** @type {Record<string, string>} */
  const type = body === undefined || body instanceof Blob ? {} : { "Content-Type": "application/json" };
  const response = await fetch(new URL(path, base()), {
    method,
    // Forms of other sites cannot send this header, so the server can tell their requests from this page's.
    headers: { "X-Requested-With": "hexapods", ...languageHeader, ...type, ...headers },
    body: body === undefined || body instanceof Blob ? body : JSON.stringify(body),
  }).catch(() => {
    throw new Unreachable();
  });
  if (!response.ok) throw await refused(response);
  return response;
}

/**
 * As `request`.
 * @param {Parameters<typeof request>} options
 * @returns {Promise<any>} the answer's JSON, null where there is none
 */
export const call = async (...options) => parse(await (await request(...options)).text());

/** @param {Kind} kind */
const collection = (kind) => `${kind}s`;
/**
 * A damaged run whose kind cannot be read is found under any.
 * @param {RunKey} run
 */
export const pathOf = ({ kind, id }) => `${collection(kind ?? "training")}/${encodeURIComponent(id)}`;

/** @returns {Promise<Options>} */
export const getOptions = async () => inWords(await call("GET", "options"));

/** @type {(id: string) => Promise<Run>} */
export const getAnyRun = (id) => call("GET", `runs/${encodeURIComponent(id)}`);

/**
 * A page of runs. Empty values filter nothing.
 * @type {(query: Record<string, string | null>) => Promise<Page<Run>>}
 */
export const listRuns = (query) => {
  const filters = Object.entries(query).flatMap(([name, value]) => (value ? [[name, value]] : []));
  return call("GET", `runs?${new URLSearchParams(filters)}`);
};

const RETRY_MS = 500;

/**
 * Make a run, or several. Where no answer comes the request is repeated once; its idempotency key makes both one.
 * @param {string} path
 * @param {unknown} body
 * @param {string} [idempotencyKey]
 * @returns {Promise<any>}
 */
export async function start(path, body, idempotencyKey = randomKey()) {
  const key = { "Idempotency-Key": idempotencyKey };
  try {
    return await call("POST", path, body, key);
  } catch (error) {
    if (!(error instanceof Unreachable)) throw error;
    await new Promise((resolve) => {
      setTimeout(resolve, RETRY_MS);
    });
    return call("POST", path, body, key);
  }
}

// Not randomUUID, which pages have only over https and on loopback.
export const randomKey = () => Array.from(crypto.getRandomValues(new Uint32Array(4)), (n) => n.toString(36)).join("-");


/** What is known of a robot, its gait and its foot grid. @type {(body: object) => Promise<Preview>} */
export const previewRobot = (body) => call("POST", "robots/preview", body);

/** @param {object} body */
export const startTraining = (body) => start("trainings", body);
/** @param {object} body */
export const startRace = (body) => start("races", body);

/** @type {(id: string, changes: Rates) => Promise<Run>} */
export const tuneTraining = (id, { pace, ...settings }) =>
  call("PATCH", pathOf({ kind: "training", id }), { ...(pace === undefined ? {} : { pace }), settings });

/** @type {(id: string, disturbance: object) => Promise<Disturbance>} */
export const disturbTraining = (id, disturbance) =>
  call("POST", `${pathOf({ kind: "training", id })}/disturbances`, disturbance);


/** @type {(run: RunKey, verb: Verb) => Promise<Run | null>} */
export const command = (run, verb) => call("POST", `${pathOf(run)}/${verb}`);
/** @type {(id: string, changes: Annotations) => Promise<Run>} */
export const annotateRun = (id, changes) => call("PATCH", `runs/${encodeURIComponent(id)}`, changes);

/** Start a run with the settings of another. @param {string} id */
export const startAgain = (id) => start(`runs/${encodeURIComponent(id)}/again`, undefined);

/** @param {string[]} ids */
export const idQuery = (ids) => new URLSearchParams(ids.map((id) => ["id", id]));
/** @typedef {{ deleted: string[], kept: { id: string, reason: string }[], restorable_until: string | null }} Deleted */
/** @type {(ids: string[]) => Promise<Deleted>} */
export const deleteRuns = (ids) => call("DELETE", `runs?${idQuery(ids)}`);

/** A few points of the curves of several trainings. @type {(ids: string[]) => Promise<Curves>} */
export const getCurves = (ids) => call("GET", `runs/curves?${idQuery(ids)}`);
/** @type {(id: string) => Promise<Curve>} */
export const getCurve = (id) => call("GET", `${pathOf({ kind: "training", id })}/curve`);
/** @type {(id: string, clock: string) => Promise<Omit<Timeline, "id">>} */
export const getTimeline = (id, clock) =>
  call("GET", `${pathOf({ kind: "race", id })}/timeline?clock=${clock}`);
/** @type {(id: string, clock: string, ghost: string | null) => Promise<ReplayPlan>} */
export const getReplay = (id, clock, ghost) => {
  const query = new URLSearchParams({ clock, ...(ghost === null ? {} : { ghost }) });
  return call("GET", `runs/${encodeURIComponent(id)}/replay?${query}`);
};

/**
 * Frames of a replay, encoded.
 * @param {string} id
 * @param {string} address of the frames in the replay
 * @param {Record<string, string>} query
 * @throws {RequestError}
 */
export async function getReplayFrames(id, address, query) {
  const path = `runs/${encodeURIComponent(id)}/replay/${address}?${new URLSearchParams(query)}`;
  return (await request("GET", path)).arrayBuffer();
}

/** The scene of a stage without a run, encoded as that of a replay. @throws {RequestError} */
export const getStartLine = async () => (await request("GET", "start-line")).arrayBuffer();

/** @returns {Promise<Stage>} */
export const getStage = () => call("GET", "stage");
/** @type {(changes: Partial<Stage> & { time_s?: number }) => Promise<Stage | null>} */
export const putStage = (changes) => call("PUT", "stage", changes);
