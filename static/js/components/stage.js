// The 3D stage in its frame, with labels over it and the transport below.
import { useEffect, useRef, useState } from "preact/hooks";
import { html } from "../html.js";
import { view } from "../page.js";
import { connection } from "../store.js";
import { shownTheme } from "../theme.js";
import { StageLabels } from "./stage-labels.js";
import { isRefused, StagePlaceholder } from "./stage-placeholder.js";
import { Transport } from "./transport.js";

/** A frame that has not reported its status for so long is shown as it is. */
const STATUS_TIMEOUT_MS = 12_000;

export function Stage() {
  const frame = useRef(/** @type {HTMLIFrameElement | null} */ (null));
  const [status, setStatus] = useState("loading");
  // The first address has both; later changes are sent to the frame, which must not load again.
  const [address] = useState(() => `viewer/?view=${view.peek()}&theme=${shownTheme.peek()}`);

  useEffect(() => {
    const onMessage = ({ origin, source, data }) => {
      if (origin !== location.origin || source !== frame.current?.contentWindow) return;
      if (data?.type === "hexapods:status") setStatus(data.status);
    };
    addEventListener("message", onMessage);
    const timer = setTimeout(
      () => setStatus((now) => (now === "loading" ? "connected" : now)), STATUS_TIMEOUT_MS,
    );
    return () => {
      removeEventListener("message", onMessage);
      clearTimeout(timer);
    };
  }, []);

  useEffect(() => {
    const message = { type: "hexapods:show", view: view.value, theme: shownTheme.value };
    frame.current?.contentWindow?.postMessage(message, location.origin);
  }, [view.value, shownTheme.value, status]);

  const isAway = connection.value === "reconnecting" || status === "reconnecting";
  return html`
    <section class=${`stage ${isAway ? "away" : ""}`} aria-label="Stage" data-status=${status}>
      <div class="picture">
        <iframe ref=${frame} src=${address} title="The robots on the track, in 3D"></iframe>
        ${(status === "loading" || isRefused(status)) && html`<${StagePlaceholder} status=${status} />`}
        <${StageLabels} />
        ${isAway && html`
          <p class="away-note" role="status">
            <span class="spinner" aria-hidden="true"></span>
            Reconnecting. This is the last picture.
          </p>
        `}
      </div>
      <${Transport} />
    </section>
  `;
}
