// The page's state: one document, which a link carries and "back" restores. Each of its fields is declared once, in
// `FIELDS` or by a feature. The only module that reads and writes the address and the history.
import { batch, effect, signal } from "@preact/signals";

/** @import { Signal } from "@preact/signals" */
/** @import { DeclaredField, FieldsOfFeatures } from "./types.js" */

/**
 * How a value stands in an address: `read` is undefined for a text that is none, `write` null for what a link leaves
 * out; `words` are those that are valid, where they are few.
 * @template Value
 * @typedef {{
 *   read: (text: string) => Value | undefined, write: (value: Value) => string | null, words?: unknown[],
 * }} Codec
 */

/**
 * `part`: the query of the address, its hash, or the query after a view in its hash. `name`: the name there; null for
 * all that no other field of the part has, as texts. `isEntry`: whether a change is a new entry of the history, to
 * which "back" returns.
 * @template Value
 * @typedef {Codec<Value> & { part: string, name: string | null, initial: Value, isEntry?: boolean }} Field
 */

/** @type {Codec<string | null>} */
const TEXT = { read: (text) => text || null, write: (text) => text };
/** @type {Codec<string[]>} */
const LIST = {
  read: (text) => [...new Set(text.split(",").map((word) => word.trim()).filter(Boolean))],
  write: (list) => list.join(",") || null,
};
/** An empty list is a choice, too. @type {Codec<string[] | null>} */
const NULLABLE_LIST = { read: LIST.read, write: (list) => list?.join(",") ?? null };
/** Without a value, as a person types it. @type {Codec<boolean>} */
const FLAG = { read: () => true, write: (isOn) => (isOn ? "" : null) };
/** @type {Codec<number | null>} */
const SECONDS = {
  read: (text) => (Number(text) >= 0 && text.trim() ? Number(text) : undefined),
  write: (time_s) => time_s?.toFixed(2) ?? null,
};
/**
 * One of several words, of which the first is left out.
 * @template Word
 * @param {Word[]} words
 * @returns {Codec<Word>}
 */
const oneOf = (words) => ({
  read: (text) => words.find((word) => word === text),
  write: (word) => (word === words[0] ? null : String(word)),
  words,
});
/**
 * None, or one of several words, to which more are added.
 * @param {string[]} words
 * @returns {Codec<string | null>}
 */
const noneOrOneOf = (words) => ({
  read: (text) => (words.includes(text) ? text : undefined), write: (word) => word, words,
});
/**
 * Several of a few words.
 * @param {string[]} words
 * @returns {Codec<string[]>}
 */
const severalOf = (words) => ({
  ...LIST,
  read: (text) => {
    const wanted = LIST.read(text) ?? [];
    return wanted.every((word) => words.includes(word)) ? wanted : undefined;
  },
  words,
});
/** @type {Codec<string>} */
const CAMERA = {
  // "leader" is what links had when nothing else directed the camera.
  read: (text) => (text === "leader" ? "directed" : /^(directed|free|[1-8])$/.test(text) ? text : undefined),
  write: (target) => (target === "directed" ? null : target),
  words: ["directed", "free", "1 to 8"],
};
/** @type {Codec<number | null>} */
const WHOLE = {
  read: (text) => (/^[1-9]\d?$/.test(text) ? Number(text) : undefined),
  write: (number) => (number === null ? null : String(number)),
};
const NO_TEXTS = new URLSearchParams();
const TEXTS = { name: null, initial: NO_TEXTS, read: () => undefined, write: String };
/** The kinds of fields that a feature can declare. @type {Record<DeclaredField["is"], Codec<any>>} */
const CODECS = { text: TEXT, list: LIST, flag: FLAG, whole: WHOLE, texts: TEXTS };

/** How much of the page is shown, from little to all. */
export const DEPTHS = ["watch", "try", "study"];
/** The tabs of the panel; features add theirs. */
const TABS = ["board", "train", "world"];
/** The views; features add theirs. */
const VIEWS = ["race", "runs", "compare"];
/** The ways to group the list of runs. */
export const GROUPINGS = ["sweep", "race", "day", "none"];
/** Parts of the page that can be hidden; features add theirs. */
const HIDEABLE = ["panel"];

