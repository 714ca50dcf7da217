// The room of this page as signals: what the server tells who asks, kept by its events, and what can be done in it.
import { batch, computed, effect, signal, untracked } from "@preact/signals";
import { inLanguage, t } from "../../../js/format.js";
import { getAnyRun, getOptions, randomKey, roomAddressOf } from "../../../js/api.js";
import * as api from "../api.js";
import { whenAdmitted } from "./busy-server.js";
import { storedText } from "../../../js/page.js";
import { LANGUAGES, ownAddress } from "../../../js/page-state.js";
import { makeRequests } from "../../../js/requests.js";
import { debounce } from "../../../js/debounce.js";
import { openEvents } from "../../../js/events.js";
import { applyEvent, connection, eventNames, options, runs, setEntry } from "../../../js/store.js";

/** @import { Signal } from "@preact/signals" */
/** @import { RequestError } from "../../../js/api.js" */
/** @import { CardResults, Classroom, Clock, Gain, RoomState, Run, TeachingEvent } from "../../../js/types.js" */

/**
 * The code of the address, as it was typed; whether the page is for the projector, of a pupil in any case, or the frame
 * of a robot beside another one.
 */
const { name: typed, flags, lang } = ownAddress();
export const code = typed;
export const [isProjector, isPupils, isBeside] = ["projector", "join", "beside"].map((flag) => flags.includes(flag));

/** A language of the address that the page does not have; empty without one. */
export const missingLanguage = lang in LANGUAGES ? "" : lang;

/** Null until the server has answered. @type {Signal<Classroom | null>} */
export const room = signal(null);
/** Why there is no room; empty while there may be one. */
export const refusal = signal("");
/** Whether this page was in the room, and is not any more, though it has not left. */
export const isRemoved = signal(false);
/** Card → its results, as far as who asks may see them. @type {Signal<Record<string, CardResults>>} */
export const results = signal({});
/** What the class gains by the lesson; null until that is told. @type {Signal<Gain | null>} */
export const gain = signal(null);
/** Ids of runs whose pictures have been where their distances can be told, or cannot be had. */
/** @type {Signal<Set<string>>} */
export const arrived = signal(new Set());
const requests = makeRequests();
export const { busy, failures } = requests;
const { perform } = requests;

/** Whether who looks is the teacher, and wants to be: where everybody may be that, a window can be a pupil's. */
export const isTeacher = computed(() => room.value?.role === "teacher" && !isPupils);
/** Results of the card that is shown; null until they are known. */
export const shownResults = computed(() => results.value[`${room.value?.card}`] ?? null);
export const isRevealed = computed(() => room.value !== null && room.value.revealed.includes(room.value.card));
/** Whether the class teaches a robot on the card that is shown: then phones show the stage. */
export const isTeaching = computed(() => Boolean(room.value?.shown.teach));
/** Newest event of what the class teaches; null before the first. @type {Signal<TeachingEvent | null>} */
export const newestTeaching = signal(null);
/** The participant's own entry in them; null without one. */
export const ownEntry = computed(() => shownResults.value?.entries.find(({ is_own }) => is_own) ?? null);

// ---- what the participant has answered and run

/** The own answer to the card that is shown; undefined before it is locked. */
export const ownAnswer = computed(() =>
  room.value?.me?.predictions.find(({ card }) => card === room.value?.card)?.value);

/** Id of the newest own run of the card that is shown; null without one. */
export const ownRunId = computed(() =>
  room.value?.me?.runs.findLast(({ card }) => card === room.value?.card)?.run_id ?? null);

/** The newest own run of any card, or null. */
export const lastRunId = computed(() => room.value?.me?.runs.at(-1)?.run_id ?? null);

/** What the own what-if of the card that is shown gave; null without one. */
export const ownWhatIf = computed(() => ownEntry.value?.run?.answer ?? null);

/** @type {import("@preact/signals").ReadonlySignal<Run | null>} */
export const ownRun = computed(() => runs.value.get(ownRunId.value ?? "") ?? null);

/** The run that the page replays: the own one of this card, else the one that the card names. */
export const toReplay = computed(() => {
  if (isTeaching.value) return null;
  const run = ownRun.value;
  if (run && (run.state === "finished" || run.progress.done > 0)) return { id: run.id, kind: run.kind };
  const named = ownRunId.value === null ? room.value?.shown.state?.run : null;
  return named ? { id: named, kind: "race" } : null;
});

/** Id of the run that the page replays; null for none. */
export const replayed = computed(() => toReplay.value?.id ?? null);

