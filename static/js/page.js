// State of this page alone: the open view, the camera, the help dialog, the layout, the colour theme.
import { computed, effect, signal } from "@preact/signals";
import { role } from "./store.js";

/** Target of the camera: "leader", "free", or the number of a lane, from "1". */
export const view = signal("leader");
export const helpIsOpen = signal(false);
/** Whether single keys act; they can interfere with speech input. */
export const shortcuts = signal(readShortcuts());

/** @param {boolean} isOn */
export const setShortcuts = (isOn) => {
  shortcuts.value = isOn;
  try {
    localStorage.setItem("hexapods:shortcuts", isOn ? "on" : "off");
  } catch {
    // Storage is forbidden: kept until the page is closed.
  }
};

function readShortcuts() {
  try {
    return localStorage.getItem("hexapods:shortcuts") !== "off";
  } catch {
    return true;
  }
}

/** Fields of the address for a replay of this page's own: the run, its ghost, and the position in it [s]. */
export const REPLAY_FIELDS = ["run", "ghost", "t"];
const PRESENT_FIELD = "present";
/** Fields of the address that are none of the form. */
export const PAGE_FIELDS = [...REPLAY_FIELDS, PRESENT_FIELD];

// ---- the form on a spectator's page

/** Whether a spectator's form has settings of its own, which only "What if?" tries. */
export const hasOwnSettings = signal(false);
/** Whether the form shows a spectator the settings of the run that is shown, which are not in the address. */
export const isReadOnly = computed(() => role.value === "spectator" && !hasOwnSettings.value);

// ---- the presenter view: full screen, large type

const hasPresentField = () => new URLSearchParams(location.search).has(PRESENT_FIELD);

/** Whether the page is presented: `?present`, or the button. */
export const isPresenting = signal(hasPresentField());
/** Whether the page fills the screen. */
export const isFullScreen = signal(false);

/** Fill the screen, where the browser allows it. */
export const enterFullScreen = () => document.documentElement.requestFullscreen?.().catch(() => {});

export function present() {
  location.hash = "";
  place.value = "race";
  isPresenting.value = true;
  helpIsOpen.value = false;
  writePresentField();
  enterFullScreen();
}

export function leavePresenter() {
  isPresenting.value = false;
  writePresentField();
  if (document.fullscreenElement) document.exitFullscreen().catch(() => {});
}

function writePresentField() {
  const query = new URLSearchParams(location.search);
  query.delete(PRESENT_FIELD);
  // Without a value, as a person types it.
  const parts = [query.toString(), isPresenting.value ? PRESENT_FIELD : ""].filter(Boolean).join("&");
  history.replaceState(history.state, "", `${location.pathname}${parts && `?${parts}`}${location.hash}`);
}

/** Keep the style sheet's mark of the presenter view, which ends with the full screen and with the view of the race. */
export function followPresenter() {
  document.addEventListener("fullscreenchange", () => {
    isFullScreen.value = document.fullscreenElement !== null;
    if (!isFullScreen.value && isPresenting.value) leavePresenter();
  });
  addEventListener("popstate", () => {
    if (hasPresentField()) isPresenting.value = true;
    else if (isPresenting.value) leavePresenter();
  });
  effect(() => {
    if (isPresenting.value && place.value !== "race") leavePresenter();
    document.documentElement.toggleAttribute("data-presenting", isPresenting.value);
  });
}

// ---- the first lesson

/** Whether the first lesson is open: at the first visit ("first"), or from the help ("again"). */
export const lesson = signal(isLessonDone() ? "" : "first");

export const closeLesson = () => {
  lesson.value = "";
  try {
    localStorage.setItem("hexapods:lesson", "done");
  } catch {
    // Storage is forbidden: it opens again at the next visit.
  }
};

export const openLesson = () => {
  location.hash = "";
  helpIsOpen.value = false;
  lesson.value = "again";
};

function isLessonDone() {
  try {
    return localStorage.getItem("hexapods:lesson") === "done";
  } catch {
    return false;
  }
}

// ---- the open view

const VIEWS = ["experiments", "runs", "compare"];

/**
 * The view that a hash names: "race", "experiments", "runs" or "compare".
 * @param {string} hash
 */
export const viewOf = (hash) => VIEWS.find((name) => hash.slice(1).split("?")[0] === name) ?? "race";

/** The open view. */
export const place = signal(viewOf(location.hash));
addEventListener("hashchange", () => (place.value = viewOf(location.hash)));

/** Note the open view; the function that is returned goes to another one, unless the user has left this one since. */
export function goIfStillHere() {
  const before = place.peek();
  return (/** @type {string} */ hash) => {
    if (place.peek() === before) location.hash = hash;
  };
}

/** The query after the view in a hash. @param {string} hash */
const queryOf = (hash) => new URLSearchParams(hash.split("?")[1] ?? "");

/**
 * Keep the state of a view and the query in its hash the same.
 * @param {string} name of the view
 * @param {(query: URLSearchParams) => void} read
 * @param {() => string} write the query; empty while nothing is chosen
 */