/** The languages of the page: codes of links, and names in them. `messages/` has a catalogue of each but the first. */
export const LANGUAGES = { en: "English", de: "Deutsch", fr: "Français" };

/** The fields, in the order in which an address has them. */
const FIELDS = {
  /** The open view. */
  view: { part: "hash", name: "view", initial: "race", ...oneOf(VIEWS), isEntry: true },
  /** The language. */
  lang: { part: "query", name: "lang", initial: "en", ...oneOf(Object.keys(LANGUAGES)) },
  /** What was set of the next run, by field, as it was typed. */
  form: { part: "query", ...TEXTS },
  /** Id of the run that this page replays by itself; null for the stage that all share. */
  run: { part: "query", name: "run", initial: null, ...TEXT, isEntry: true },
  /** Id of the run whose robots walk along as ghosts. */
  ghost: { part: "query", name: "ghost", initial: null, ...TEXT, isEntry: true },
  /** Where the own replay is held [s]; null while it plays. */
  moment: { part: "query", name: "t", initial: null, ...SECONDS },
  /** Clock of the own replay of a race. */
  clock: { part: "query", name: "clock", initial: "paper", ...oneOf(["paper", "wall", "free"]) },
  /** Where the own replay of a race ends: at its time-out, or with its last lane. */
  end: { part: "query", name: "end", initial: "time-out", ...oneOf(["time-out", "all"]) },
  /** How much of the page is shown; null where the browser's own choice holds. */
  depth: { part: "query", name: "depth", initial: null, ...oneOf([null, ...DEPTHS]) },
  /** The open tab of the panel; null for the first. */
  tab: { part: "query", name: "tab", initial: null, ...noneOrOneOf(TABS), isEntry: true },
  /** A second tab, pinned beside the first where there is room. */
  pinned: { part: "query", name: "pinned", initial: null, ...noneOrOneOf(TABS) },
  /** Target of the camera: "directed", "free", or the number of a lane, from "1". */
  camera: { part: "query", name: "camera", initial: "directed", ...CAMERA },
  /** What is hidden of the page. */
  hidden: { part: "query", name: "hidden", initial: /** @type {string[]} */ ([]), ...severalOf(HIDEABLE) },
  /** How the list of runs is grouped; null where the browser's own choice holds. */
  grouping: { part: "runs", name: "group", initial: null, ...oneOf([null, ...GROUPINGS]) },
  /** The columns of the list of runs; null where the browser's own choice holds. */
  columns: { part: "runs", name: "columns", initial: /** @type {string[] | null} */ (null), ...NULLABLE_LIST },
  /** Ids of the runs that are selected in the list. */
  selected: { part: "runs", name: "selected", initial: /** @type {string[]} */ ([]), ...LIST },
  /** Id of the run whose details are shown beside the list; null for the first. */
  opened: { part: "runs", name: "open", initial: null, ...TEXT },
  /** Whether the details cover the list, where there is no room for both. */
  isOverList: { part: "runs", name: "details", initial: false, ...FLAG, isEntry: true },
  /** Filters and order of the list of runs. */
  list: { part: "runs", ...TEXTS },
  /** Ids of the runs that are compared, in their order. */
  compared: { part: "compare", name: "runs", initial: /** @type {string[]} */ ([]), ...LIST },
};

/** @typedef {typeof FIELDS} Fields */
/** @typedef {{ [Name in keyof Fields]: ReturnType<Fields[Name]["read"]> | Fields[Name]["initial"] }} Loose */
/** @typedef {{ [Name in keyof Loose]: Exclude<Loose[Name], undefined> } & FieldsOfFeatures} PageState */

const ENTRIES = /** @type {[keyof PageState, Field<any>][]} */ (Object.entries(FIELDS));
/** @type {PageState} */
const INITIAL = /** @type {any} */ (Object.fromEntries(ENTRIES.map(([name, { initial }]) => [name, initial])));

