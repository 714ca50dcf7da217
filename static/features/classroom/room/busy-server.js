// Requests that a busy server refuses for a while, as when a class joins within the same second: made again by
// themselves once the time has passed that the answer names. A refused request has done nothing.
import { signal } from "@preact/signals";
import { t } from "../../../js/format.js";
import { setEntry } from "../../../js/store.js";

/** @import { Signal } from "@preact/signals" */
/** @import { RequestError } from "../../../js/api.js" */

const SECOND_MS = 1000;
/** A request is made again so often; then its refusal is told. */
const MOST_TRIES = 20;
/** Longer waits are not those of a busy server, but of something that is full [s]. */
const LONG_S = 10;

/** What is waited for, by the name of the request. @type {Signal<Record<string, { words: string, left_s: number }>>} */
export const waits = signal({});

/** Why a request waits. @param {RequestError} error @param {number} retry_s */
const reasonOf = ({ message }, retry_s) => (retry_s <= LONG_S
  ? t("Many are asking the server at this moment.") : `${message.replace(/[.;]?$/, "")}.`);

/** @param {number} ms */
const pause = (ms) => new Promise((resolve) => {
  setTimeout(resolve, ms);
});

/** Count down. @type {(name: string, words: string, left_s: number) => Promise<void>} */
async function wait(name, words, left_s) {
  setEntry(waits, name, { words, left_s: Math.ceil(left_s) });
  await pause(Math.min(left_s, 1) * SECOND_MS);
  if (left_s > 1) await wait(name, words, left_s - 1);
}

/**
 * Make a request, and again while the server names a time after which it may be made.
 * @template Answer
 * @param {string} name by which the wait is told
 * @param {() => Promise<Answer>} send
 * @param {{ longest_s?: number, tries?: number }} [how] the longest time that is waited for; the tries that are left
 * @returns {Promise<Answer>}
 * @throws {RequestError} that names no time, or the last of many
 */
export async function whenAdmitted(name, send, { longest_s = LONG_S, tries = MOST_TRIES } = {}) {
  try {
    return await send();
  } catch (error) {
    const { retry_s } = /** @type {RequestError} */ (error);
    if (!(retry_s !== null && retry_s <= longest_s) || tries <= 1) throw error;
    // Not all of a class at the same moment again.
    const jittered_s = retry_s * (1 + Math.random());
    await wait(name, reasonOf(/** @type {RequestError} */ (error), retry_s), jittered_s);
  } finally {
    const { [name]: _, ...others } = waits.peek();
    waits.value = others;
  }
  return whenAdmitted(name, send, { longest_s, tries: tries - 1 });
}