/** Steps of a tab of the dashboard in which the own run is looked at closer. @type {Record<string, string>} */
export const CLOSER = { why: t("Why each move"), gait: t("Its gait"), table: t("Its table of values") };

/** A link to the dashboard with the own run, in the room's stage. @param {string} tab */
export const closerLink = (tab) =>
  inLanguage(`${room.value?.code}/?run=${ownRunId.value ?? lastRunId.value}&depth=study&tab=${tab}&hidden=card`);

const ENDED = ["finished", "failed", "stopped", "interrupted"];

/** Whether a run goes on, or waits. @param {{ state: string } | null} run */
export const goesOn = (run) => run !== null && !ENDED.includes(run.state);

// ---- reading

/** Ask for the room anew. */
export async function refresh() {
  try {
    const answer = await (room.peek() ? api.getRoom(code) : whenAdmitted("room", () => api.getRoom(code)));
    batch(() => {
      // The room forgets who was in it once it has ended; this page does not.
      const { role, me } = room.peek() ?? answer;
      if (role === "participant" && answer.role !== "participant") isRemoved.value = answer.state !== "ended";
      room.value = answer.state === "ended" ? { ...answer, role, me } : answer;
      refusal.value = "";
    });
  } catch (error) {
    const { status, message } = /** @type {RequestError} */ (error);
    if (status === 404 || status === 403 || status === 401 || status === 429) refusal.value = message;
    else if (room.peek() === null) setTimeout(refresh, AGAIN_MS);
  }
}

/** Ask for the results of the card that is shown, if there is anything to see. */
export async function refreshResults() {
  const { card, role } = room.peek() ?? {};
  if (card === undefined || role === "spectator" && !isProjector) return;
  try {
    const { cards: [cardResults], gain: ofClass } = await api.getResults(code, card, isProjector);
    batch(() => {
      setEntry(results, `${card}`, cardResults);
      gain.value = ofClass;
    });
  } catch {
    // The next event asks again.
  }
}

const AGAIN_MS = 1500;
// A class acts within the same seconds.
const refreshSoon = debounce(refresh, () => isTeacher.peek());
const refreshResultsSoon = debounce(refreshResults, () => isTeacher.peek());

/** Take in what an event tells of the room; ask for what it does not tell. @param {RoomState} state */
function onRoom(state) {
  const before = room.peek();
  if (before === null) return;
  const isOther = before.card !== state.card || before.state !== state.state ||
    `${before.revealed}` !== `${state.revealed}`;
  // The card's texts come with the room itself.
  if (before.card === state.card) room.value = { ...before, ...state };
  if (isOther) refresh();
  else if (before.role === "teacher") refreshSoon();
  if (before.role === "teacher" || state.revealed.includes(state.card)) refreshResultsSoon();
}

/** Ask for the room when a tournament of it is opened or has ended. @param {{ id: string, state: string }} data */
function onTournament({ id, state }) {
  const tournament = room.peek()?.tournaments.find((entry) => entry.id === id);
  if (tournament?.state !== state) refreshSoon();
}

/** @param {string} name @param {any} data @param {boolean} isContinued */
function onEvent(name, data, isContinued) {
  if (name === "room") onRoom(data);
  else if (name === "tournament") onTournament(data);
  else if (name === "teaching") newestTeaching.value = data;
  else applyEvent(name, data, isContinued);
  if (name === "snapshot") refresh().then(refreshResults);
  if (name !== "run" || !ENDED.includes(data.state)) return;
  if (isTeacher.peek() || data.id === ownRunId.peek() || isRevealed.peek()) refreshResultsSoon();
  if (isTeacher.peek()) refreshSoon();
}

/** Load the room, and follow it until it ends. */
export async function followRoom() {
  await refresh();
  const stream = computed(() => {
    const { state, role } = room.value ?? {};
    // A stranger follows nothing; what a stream tells depends on who has opened it.
    if (state === "ended" || (role === "spectator" && !isProjector)) return "";
    // Phones show the stage where they teach alone.
    return role ? `${role} ${isProjector || isTeaching.value}` : "";
  });
  effect(() => {
    if (!stream.value) {
      connection.value = "live";
      return undefined;
    }
    const hasPicture = isProjector || untracked(() => isTeaching.value);
    return openEvents(["room", "teaching", "tournament", ...eventNames()], onEvent, (now) => {
      connection.value = now;
      // The stream does not say why it ended: the room may have, or the seat is gone.
      if (now === "reconnecting") untracked(refresh);
    }, () => ({
      stream: `${api.eventsOf(code)}?picture=${hasPicture}`,
      snapshot: roomAddressOf(room.peek()?.code ?? code, "events/snapshot"),
    }));
  });
  effect(() => {
    // Each card has results of its own.
    if (room.value?.card !== undefined) refreshResultsSoon();
  });
  effect(() => {
    // A snapshot has the newest runs alone.
    const id = ownRunId.value;
    if (id !== null && !runs.value.has(id)) readRun(id);
  });
  effect(() => {
    const needs = room.value?.role === "participant" || room.value?.role === "teacher";
    if (needs && options.value === null) loadOptions();
  });
}