export function followQuery(name, read, write) {
  /** The hash that was last written or read here. */
  let known = "";
  const readHash = () => {
    const { hash } = location;
    if (hash === known || viewOf(hash) !== name) return;
    known = hash;
    const query = queryOf(hash);
    // The bare link of the navigation leaves the view as it was.
    if (query.size > 0) read(query);
  };
  readHash();
  addEventListener("hashchange", readHash);
  effect(() => {
    // The event that tells of another address comes after it.
    if (place.value !== name || viewOf(location.hash) !== name) return;
    // A link that was followed is read before the state is written over it.
    readHash();
    const query = write();
    known = query ? `#${name}?${query}` : `#${name}`;
    if (location.hash === known) return;
    history.replaceState(history.state, "", `${location.pathname}${location.search}${known}`);
  });
}

// ---- the address of a replay of this page's own

/**
 * A replay; without `time_s` it plays.
 * @typedef {{ id: string, ghost?: string | null, time_s?: number | null }} Shown
 */

/** @param {Shown} shown */
const fieldsOf = ({ id, ghost = null, time_s = null }) => ({
  run: id, ...(ghost ? { ghost } : {}), ...(time_s === null ? {} : { t: time_s.toFixed(2) }),
});

/** Where a run is replayed, alone or with the robots of another as ghosts. @param {Shown} shown */
export const replayAddress = (shown) => `${location.pathname}?${new URLSearchParams(fieldsOf(shown))}`;

/** The replay that the address names; null if it names none. */
export function readReplay() {
  const query = new URLSearchParams(location.search);
  const id = query.get("run");
  if (!id) return null;
  const time_s = Math.max(0, Number(query.get("t")) || 0);
  return { id, at: { ghost: query.get("ghost"), time_s, isPlaying: !query.has("t") } };
}

/** Write a replay into the address; null takes it out. @param {Shown | null} shown */
export function writeReplay(shown) {
  const query = new URLSearchParams(location.search);
  const [before, ghostBefore] = [query.get("run"), query.get("ghost")];
  for (const field of REPLAY_FIELDS) query.delete(field);
  for (const [field, text] of Object.entries(shown ? fieldsOf(shown) : {})) query.set(field, text);
  const isOther = (shown?.id ?? null) !== before || (shown?.ghost ?? null) !== ghostBefore;
  const search = query.size ? `?${query}` : "";
  // A replay opens in the view of the race, as the stage is there.
  const address = `${location.pathname}${search}${shown && isOther ? "" : location.hash}`;
  // Back goes to what was shown before.
  if (isOther) history.pushState(history.state, "", address);
  else history.replaceState(history.state, "", address);
  place.value = viewOf(location.hash);
}

// ---- the layout

const narrowScreen = matchMedia("(max-width: 1080px)");
/** Whether the page has one column. */
export const isNarrow = signal(narrowScreen.matches);
narrowScreen.addEventListener("change", ({ matches }) => (isNarrow.value = matches));

// ---- the colour theme: light, dark, or the system's; the stage follows it

const KEY = "hexapods:theme";
const systemDark = matchMedia("(prefers-color-scheme: dark)");
const systemIsDark = signal(systemDark.matches);

/** The choice: "auto", "light" or "dark". */
export const theme = signal(document.documentElement.dataset.theme ?? "auto");

/** The theme that is shown: "light" or "dark". */
export const shownTheme = computed(() =>
  theme.value === "auto" ? (systemIsDark.value ? "dark" : "light") : theme.value,
);

export const nextTheme = () => {
  const order = ["auto", "light", "dark"];
  theme.value = order[(order.indexOf(theme.value) + 1) % order.length];
};

export function followTheme() {
  systemDark.addEventListener("change", ({ matches }) => (systemIsDark.value = matches));
  effect(() => {
    if (theme.value === "auto") delete document.documentElement.dataset.theme;
    else document.documentElement.dataset.theme = theme.value;
    store(theme.value);
  });
}

/** @param {string} value */
function store(value) {
  try {
    localStorage.setItem(KEY, value);
  } catch {
    // Storage is forbidden: kept until the page is closed.
  }
}

// ---- the 3D view: what only this page draws in it, and what is clicked there

/** @import { Signal } from "@preact/signals" */
/** @import { Message } from "./replay-frames.js" */

/**
 * A cell of a foot grid: its scene node, and its number there; and the run that was shown.
 * @typedef {{ node: string, instance: number, run_id: string | null }} Click
 */

/** Draws viser's messages: a new function for each scene that the view begins; null before. */
export const drawHere = signal(/** @type {((messages: Message[]) => void) | null} */ (null));
/** The last click on a foot grid, until it is answered. @type {Signal<Click | null>} */
export const clickedCell = signal(null);
/** Whether the panel of single steps is open. */
export const stepsAreOpen = signal(false);

const SETTLED_MS = 3000;
const BY_HAND = ["wheel", "touchmove", "keydown", "pointerdown"];

/** Ends what keeps the element that was scrolled to last in view. */
let stopKeeping = () => {};

/**
 * Scroll to an element, and keep it in view while what is above it loads and grows, until somebody scrolls or another
 * one is scrolled to.
 * @param {Element} element
 * @param {ScrollLogicalPosition} block where in the window
 */
export function keepInView(element, block) {
  stopKeeping();
  const scroll = () => element.scrollIntoView({ block, behavior: "instant" });
  const watcher = new ResizeObserver(scroll);
  watcher.observe(document.body);
  const stop = () => {
    watcher.disconnect();
    BY_HAND.forEach((type) => removeEventListener(type, stop));
  };
  BY_HAND.forEach((type) => addEventListener(type, stop, { passive: true }));
  setTimeout(stop, SETTLED_MS);
  stopKeeping = stop;
  scroll();
}
