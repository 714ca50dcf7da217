// The keyboard, on the page and forwarded from the stage.
import { doNext, pauseOrPlay } from "./actions.js";
import { helpIsOpen, place, shortcuts, view } from "./page.js";

export const KEYS = [
  ["Space", "pause and go on"],
  ["R", "do what the big button says: train and race"],
  ["1 – 8", "follow the robot in that lane"],
  ["0", "free the camera"],
  ["?", "this list"],
];

const TEXT = "input:not([type=range], [type=radio], [type=checkbox]), textarea, select, [contenteditable]";
const PRESSED_BY_SPACE = "button:not([aria-disabled=true]), a, summary, input:not([type=range])";

/** Do what a key says; true if it said something. */
function act(key) {
  // What one does not see is not started by a slip of the finger.
  if (place.value === "experiments" && key !== "?") return false;
  if (key === " ") pauseOrPlay();
  else if (key === "r" || key === "R") doNext();
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
    if (target.closest?.(TEXT)) return;
    if (key === " " && target.closest?.(PRESSED_BY_SPACE)) return;
    if (helpIsOpen.value && key !== "?") return;
    if (act(key)) event.preventDefault();
  });
  addEventListener("message", ({ origin, data }) => {
    if (origin !== location.origin || data?.type !== "hexapods:key" || !shortcuts.value) return;
    act(data.key);
  });
}