let isLoadingOptions = false;

async function loadOptions() {
  if (isLoadingOptions) return;
  isLoadingOptions = true;
  try {
    options.value = await getOptions();
  } catch {
    setTimeout(loadOptions, AGAIN_MS);
  }
  isLoadingOptions = false;
}

/** @param {string} id */
async function readRun(id) {
  try {
    const run = await getAnyRun(id);
    if (!runs.peek().has(id)) runs.value = new Map(runs.peek()).set(id, run);
  } catch {
    // It was deleted, or the server is away: the next snapshot tells.
  }
}

// ---- acting

/** Take in the room that a request answers with. @param {() => Promise<Classroom>} send */
const changed = (send) => async () => {
  room.value = await send();
};

export const join = () => perform("join", async () => {
  // Kept, so that it is the same for both tabs of a browser, and after a reload that came before the answer.
  const key = storedText(`join:${room.peek()?.code}`, randomKey());
  // A seat of a room that is full may become free.
  await whenAdmitted("join", () => api.joinRoom(code, key.peek()), { longest_s: Infinity });
  isRemoved.value = false;
  await refresh();
});

/** Leave the room: this browser is nobody in it any more, and can join as somebody else. */
export const leave = () => perform("leave", async () => {
  await api.leaveRoom(code);
  storedText(`join:${room.peek()?.code}`, "").value = randomKey();
  await refresh();
  isRemoved.value = false;
});

/** Lock the own answer to the card that is shown. @param {unknown} value */
export const lock = (value) => perform("lock", async () => {
  const { card = 0 } = room.peek() ?? {};
  try {
    await whenAdmitted("lock", () => api.predict(code, card, value));
  } finally {
    // Where the answer was lost, or another tab was first, the locked one is shown.
    await refresh();
  }
});

/** Run what the card runs, with these settings. @param {Record<string, unknown>} settings */
export const go = (settings) => perform("go", async () => {
  const { card = 0 } = room.peek() ?? {};
  const key = randomKey();
  const answer = await whenAdmitted("go", () => api.startRun(code, card, settings, key));
  if ("chosen" in answer) {
    await refreshResults();
    return;
  }
  runs.value = new Map(runs.peek()).set(answer.id, answer);
  await refresh();
});

/** @param {number} card */
export const showCard = (card) => perform("card", changed(() => api.showCard(code, card)));
/** @param {boolean} isOn */
export const freeze = (isOn) => perform("freeze", changed(() => api.freezeRoom(code, isOn)));
export const reveal = () => perform("reveal", async () => {
  room.value = await api.revealCard(code, room.peek()?.card ?? 0);
  await refreshResults();
});
export const end = () => perform("end", changed(() => api.endRoom(code)));
/** Delete the room, which has ended. @param {boolean} withRuns */
export const remove = (withRuns) => perform("end", async () => {
  await api.deleteRoom(code, withRuns);
  batch(() => {
    room.value = null;
    refusal.value = t("You have deleted this room.");
  });
});
/** Time the race on the stage by a clock. @param {Clock} clock */
export const setStageClock = (clock) => perform("spotlight", () => api.setStageClock(room.peek()?.code ?? code, clock));
/** @param {string | null} run_id */
export const spotlight = (run_id) => perform("spotlight", changed(() => api.spotlightRun(code, run_id)));
/** @type {(seed: number, changes: { is_name_hidden?: boolean, is_approved?: boolean }) => Promise<boolean>} */
export const changeParticipant = (seed, changes) =>
  perform(`participant ${seed}`, changed(() => api.changeParticipant(code, seed, changes)));
/** Take seat, name and answers of a participant. @param {number} seed */
export const removeParticipant = (seed) => perform(`participant ${seed}`, async () => {
  room.value = await api.removeParticipant(code, seed);
  await refreshResults();
});
