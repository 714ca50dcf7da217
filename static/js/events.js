// The stream of server-sent events.
import { addressOf } from "./api.js";

const FIRST_WAIT_MS = 500;
const LONGEST_WAIT_MS = 8000;

/**
 * Open the stream, and open it again after every break with exponential back-off.
 * @param {string[]} names of events that are wanted
 * @param {(name: string, data: any) => void} onEvent
 * @param {(state: "connecting" | "live" | "reconnecting") => void} onState
 * @param {string} [address] of the stream; that of the page's own stage without one
 * @returns {() => void} closes it for good
 */
export function openEvents(names, onEvent, onState, address = addressOf("events")) {
  /** @type {EventSource | null} */
  let source = null;
  let wait = FIRST_WAIT_MS;
  /** @type {ReturnType<typeof setTimeout> | undefined} */
  let timer;

  const open = () => {
    clearTimeout(timer);
    source?.close();
    const opened = new EventSource(address);
    source = opened;
    for (const name of names) {
      opened.addEventListener(name, ({ data }) => {
        if (name === "snapshot") {
          wait = FIRST_WAIT_MS;
          onState("live");
        }
        onEvent(name, JSON.parse(data));
      });
    }
    opened.onerror = () => {
      // The browser's own retry gives up on some answers.
      opened.close();
      onState("reconnecting");
      timer = setTimeout(open, wait);
      wait = Math.min(2 * wait, LONGEST_WAIT_MS);
    };
  };

  let isOver = false;
  const openNow = () => {
    if (!isOver && source?.readyState === EventSource.CLOSED) open();
  };
  addEventListener("online", openNow);
  document.addEventListener("visibilitychange", () => {
    if (!document.hidden) openNow();
  });
  onState("connecting");
  open();
  return () => {
    isOver = true;
    clearTimeout(timer);
    source?.close();
  };
}
