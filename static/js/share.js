// Copies links and texts, and tells so for a few seconds.
import { signal } from "@preact/signals";
import { link } from "./form.js";
import { ownRunId, replayLink } from "./replay.js";

/** @import { Signal } from "@preact/signals" */

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
  const isOwn = ownRunId.value !== null;
  const address = isOwn ? replayLink() : link();
  const contents = isOwn ? "It opens this replay at this moment." : "It contains every setting of the form.";
  if (!(await copy(address, `Link copied. ${contents}`))) {
    history.replaceState(history.state, "", address);
    toast("The address bar has the link: copy it from there.");
  }
}
