// Keys that act on the whole page, pressed on it or forwarded by the stage's frame; menus, which close by themselves.
import { runPrimaryAction, togglePause } from "../actions.js";
import { actionOfKey } from "../features.js";
import { page } from "../page-state.js";
import { aim, closeLegs, helpIsOpen, isStill, legsAreOpen, nextAngle, openLegs, shortcuts } from "../page.js";
import { isOwn, stepReplay } from "../player.js";
import { isOperator } from "../selectors.js";
import { scale, seekTo, seekToMark, toggleTime } from "../time.js";
import { isAtLeast, nextDepth, openExplanation, toggleHidden } from "../workspace.js";

const TEXT = "input:not([type=range], [type=radio], [type=checkbox]), textarea, select, [contenteditable]";
const PRESSED_BY_SPACE = "button:not([aria-disabled=true]), a, summary, input:not([type=range])";
/** Elements to which these keys belong while they have the focus. */
const MOVED_BY_KEYS = "input[type=range], [role=slider], [role=tab], [role=grid], [role=menu], .body, .pinned";

/** Keys of the view of the race. @type {Record<string, () => unknown>} */
const RACE_KEYS = {
  // A spectator has no stage to hold: as the play button, it begins a replay of the page's own.
  " ": () => (isOperator.value ? togglePause : toggleTime)(),
  "r": runPrimaryAction,
  "0": () => aim("free"),
  "c": () => aim("directed"),
  "v": nextAngle,
  ",": () => isOwn.value && stepReplay(-1),
  ".": () => isOwn.value && stepReplay(1),
  "[": () => seekToMark(-1),
  "]": () => seekToMark(1),
  "Home": () => seekTo(0),
  "End": () => seekTo(scale.value?.end ?? 0),
  "e": openExplanation,
  "d": nextDepth,
  "l": () => isAtLeast("try") && openLegs(),
  "\\": () => toggleHidden("panel"),
};

/** Perform the action of a key; false if it has none. @param {string} pressed */
function press(pressed) {
  const key = pressed.length === 1 ? pressed.toLowerCase() : pressed;
  if (key === "?") {
    toggleHelp();
    return true;
  }
  // All but the help act on the race, which a reader of another view does not see.
  if (page.view.value !== "race") return false;
  const isOfCamera = /^[1-8]$/.test(key) && !isStill.value;
  if (isOfCamera) aim(key);
  // What a feature shows in place of the race has its own keys alone.
  const action = actionOfKey(key) ?? (isStill.value ? undefined : RACE_KEYS[key]);
  action?.();
  return isOfCamera || action !== undefined;
}

/** Open the help, or close it. The dialog itself is asked: it tells of its end only later. */
export function toggleHelp() {
  const wasOpen = document.querySelector("#help[open]") !== null;
  helpIsOpen.value = false;
  helpIsOpen.value = !wasOpen;
}

/** Close the open menus in which a target is not. @param {EventTarget | null} target */
const closeOtherMenus = (target) => {
  for (const menu of document.querySelectorAll("details.menu[open]")) {
    if (!(target instanceof Node && menu.contains(target))) menu.removeAttribute("open");
  }
};

/** Close the open menu, and give the focus back to what opened it; false if there is none. */
function leaveMenu() {
  const menu = document.querySelector("details.menu[open]");
  if (!menu) return false;
  menu.removeAttribute("open");
  menu.querySelector("summary")?.focus();
  return true;
}

/** Close what is on top; false if nothing is. */
function leaveTop() {
  if (leaveMenu()) return true;
  if (legsAreOpen.value) {
    closeLegs();
    return true;
  }
  const leave = actionOfKey("Escape");
  leave?.();
  return leave !== undefined;
}

/** Menus close with Escape, and when a click or the focus goes elsewhere. */
export function listenForMenus() {
  for (const type of ["pointerdown", "focusin"]) addEventListener(type, ({ target }) => closeOtherMenus(target));
}

/** Whether a key belongs to the element that has the focus. @param {string} key @param {EventTarget | null} target */
function isOfElement(key, target) {
  const isIn = (/** @type {string} */ selector) => target instanceof Element && target.closest(selector);
  return isIn(TEXT) || (key === " " && isIn(PRESSED_BY_SPACE)) || (key.length > 1 && isIn(MOVED_BY_KEYS));
}

export function listenForKeys() {
  addEventListener("keydown", (event) => {
    const { key, target, repeat } = event;
    // The dialog itself, since it tells of its end only later.
    const isInDialog = document.querySelector("dialog[open]") !== null;
    if (key === "Escape" && !event.defaultPrevented && !isInDialog && leaveTop()) event.preventDefault();
    if (event.ctrlKey || event.altKey || event.metaKey || repeat || shortcuts.value === "off") return;
    if (isOfElement(key, target) || (isInDialog && key !== "?")) return;
    if (press(key)) event.preventDefault();
  });
  addEventListener("message", ({ origin, data }) => {
    if (origin !== location.origin || data?.type !== "hexapods:key") return;
    if (data.key === "Escape") leaveTop();
    else if (shortcuts.value === "on") press(data.key);
  });
}
