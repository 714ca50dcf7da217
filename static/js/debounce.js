// Acts soon, and once for all calls until then.

/** Those who watch act at most so often. */
const SOON_MS = 400;
/** Pages of a class hear of the same event at once, and spread their questions over so long. */
const SPREAD_MS = 1500;

/**
 * A function that acts soon, and once for all calls until then.
 * @param {() => unknown} act
 * @param {() => boolean} isAlone whether this page is one of few, so that it need not wait for its turn
 */
export function debounce(act, isAlone) {
  /** @type {ReturnType<typeof setTimeout> | undefined} */
  let timer;
  return () => {
    timer ??= setTimeout(() => {
      timer = undefined;
      act();
    }, SOON_MS + (isAlone() ? 0 : Math.random() * SPREAD_MS));
  };
}