/** The document: a signal of each field. */
export const page = /** @type {{ [Name in keyof PageState]: Signal<PageState[Name]> }} */ (/** @type {any} */ (
  Object.fromEntries(ENTRIES.map(([name, { initial }]) => [name, signal(initial)]))));

/**
 * What a link says that has no effect, as "alhpa=0.5", by the form beside which that is told.
 * @type {Record<string, Signal<string[]>>}
 */
export const ignored = { query: signal([]) };

/**
 * Add the fields of a feature, before the address is read.
 * @param {Record<string, DeclaredField>} fields by name
 */
export function declareFields(fields) {
  for (const [name, { is, ...place }] of Object.entries(fields)) {
    const field = /** @type {Field<any>} */ ({ initial: null, ...place, ...CODECS[is] });
    ENTRIES.push([/** @type {keyof PageState} */ (name), field]);
    Object.assign(INITIAL, { [name]: field.initial });
    Object.assign(page, { [name]: signal(field.initial) });
    if (field.name === null) ignored[field.part] ??= signal([]);
  }
}

/** Add words that fields can have. @param {{ tabs: string[], views: string[], hideable: string[] }} words */
export function declareWords({ tabs, views, hideable }) {
  TABS.push(...tabs);
  VIEWS.push(...views);
  HIDEABLE.push(...hideable);
}

/** Change fields together. @param {Partial<PageState>} changes */
export const change = (changes) => batch(() => {
  for (const [name, value] of Object.entries(changes)) /** @type {any} */ (page)[name].value = value;
});

/** Note the open view; what is returned changes fields, unless the user has left the view since. */
export function changeIfStillHere() {
  const before = page.view.peek();
  return (/** @type {Partial<PageState>} */ changes) => {
    if (page.view.peek() === before) change(changes);
  };
}

// ---- as an address

/** A text within a query. @param {string} text */
const encoded = (text) => String(new URLSearchParams([["", text]])).slice(1);

/** A query that people can read: separators stand in its values as they are. @param {Iterable<string[]>} pairs */
const queryOf = (pairs) => [...pairs]
  .map(([name, text]) => encoded(name) + (text && `=${encoded(text).replace(/%(2C|3A|3B|3D)/g, decodeURIComponent)}`))
  .join("&");

/** @type {(field: Field<any>, value: any) => string[][]} */
function pairsOf({ name, write }, value) {
  if (name === null) return [...value];
  const text = write(value);
  return text === null ? [] : [[name, text]];
}

/** @type {(values: PageState) => string} */
function written(values) {
  const inPart = (/** @type {string} */ part) => queryOf(ENTRIES.flatMap(([name, field]) =>
    (field.part === part ? pairsOf(field, values[name]) : [])));
  const [query, ofView] = [inPart("query"), inPart(values.view)];
  const hash = values.view === INITIAL.view ? "" : `#${values.view}${ofView && `?${ofView}`}`;
  return `${query && `?${query}`}${hash}`;
}

const present = () =>
  /** @type {PageState} */ (/** @type {any} */ (Object.fromEntries(ENTRIES.map(([name]) => [name, page[name].value]))));

/** The document as an address, from its query on. */
export const write = () => written(present());

/** The address of a page in which only these fields are set. @param {Partial<PageState>} values */
export const addressOf = (values) => written({ ...INITIAL, lang: page.lang.peek(), ...values });

/** The fields of which a change is a new entry of the history, as a text. */
export const entry = () => queryOf(ENTRIES.flatMap(([name, field]) =>
  (field.isEntry ? pairsOf(field, page[name].value) : [])));

/** @type {(address: { search: string, hash: string }) => Record<string, URLSearchParams | undefined>} */
function partsOf({ search, hash }) {
  const [view, query] = hash.slice(1).split("?");
  const hashPart = new URLSearchParams(view ? { view } : {});
  const ofView = query ? { [view]: new URLSearchParams(query) } : {};
  return { ...ofView, query: new URLSearchParams(search), hash: hashPart };
}

