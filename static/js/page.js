// What concerns this page alone and is in no link: dialogs, large type, the window's size, what the browser keeps;
// and texts and links that are copied, which is told for a few seconds.
import { computed, effect, signal } from "@preact/signals";
import { page } from "./page-state.js";
import { shotOf } from "./replay-frames.js";
import { scene } from "./store.js";

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
export const isPhone = mediaSignal("(max-width: 47.5rem)");
/** On a phone: whether the card is folded into its button, and what the foot of the panel holds is shown. */
export const isCardFolded = signal(false);
export const isFootOpen = signal(false);
/** Whether there is room for a second panel beside the first. */
export const isWide = mediaSignal("(min-width: 106.25rem)");

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

/** Whether there is no 3D view, by its status (viewer/context.js): never, or no more. @param {string} status */
export const isFlat = (status) => status === "flat" || status === "gone";

// ---- the camera: it is directed (viewer/camera.js), until the viewer takes it by hand, or lets it go

/** The target at which the viewer took the camera; null while nobody has. @type {Signal<string | null>} */
const takenAt = signal(null);
/** From which of its sides a shot is taken, from 0. */
export const angle = signal(0);
/** Whether the camera is the viewer's. */
export const isTaken = computed(() => page.camera.value === "free" || page.camera.value === takenAt.value);
/** The shot, as a text: it stays the same while the figures of the scene change. */
const shotText = computed(() => JSON.stringify(shotOf(scene.value, isTaken.value ? "free" : page.camera.value)));

/** The viewer has turned the picture. */
export const takeCamera = () => (takenAt.value = page.camera.peek());
/** Aim the camera: "directed", "free", or the number of a lane. @param {string} target */
export const aim = (target) => {
  [takenAt.value, angle.value, page.camera.value] = [null, 0, target];
};
/** What the 3D view is to know of the camera. */
export const directions = computed(() => ({
  ...(isStill.value ? { shot: null, lane: null } : JSON.parse(shotText.value)), angle: angle.value,
}));
/** See the shot from another side. */
export const nextAngle = () => (angle.value += 1);

// ---- the legs of the robots in the picture: where they are, which one was picked, and the menu that opens there. The
// 3D view projects the poses that it draws (viewer/legs.js), and tells of them in pixels of the picture

/** A point of the picture [px]. @typedef {{ x: number, y: number }} Point */
/** What was picked: a leg, from 1, the body, or the ground; of a lane, from 0. */
/** @typedef {Point & { lane: number, what: "leg" | "body" | "ground", leg: number | null }} Pick */

/** What was picked last, while its menu is open. @type {Signal<Pick | null>} */
export const picked = signal(null);
/** Whether the legs of the followed robot are numbered, to choose from. */
export const legsAreOpen = computed(() => legsOf.value !== null || picked.value !== null);
/** The lane whose legs are numbered; null where none are. @type {Signal<number | null>} */
export const legsOf = signal(null);
/** Where the legs of that lane are. @type {Signal<(Point & { leg: number })[]>} */
export const legPoints = signal([]);

/** The lane that the camera follows: of the leader where it follows that. */
const followedLane = () => {
  const lanes = scene.peek()?.lanes ?? [];
  const lane = Number(page.camera.peek()) - 1;
  return lanes[lane] ? lane : lanes.find(({ rank }) => rank === 1)?.lane ?? 0;
};

/** Number the legs of the robot that is followed. */
export const openLegs = () => {
  if (!scene.peek()?.lanes.length) return;
  picked.value = null;
  legsOf.value = followedLane();
};

export const closeLegs = () => {
  legsOf.value = null;
  picked.value = null;
  legPoints.value = [];
};

/** Open the menu of a leg that is numbered. @param {number} leg */
export function pickLeg(leg) {
  const point = legPoints.peek().find((candidate) => candidate.leg === leg);
  const lane = legsOf.peek();
  if (point && lane !== null) picked.value = { ...point, lane, what: "leg" };
}

// ---- what a feature draws in the 3D view of this page alone, in place of what is played

/** Whether the 3D view has a still scene of a feature, and the player draws nothing. */
export const isStill = signal(false);
/**
 * What the camera goes round, and of which points places are told (viewer/inspection.js): in the frame of the scene's
 * root `world` [m]. `of` counts the lists of points; `margins_px` stay free
 * around what is shown.
 * @typedef {{
 *   world: string, centre_m: number[], rims_m: number[][], points: number[][], of: number,
 *   isTurning: boolean, turned_deg: number, margins_px: { side: number, top: number, bottom: number },
 * }} Inspection
 */
/** @type {Signal<Inspection | null>} */
export const inspection = signal(null);
/** Where its points are; null for one that is behind the camera, and whence it is seen. */
/** @type {Signal<{ of: number, points: (Point | null)[], azimuth_deg: number }>} */
export const places = signal({ of: 0, points: [], azimuth_deg: 0 });
/** The node of the still scene that was clicked last. @type {Signal<{ node: string } | null>} */
export const clickedNode = signal(null);
/** Counts how often someone has turned the still scene by hand. */
export const turnedByHand = signal(0);

// ---- texts that are copied

/** What can be done about a message. @typedef {{ label: string, run: () => unknown }} ToastAction */
/** The message that is shown for a few seconds. @type {Signal<{ words: string, action?: ToastAction } | null>} */
export const toastMessage = signal(null);

const TOAST_MS = 4000;
/** Of a message with an action: to be read, and reached by keys. */
const LONG_TOAST_MS = 12_000;
/** @type {ReturnType<typeof setTimeout> | undefined} */
let toastTimer;

/** @param {string} words @param {ToastAction} [action] */
export function toast(words, action) {
  toastMessage.value = { words, action };
  clearTimeout(toastTimer);
  toastTimer = setTimeout(() => (toastMessage.value = null), action ? LONG_TOAST_MS : TOAST_MS);
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
