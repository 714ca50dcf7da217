// The one stream of server-sent events: a snapshot first, then changes, for as long as the page is open.

const NAMES = [
  "snapshot", "run", "run-deleted", "evaluation", "reference", "rates", "stage", "viewers", "scene",
  "summary",
];
const FIRST_WAIT_MS = 500;
const LONGEST_WAIT_MS = 8000;

/**
 * Keep a stream open; after a break, open a new one.
 * @param onEvent called with (name, data)
 * @param onState called with "connecting", "live" or "reconnecting"
 */
export function openEvents(onEvent, onState) {
  let source = null;
  let wait = FIRST_WAIT_MS;
  let timer = 0;

  const open = () => {
    clearTimeout(timer);
    source?.close();
    source = new EventSource(new URL("api/v1/events", document.baseURI));
    for (const name of NAMES) {
      source.addEventListener(name, ({ data }) => {
        if (name === "snapshot") {
          wait = FIRST_WAIT_MS;
          onState("live");
        }
        onEvent(name, JSON.parse(data));
      });
    }
    source.onerror = () => {
      // The browser's own retry gives up on some answers; this one never does.
      source.close();
      onState("reconnecting");
      timer = setTimeout(open, wait);
      wait = Math.min(2 * wait, LONGEST_WAIT_MS);
    };
  };

  const openNow = () => {
    if (source?.readyState === EventSource.CLOSED) open();
  };
  addEventListener("online", openNow);
  document.addEventListener("visibilitychange", () => document.hidden || openNow());
  onState("connecting");
  open();
}
