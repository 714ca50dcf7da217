// What this page alone knows: which view is open, whom the camera follows, what is unfolded.
import { signal } from "@preact/signals";

/** "leader", "free", or a lane from "1" to "8". */
export const view = signal("leader");
export const helpIsOpen = signal(false);
/** Single keys can be in the way of speech input: they can be turned off. */
export const shortcuts = signal(recall());

export const setShortcuts = (on) => {
  shortcuts.value = on;
  try {
    localStorage.setItem("hexapods:shortcuts", on ? "on" : "off");
  } catch {
    // Storage is forbidden: it lasts as long as the page.
  }
};

function recall() {
  try {
    return localStorage.getItem("hexapods:shortcuts") !== "off";
  } catch {
    return true;
  }
}

const VIEWS = ["experiments", "runs"];
const viewOf = (hash) => VIEWS.find((name) => hash.slice(1).split("?")[0] === name) ?? "race";

/** "race", "experiments" or "runs", as the address has it. */
export const place = signal(viewOf(location.hash));
addEventListener("hashchange", () => (place.value = viewOf(location.hash)));

const narrowScreen = matchMedia("(max-width: 1080px)");
/** Whether the page is one column. */
export const isNarrow = signal(narrowScreen.matches);
narrowScreen.addEventListener("change", ({ matches }) => (isNarrow.value = matches));
