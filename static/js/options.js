// The options of all forms: asked for until they come, and again when stored robots have changed since.
import { effect, signal } from "@preact/signals";
import { getOptions, RequestError } from "./api.js";
import { isLockedOut, options, robotsVersion } from "./store.js";

const FIRST_RETRY_MS = 500;
const LONGEST_RETRY_MS = 8000;

/** @param {unknown} error */
export const isLockOut = (error) => error instanceof RequestError && (error.status === 401 || error.status === 403);

/** Whether the options are missing, or older than the stored robots. */
const isOutdated = () => (options.value?.robots_version ?? -1) < robotsVersion.value;

/**
 * Load the options, and keep them up to date.
 * @param {() => void} whenFirst called once they are there
 */
export function followOptions(whenFirst) {
  const isLoading = signal(false);
  /** An answer that was written before the robots changed counts as a failed attempt. */
  const load = async (attempt = 0) => {
    isLoading.value = true;
    const isFirst = options.peek() === null;
    try {
      options.value = await getOptions();
      isLockedOut.value = false;
    } catch (error) {
      isLockedOut.value = isLockOut(error);
    }
    if (isFirst && options.peek() !== null) whenFirst();
    if (isOutdated()) setTimeout(load, Math.min(FIRST_RETRY_MS * 2 ** attempt, LONGEST_RETRY_MS), attempt + 1);
    else isLoading.value = false;
  };
  effect(() => {
    if (isOutdated() && !isLoading.value) load();
  });
}
