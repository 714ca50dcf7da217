// The tournaments of the server, and the one that is about to be opened.
import { batch, computed, signal } from "@preact/signals";
import { call } from "../../js/api.js";
import { hasFeature } from "../../js/features.js";
import { form } from "../../js/form.js";
import { asTexts, page } from "../../js/page-state.js";
import { parseNumber } from "../../js/parse.js";
import { makeRequests } from "../../js/requests.js";
import { served } from "../../js/store.js";
import * as api from "./api.js";

/** @import { Signal } from "@preact/signals" */
/** @import { Take } from "../../js/deletions.js" */
/** @import { Parsed } from "../../js/parse.js" */
/** @import { ListedRoom, ListedTournament, Tournament } from "../../js/types.js" */

/** Null until the server has answered. @type {Signal<ListedTournament[] | null>} */
export const tournaments = signal(null);
/** The open rooms, in which a tournament can be. @type {Signal<ListedRoom[]>} */
export const rooms = signal([]);
/** The tournament that was opened last. @type {Signal<Tournament | null>} */
export const opened = signal(null);
/** Whether the dialog is open. */
export const isOpen = signal(false);
/** Whether it shows the form of a new tournament, and not the list. */
export const isNew = signal(false);
/** The room whose page this is; null on the dashboard. @type {Signal<string | null>} */
export const ownRoom = signal(null);

const requests = makeRequests();
export const { busy, failures, refused } = requests;
const { perform } = requests;

/** Ask for the tournaments, and the rooms that are open. */
export const refresh = () => perform("list", async () => {
  tournaments.value = (await api.listTournaments()).items;
  if (!hasFeature("classroom")) return;
  const all = await call("GET", "rooms");
  rooms.value = all.items.filter((/** @type {ListedRoom} */ { state }) => state !== "ended");
});

/** Take in a tournament that is restored. @type {Take} */
export const takeRestored = async (send) => {
  await send();
  await refresh();
};

/** Show the list. */
export function showList() {
  isNew.value = false;
  isOpen.value = true;
  refresh();
}

/**
 * Show the form of a tournament of a room; all walk as its card opens the page.
 * @param {string} code
 * @param {Record<string, any>} fields of the card's form
 */
export function askForTournament(code, fields) {
  page.form.value = asTexts(fields);
  batch(() => {
    ownRoom.value = code;
    showForm();
    isOpen.value = true;
  });
}

export function showForm() {
  batch(() => {
    opened.value = null;
    draft.value = {
      ...NEW, room: ownRoom.peek() ?? "", worlds: [served().worlds[0].name],
      numbers: Object.fromEntries(numberFields().map(([name, field]) => [name, String(field.default)])),
    };
    isNew.value = true;
  });
}

// ---- the form

/** As it was typed and chosen; numbers as texts. */
const NEW = {
  title: "", room: "", numbers: /** @type {Record<string, string>} */ ({}),
  worlds: /** @type {string[]} */ ([]), robots: /** @type {string[]} */ ([]), tables: false,
};

/** @typedef {typeof NEW} NewTournament */

/** @type {Signal<NewTournament>} */
export const draft = signal(NEW);

/** @param {Partial<NewTournament>} changes */
export const change = (changes) => {
  draft.value = { ...draft.peek(), ...changes };
};

/** @param {string} name @param {string} text */
export const changeNumber = (name, text) => change({ numbers: { ...draft.peek().numbers, [name]: text } });

/** A list with a name, or without it, in the order of all names. */
/** @type {(list: string[], name: string, all: string[]) => string[]} */
export const toggled = (list, name, all) =>
  all.filter((item) => (item === name ? !list.includes(item) : list.includes(item)));

/** The numbers of a tournament, with their titles, defaults and limits. */
export const numberFields = () => Object.entries(served().tournament_fields);

/** A sentence of the server, with the names of this form. @param {string} message */
export const inFormWords = (message) =>
  message.replace(/\b(?:rules\.)?([a-z_]+)(?= must be )/gi,
    (whole, field) => served().tournament_fields[field.toLowerCase()]?.title ?? whole);

/** @type {(of: NewTournament, name: string) => Parsed<number>} */
export const readNumber = (of, name) => parseNumber(of.numbers[name], served().tournament_fields[name], true);

const WALK = ["gait", "robot", "simulator", "divisions", "grid_side_m", "tolerance", "reward"];

/** The walking problem of the page's form, which the tournament has, too. */
export const walk = computed(() => Object.fromEntries(WALK.map((field) => [field, form.value[field]])));

/**
 * The request of a tournament; null while something is not valid.
 * @param {NewTournament} of
 * @param {Record<string, unknown>} walking the walking problem
 */
export function requestOf(of, walking) {
  const numbers = numberFields().map(([name]) => [name, readNumber(of, name).value]);
  if (numbers.some(([, value]) => value === undefined) || of.worlds.length === 0) return null;
  const { entries_per_hour: perHour, ...ofRules } = Object.fromEntries(numbers);
  const { worlds, robots, tables } = of;
  return {
    title: of.title.trim(), ...(of.room ? { room: of.room } : {}), entries_per_hour: perHour,
    rules: { ...walking, ...ofRules, worlds, robots, tables },
  };
}

/** Open the tournament of the form. */
export const open = () => perform("open", async () => {
  const body = requestOf(draft.peek(), walk.peek());
  if (body === null) return;
  opened.value = await api.openTournament(body);
  refresh();
});
