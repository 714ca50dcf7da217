// The tournament of this page as signals: what the server tells who asks, kept by its events, and what can be done.
import { batch, computed, effect, signal, untracked } from "@preact/signals";
import { addressOf, getOptions, roomAddressOf } from "../../js/api.js";
import { ownAddress } from "../../js/page-state.js";
import { tellDeleted } from "../../js/deletions.js";
import { makeRequests } from "../../js/requests.js";
import { debounce } from "../../js/debounce.js";
import { openEvents } from "../../js/events.js";
import { connection, options } from "../../js/store.js";
import * as api from "./api.js";
import { entryInWords, nameOf, shortened } from "./words.js";

/** @import { ReadonlySignal, Signal } from "@preact/signals" */
/** @import { Take } from "../../js/deletions.js" */
/** @import { RequestError } from "../../js/api.js" */
/** @import { Tournament, TournamentEntry } from "../../js/types.js" */

/** The id of the address, and whether the page is for the projector. */
const { name: ownId, flags } = ownAddress();
export const id = ownId;
export const isProjector = flags.includes("projector");

/** Null until the server has answered. @type {Signal<Tournament | null>} */
export const tournament = signal(null);
/** The tournament, for components: they are drawn once it is known. */
export const shownTournament = () => /** @type {Tournament} */ (tournament.value);
/** Why there is no tournament to be seen; null while there may be one. @type {Signal<RequestError | null>} */
export const refusal = signal(null);
/** What has happened to own entries, for screen readers. */
export const announcement = signal("");
/** The number of the own entry that was made last: the list moves the focus there. @type {Signal<number | null>} */
export const entered = signal(null);

const requests = makeRequests();
export const { busy, failures, refused } = requests;
const { perform } = requests;

/** The entries by their numbers. @type {ReadonlySignal<Map<number, TournamentEntry>>} */
export const entries = computed(() => new Map((tournament.value?.entries ?? []).map((entry) => [entry.number, entry])));

/** The name of an entry. @param {number} number */
export const nameOfNumber = (number) => {
  const entry = entries.value.get(number);
  return entry ? nameOf(entry) : `Entry ${number}`;
};

/** Entries that are not in the ranking yet: first those that are being judged, then those that wait. */
export const unranked = computed(() => {
  const ranked = new Set((tournament.value?.standings ?? []).map(({ number }) => number));
  const open = [...entries.value.values()].filter(({ number, state }) => !ranked.has(number) && state !== "withdrawn");
  return [...open.filter(({ judged }) => judged > 0), ...open.filter(({ judged }) => judged === 0)];
});

export const withdrawn = computed(() => [...entries.value.values()].filter(({ state }) => state === "withdrawn"));

/** So many are shown before all are wanted, those of references and own entries among them. */
const MOST = 20;

/** Whether all of the ranking is wanted. */
export const isWhole = signal(false);

/** The part of the ranking that is shown, best first. */
export const shownStandings = computed(() => {
  const { standings = [] } = tournament.value ?? {};
  const isKept = (/** @type {number} */ number) => {
    const { is_reference = false, is_own = false } = entries.value.get(number) ?? {};
    return is_reference || is_own;
  };
  return isWhole.value ? standings : shortened(standings, isKept, MOST);
});

// ---- reading

const NOT_FOUND = 404;
const LASTING = [401, 403, NOT_FOUND];
const AGAIN_MS = 1500;

/** The tournament as the server answered last, also after its deletion. @type {Tournament | null} */
let lastAnswer = null;
/** Followed while it is deleted, too: it may be restored. */
const followed = computed(() => tournament.value ?? (refusal.value?.status === NOT_FOUND ? lastAnswer : null));

/** Ask for the tournament anew; true if the server has answered. */
export async function refresh() {
  try {
    const answer = await api.getTournament(id);
    batch(() => {
      announceJudged(tournament.peek(), answer);
      tournament.value = answer;
      lastAnswer = answer;
      refusal.value = null;
    });
    return true;
  } catch (failure) {
    const error = /** @type {RequestError} */ (failure);
    if (LASTING.includes(error.status)) {
      tournament.value = null;
      refusal.value = error;
    } else if (tournament.peek() === null) {
      setTimeout(refresh, AGAIN_MS);
    }
    return error.status > 0;
  }
}

/** Tell of own entries that have been judged since. @param {Tournament | null} before @param {Tournament} now */
function announceJudged(before, now) {
  const isOpen = new Set(before?.entries.filter(({ state }) => state !== "judged").map(({ number }) => number));
  const news = now.entries.filter(({ is_own, number, state }) => is_own && state === "judged" && isOpen.has(number));
  if (news.length) announcement.value = news.map((number) => `${nameOf(number)} has been judged.`).join(" ");
}

// The pages of a class hear of each draw within the same moment.
const refreshSoon = debounce(refresh, () => tournament.peek()?.is_operator === true);

/** @param {string} name @param {any} data */
function onEvent(name, data) {
  // Whether a participant may enter depends on the room, too.
  if (name !== "tournament" || data.id === id) refreshSoon();
}

async function loadOptions() {
  try {
    options.value = await getOptions();
  } catch {
    setTimeout(loadOptions, AGAIN_MS);
  }
}

/** Load the tournament, and follow it until it has ended. */
export async function follow() {
  loadOptions();
  await refresh();
  // Participants hear of it by the events of their room, all others by those of the server.
  const stream = computed(() => {
    if (followed.value === null || followed.value.state === "ended") return "";
    const { room, is_operator } = followed.value;
    return room && !is_operator ? addressOf(`rooms/${encodeURIComponent(room)}/events`) : addressOf("events");
  });
  effect(() => {
    if (!stream.value) {
      connection.value = "live";
      return undefined;
    }
    const { room, is_operator } = followed.peek() ?? {};
    const snapshot = room && !is_operator ? roomAddressOf(room, "events/snapshot") : addressOf("events/snapshot");
    return openEvents(["snapshot", "tournament", "room"], onEvent, onState,
      () => ({ stream: stream.peek(), snapshot }));
  });
}

/**
 * Tell whether the server answers. A stream does not say why it ended: the room of the tournament may have, too, while
 * its entries are still judged. Then each attempt at the stream asks for the tournament.
 * @param {"connecting" | "live" | "reconnecting"} state
 */
function onState(state) {
  if (state !== "reconnecting") connection.value = state;
  else untracked(refresh).then((isAnswered) => (connection.value = isAnswered ? "live" : state));
}

// ---- acting

/** Enter, and tell how the entry is found again. @param {Record<string, unknown>} body */
export const enter = (body) => perform("enter", async () => {
  const before = entries.peek();
  const { number, of, entry } = await api.enter(id, body);
  await refresh();
  const what = entry ? entryInWords(entry, shownTournament().rules) : "An entry";
  batch(() => {
    entered.value = number;
    announcement.value = before.has(number)
      ? `${what} was entered before; it is judged once.`
      : `${what} has been entered. It is judged on ${of} draws.`;
  });
});

/** @param {boolean} isWaitingDropped whether entries that wait are not judged any more */
export const end = (isWaitingDropped) => perform("end", async () => {
  tournament.value = await api.endTournament(id, isWaitingDropped);
});

/** Delete the tournament; the page tells then that it can be restored. */
export const remove = () => perform("delete", async () => {
  const { title } = shownTournament();
  tellDeleted("tournaments", await api.deleteTournament(id), `“${title}”`, null);
  await refresh();
});

/** Take in the tournament that is restored. @type {Take} */
export const takeRestored = async (send) => {
  await send();
  await refresh();
};
