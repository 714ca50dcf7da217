// The REST interface: one function a thing one can ask for, problem documents as errors.

const BASE = new URL("api/v1/", document.baseURI);

/** A refusal. `message` is fit to be shown; `fields` says which of the form's fields it is about. */
class ApiError extends Error {
  constructor(status, problem) {
    super(problem.detail || problem.title || `The server answered ${status}.`);
    this.status = status;
    this.fields = (problem.errors ?? []).map(fieldOf).filter(Boolean);
  }
}

/** Nobody answered: the server is away, or the network is. */
class Unreachable extends Error {
  constructor() {
    super("The server does not answer. Nothing was changed; try again once the page says live.");
    this.status = 0;
    this.fields = [];
  }
}

const fieldOf = (error) => {
  const place = error.field ?? error.loc ?? error.pointer ?? "";
  return String(Array.isArray(place) ? place.at(-1) : place.split(/[./]/).at(-1));
};

async function call(method, path, body, headers = {}) {
  const type = body === undefined ? {} : { "Content-Type": "application/json" };
  const response = await fetch(new URL(path, BASE), {
    method,
    // No form of another page can send this header, so that the server knows the request for ours.
    headers: { "X-Requested-With": "hexapods", ...type, ...headers },
    body: body === undefined ? undefined : JSON.stringify(body),
  }).catch(() => {
    throw new Unreachable();
  });
  const text = await response.text();
  if (!response.ok) throw new ApiError(response.status, parse(text) ?? {});
  return parse(text);
}

const parse = (text) => {
  try {
    return JSON.parse(text);
  } catch {
    return null;
  }
};

const collection = (kind) => `${kind}s`;
/** A damaged run whose kind cannot be read is found under any. */
const address = ({ kind, id }) => `${collection(kind ?? "training")}/${encodeURIComponent(id)}`;

export const getOptions = () => call("GET", "options");
export const getRun = (run) => call("GET", address(run));
export const listRuns = (kind, cursor) =>
  call("GET", `${collection(kind)}?limit=50${cursor ? `&cursor=${encodeURIComponent(cursor)}` : ""}`);

const RETRY_MS = 500;

/** One key for one press: where no answer came it is asked for once more, and is one run still. */
async function start(path, body) {
  const key = { "Idempotency-Key": newKey() };
  try {
    return await call("POST", path, body, key);
  } catch (error) {
    if (!(error instanceof Unreachable)) throw error;
    await new Promise((resolve) => setTimeout(resolve, RETRY_MS));
    return call("POST", path, body, key);
  }
}

// Not randomUUID, which pages have only over https and on loopback.
const newKey = () =>
  Array.from(crypto.getRandomValues(new Uint32Array(4)), (n) => n.toString(36)).join("-");

export const startTraining = (body) => start("trainings", body);
export const startRace = (body) => start("races", body);
export const startExperiment = (body) => start("experiments", body);
export const tuneTraining = (id, changes) => call("PATCH", address({ kind: "training", id }), changes);

export const whatIf = (body) => call("POST", "what-if", body);

/** `verb` is stop, pause or resume. */
export const tell = (run, verb) => call("POST", `${address(run)}/${verb}`);
export const deleteRun = (run) => call("DELETE", address(run));

export const getCurve = (id) => call("GET", `${address({ kind: "training", id })}/curve`);
export const getTimeline = (id, clock) =>
  call("GET", `${address({ kind: "race", id })}/timeline?clock=${clock}`);

export const getSummary = (id) => call("GET", `${address({ kind: "experiment", id })}/summary`);

export const putStage = (changes) => call("PUT", "stage", changes);

/** What of a run can be taken away: [label, address]. */
export function downloads(run) {
  const at = (rest) => new URL(`${address(run)}/${rest}`, BASE).href;
  if (run.kind === "experiment") return [["Every trial (CSV)", at("trials?format=csv")], ["Summary (JSON)", at("summary")]];
  if (run.kind === "race") return [["Recording", at("recording")]];
  return [
    ["Curve (CSV)", at("curve?format=csv")],
    ["Q-table (CSV)", at("q-table?format=csv")],
    ["Q-table (npz)", at("q-table?format=npz")],
  ];
}

/** The report that one can hand out, of an experiment that has ended. */
export const reportAddress = (run) => new URL(`${address(run)}/report`, BASE).href;
export const fileAddress = (run, name) =>
  new URL(`${address(run)}/files/${name.split("/").map(encodeURIComponent).join("/")}`, BASE).href;
