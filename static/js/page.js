// What concerns this page alone and is in no link: dialogs, large type, the window's size, what the browser keeps;
// and texts and links that are copied, which is told for a few seconds.
import { computed, effect, signal } from "@preact/signals";

/** @import { Signal } from "@preact/signals" */
/** @import { Message } from "./replay-frames.js" */

export const helpIsOpen = signal(false);

/**
 * A text that the browser keeps; where storage is forbidden, it is kept until the page is closed.
 * @param {string} key
 * @param {string} byDefault
 * @returns {Signal<string>}
 */
export function storedText(key, byDefault) {
  const attempt = (/** @type {(kept: Storage) => string | null | void} */ act) => {
    try {
      return act(localStorage);
    } catch {
      return null;
    }
  };
  const text = signal(attempt((storage) => storage.getItem(`hexapods:${key}`)) ?? byDefault);
  effect(() => {
    const { value } = text;
    attempt((storage) => storage.setItem(`hexapods:${key}`, value));
  });
  return text;
}

/** Whether single keys act, "on" or "off"; they can interfere with speech input. */
export const shortcuts = storedText("shortcuts", "on");

/** Whether the page is shown in large type and without controls, as to a class. */
export const isProjected = signal(false);

// ---- the layout

/** A signal of whether a media query holds. @param {string} query */
function mediaSignal(query) {
  const list = matchMedia(query);
  const isSo = signal(list.matches);
  list.addEventListener("change", ({ matches }) => (isSo.value = matches));
  return isSo;
}

/** Whether the panel is below the stage, and its tabs at the thumb. As in style/workspace.css. */
export const isPhone = mediaSignal("(max-width: 760px)");
/** Whether there is room for a second panel beside the first. */
export const isWide = mediaSignal("(min-width: 1700px)");

// ---- the colour theme: light, dark, or the system's; the stage follows it

const systemIsDark = mediaSignal("(prefers-color-scheme: dark)");
const THEMES = ["auto", "light", "dark"];
const storedTheme = storedText("theme", "auto");

/** The choice: "auto", "light" or "dark". */
export const theme = computed(() => (THEMES.includes(storedTheme.value) ? storedTheme.value : "auto"));

/** The theme that is shown: "light" or "dark". */
export const shownTheme = computed(() =>
  theme.value === "auto" ? (systemIsDark.value ? "dark" : "light") : theme.value,
);

export const nextTheme = () => (storedTheme.value = THEMES[(THEMES.indexOf(theme.value) + 1) % THEMES.length]);

export function followTheme() {
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

/** The message that is shown for a few seconds. @type {Signal<string | null>} */
export const toastMessage = signal(null);

const TOAST_MS = 4000;
/** @type {ReturnType<typeof setTimeout> | undefined} */
let toastTimer;

/** @param {string} message */
export function toast(message) {
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