/** @type {(field: Field<any>, query: URLSearchParams) => any} */
function readField({ part, name, initial, read, words }, query) {
  if (name === null) {
    const otherNames = ENTRIES.filter(([, field]) => field.part === part).map(([, field]) => field.name);
    return new URLSearchParams([...query].filter(([key]) => !otherNames.includes(key)));
  }
  const text = query.get(name);
  const value = text === null ? initial : read(text);
  if (value !== undefined) return value;
  const valid = words?.filter((word) => word !== null).join(", ");
  ignored.query.value = [...ignored.query.value, `${name}=${text}${valid ? ` (valid: ${valid})` : ""}`];
  return initial;
}

/**
 * Set the document to what an address says. The bare name of a view leaves what is set there as it was.
 * @param {{ search: string, hash: string }} address
 */
export const read = (address) => batch(() => {
  const parts = partsOf(address);
  for (const [name, field] of ENTRIES) {
    const query = parts[field.part];
    if (!query) continue;
    const [before, value] = [page[name].peek(), readField(field, query)];
    if (queryOf(pairsOf(field, before)) !== queryOf(pairsOf(field, value))) change({ [name]: value });
  }
});

/** The view that the server has opened, as at "/runs"; "" at the page's own address. */
const viewOfPath = () => document.documentElement.dataset.view ?? "";

/**
 * Keep the address and the page's state the same. The address that was opened is read first: one of a view, as
 * "/runs?kind=race", becomes that of the page with the view, "/#runs?kind=race".
 */
export function followHistory() {
  let lastAddress = "";
  const view = viewOfPath();
  const { pathname } = view ? new URL(".", location.href) : location;
  const isOfView = view !== "" && !location.hash;
  // At once, so that what follows from it is written over this entry of the history, and not to a new one.
  const readAddress = (/** @type {{ search: string, hash: string }} */ address) => batch(() => {
    read(address);
    lastAddress = entry();
  });
  const [ofPage, ofOpened] = [true, false].map((isOfPage) => String(new URLSearchParams(
    [...new URLSearchParams(location.search)].filter(([name]) => (name === "lang") === isOfPage))));
  readAddress(isOfView ? { search: ofPage, hash: `#${view}?${ofOpened}` } : location);
  addEventListener("popstate", () => readAddress(location));
  effect(() => {
    const [address, now] = [write(), entry()];
    const isOther = now !== lastAddress;
    lastAddress = now;
    if (`${pathname}${address}` === `${location.pathname}${location.search}${location.hash}`) return;
    history[isOther ? "pushState" : "replaceState"](history.state, "", `${pathname}${address}`);
  });
}

/** A link to the page as it is in another language. @param {string} lang */
export const linkIn = (lang) => `${location.origin}${location.pathname}${written({ ...present(), lang })}`;

/** A link to the page as it is, or with only these fields set. @param {Partial<PageState>} [values] */
export const linkTo = (values) => `${location.origin}${location.pathname}${values ? addressOf(values) : write()}`;

/**
 * The fields of a form as an address has them: lists with commas, of disturbances each by itself.
 * @param {Record<string, any>} form
 */
export function asTexts({ settings = {}, ...form }) {
  const pairs = Object.entries({ ...form, ...settings }).flatMap(([name, value]) => {
    if (name === "disturb" && Array.isArray(value)) return value.map((item) => [name, String(item)]);
    if (Array.isArray(value)) return [[name, value.join(",")]];
    return [[name, value !== null && typeof value === "object" ? JSON.stringify(value) : String(value)]];
  });
  return new URLSearchParams(pairs);
}

/**
 * What the address says of a page of its own, as `/x/NAME?flag&lang=de`: the last part of its path, the names in its
 * query, and its language.
 */
export function ownAddress() {
  const query = new URLSearchParams(location.search);
  const name = decodeURIComponent(location.pathname.split("/").at(-1) ?? "");
  return { name, flags: [...query.keys()], lang: query.get("lang") ?? "en" };
}

/** Write a link into the address bar. @param {string} address */
export const showAddress = (address) => history.replaceState(history.state, "", address);

/** Leave this page for another of the server. @param {string} address */
export const goTo = (address) => location.assign(address);

/** Load the page anew. */
export const reload = () => location.reload();
