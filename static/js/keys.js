// Keyboard shortcuts, pressed on the page or forwarded by the stage's frame.
import { runPrimaryAction, togglePause } from "./actions.js";
import { helpIsOpen, place, shortcuts, view } from "./page.js";

/** [key, what it does] */
export const KEYS = [
  ["Space", "pause and resume"],
  ["R", "press the main button: train and race"],
  ["1 – 8", "follow the robot in that lane"],
  ["0", "free the camera"],
  ["?", "show this list"],
];

const TEXT = "input:not([type=range], [type=radio], [type=checkbox]), textarea, select, [contenteditable]";
const PRESSED_BY_SPACE = "button:not([aria-disabled=true]), a, summary, input:not([type=range])";

/**
 * Perform the action of a key; false if it has none.
 * @param {string} key
 */
function press(key) {
  // Keys act on the race view only while it can be seen.
  if (place.value === "experiments" && key !== "?") return false;
  if (key === " ") togglePause();
  else if (key === "r" || key === "R") runPrimaryAction();
  else if (/^[1-8]$/.test(key)) view.value = key;
  else if (key === "0") view.value = "free";
  else if (key === "?") helpIsOpen.value = !helpIsOpen.value;
  else return false;
  return true;
}

export function listenForKeys() {
  addEventListener("keydown", (event) => {
    const { key, target, repeat } = event;
    if (event.ctrlKey || event.altKey || event.metaKey || repeat || !shortcuts.value) return;
    const isIn = (/** @type {string} */ selector) => target instanceof Element && target.closest(selector);
    if (isIn(TEXT)) return;
    if (key === " " && isIn(PRESSED_BY_SPACE)) return;
    if (helpIsOpen.value && key !== "?") return;
    if (press(key)) event.preventDefault();
  });
  addEventListener("message", ({ origin, data }) => {
    if (origin !== location.origin || data?.type !== "hexapods:key" || !shortcuts.value) return;
    press(data.key);
  });
}
