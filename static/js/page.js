// What concerns this page alone and is in no link: the camera, dialogs, the full screen, what the browser keeps; and
// texts and links that are copied, which is told for a few seconds.
import { computed, effect, signal } from "@preact/signals";
import { change, linkTo, page, showAddress } from "./page-state.js";
import { replayLink } from "./replay.js";

/** @import { Signal } from "@preact/signals" */
/** @import { Message } from "./replay-frames.js" */

/** Target of the camera: "leader", "free", or the number of a lane, from "1". */
export const camera = signal("leader");
export const helpIsOpen = signal(false);

/**
 * A text that the browser keeps; where storage is forbidden, it is kept until the page is closed.
 * @param {string} key
 * @param {string} byDefault
 * @returns {Signal<string>}
 */
function storedText(key, byDefault) {
  const attempt = (/** @type {(kept: Storage) => string | null | void} */ act) => {
    try {
      return act(localStorage);
    } catch {
      return null;
    }
  };
  const text = signal(attempt((kept) => kept.getItem(`hexapods:${key}`)) ?? byDefault);
  effect(() => {
    const { value } = text;
    attempt((kept) => kept.setItem(`hexapods:${key}`, value));
  });
  return text;
}

/** Whether single keys act, "on" or "off"; they can interfere with speech input. */
export const shortcuts = storedText("shortcuts", "on");

// ---- the presenter view: full screen, large type

/** Whether the page fills the screen. */
export const isFullScreen = signal(false);

/** Fill the screen, where the browser allows it. */
export const enterFullScreen = () => document.documentElement.requestFullscreen?.().catch(() => {});

export function present() {
  change({ view: "race", isPresenting: true });
  helpIsOpen.value = false;
  enterFullScreen();
}

export const leavePresenter = () => change({ isPresenting: false });

/** Keep the style sheet's mark of the presenter view, which ends with the full screen and with the view of the race. */
export function followPresenter() {
  document.addEventListener("fullscreenchange", () => {
    isFullScreen.value = document.fullscreenElement !== null;
    if (!isFullScreen.value) leavePresenter();
  });
  effect(() => {
    if (page.view.value !== "race") leavePresenter();
    document.documentElement.toggleAttribute("data-presenting", page.isPresenting.value);
    if (!page.isPresenting.value && document.fullscreenElement) document.exitFullscreen().catch(() => {});
  });
}

// ---- the first lesson

/** Whether the first lesson was done or skipped: "done". */
const lessonKept = storedText("lesson", "open");
/** Whether the first lesson is open: at the first visit ("first"), or from the help ("again"). */
export const lesson = signal(lessonKept.peek() === "done" ? "" : "first");

export const closeLesson = () => {
  lesson.value = "";
  lessonKept.value = "done";
};

export const openLesson = () => {
  change({ view: "race" });
  helpIsOpen.value = false;
  lesson.value = "again";
};

// ---- the layout

const narrowScreen = matchMedia("(max-width: 1080px)");
/** Whether the page has one column. */
export const isNarrow = signal(narrowScreen.matches);
narrowScreen.addEventListener("change", ({ matches }) => (isNarrow.value = matches));

// ---- the colour theme: light, dark, or the system's; the stage follows it

const systemDark = matchMedia("(prefers-color-scheme: dark)");
const systemIsDark = signal(systemDark.matches);
const THEMES = ["auto", "light", "dark"];
const kept = storedText("theme", "auto");

/** The choice: "auto", "light" or "dark". */
export const theme = computed(() => (THEMES.includes(kept.value) ? kept.value : "auto"));

/** The theme that is shown: "light" or "dark". */
export const shownTheme = computed(() =>
  theme.value === "auto" ? (systemIsDark.value ? "dark" : "light") : theme.value,
);

export const nextTheme = () => (kept.value = THEMES[(THEMES.indexOf(theme.value) + 1) % THEMES.length]);

export function followTheme() {
  systemDark.addEventListener("change", ({ matches }) => (systemIsDark.value = matches));
  effect(() => {
    if (theme.value === "auto") delete document.documentElement.dataset.theme;
    else document.documentElement.dataset.theme = theme.value;
  });
}

// ---- the 3D view: what only this page draws in it, and what is clicked there


/**
 * A cell of a foot grid: its scene node, and its number there; and the run that was shown.
 * @typedef {{ node: string, instance: number, run_id: string | null }} Click
 */

/** Draws viser's messages: a new function for each scene that the view begins; null before. */
export const drawHere = signal(/** @type {((messages: Message[]) => void) | null} */ (null));
/** The last click on a foot grid, until it is answered. @type {Signal<Click | null>} */
export const clickedCell = signal(null);

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

/** The message that is shown for a few seconds. @type {Signal<string | null>} */
export const toastMessage = signal(null);

const TOAST_MS = 4000;
/** @type {ReturnType<typeof setTimeout> | undefined} */
let toastTimer;

/** @param {string} message */
function toast(message) {
  toastMessage.value = message;
  clearTimeout(toastTimer);
  toastTimer = setTimeout(() => (toastMessage.value = null), TOAST_MS);
}

/**
 * Copy a text; false where there is no clipboard, as outside of https and loopback.
 * @param {string} text
 * @param {string} words that tell of it
 */
export async function copy(text, words) {
  try {
    await navigator.clipboard.writeText(text);
  } catch {
    return false;
  }
  toast(words);
  return true;
}

export async function share() {
  const isOwn = page.run.value !== null;
  const address = isOwn ? replayLink() : linkTo();
  const contents = isOwn ? "It opens this replay at this moment." : "It contains every setting that was changed.";
  if (!(await copy(address, `Link copied. ${contents}`))) {
    showAddress(address);
    toast("The address bar has the link: copy it from there.");
  }
}
