// The stream of server-sent events: a snapshot, then changes; reopened after every break.

const NAMES = [
  "snapshot", "run", "run-deleted", "evaluation", "reference", "rates", "stage", "viewers", "scene",
  "summary",
];
const FIRST_WAIT_MS = 500;
const LONGEST_WAIT_MS = 8000;

/**
 * Open the stream, and open it again after every break with exponential back-off.
 * @param {(name: string, data: any) => void} onEvent
 * @param {(state: "connecting" | "live" | "reconnecting") => void} onState
 */
export function openEvents(onEvent, onState) {
  /** @type {EventSource | null} */
  let source = null;
  let wait = FIRST_WAIT_MS;
  /** @type {ReturnType<typeof setTimeout> | undefined} */
  let timer;

  const open = () => {
    clearTimeout(timer);
    source?.close();
    const opened = new EventSource(new URL("api/v1/events", document.baseURI));
    source = opened;
    for (const name of NAMES) {
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

  const openNow = () => {
    if (source?.readyState === EventSource.CLOSED) open();
  };
  addEventListener("online", openNow);
  document.addEventListener("visibilitychange", () => {
    if (!document.hidden) openNow();
  });
  onState("connecting");
  open();
}
