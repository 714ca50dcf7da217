// Requests by name: what is under way, and what failed.
import { signal } from "@preact/signals";
import { setEntry } from "./store.js";

/** @import { Signal } from "@preact/signals" */
/** @import { RequestError } from "./api.js" */

/** One set of requests, of which each name is under way once at a time. */
export function makeRequests() {
  /** What is under way, by name. @type {Signal<Record<string, boolean>>} */
  const busy = signal({});
  /** What failed last, by name. @type {Signal<Record<string, string>>} */
  const failures = signal({});
  /** The fields that it was about, by name. @type {Signal<Record<string, string[]>>} */
  const refused = signal({});

  /**
   * Perform a request; true once it is done.
   * @param {string} name
   * @param {() => Promise<unknown>} send
   */
  async function perform(name, send) {
    if (busy.peek()[name]) return false;
    setEntry(busy, name, true);
    setEntry(failures, name, "");
    setEntry(refused, name, []);
    try {
      await send();
      return true;
    } catch (error) {
      const { message, fields = [] } = /** @type {RequestError} */ (error);
      setEntry(failures, name, message);
      setEntry(refused, name, fields);
      return false;
    } finally {
      setEntry(busy, name, false);
    }
  }

  return { busy, failures, refused, perform };
}
