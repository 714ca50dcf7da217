// What a page says while it hears nothing of the server, or only what it asks for.
import { isPolling } from "../events.js";
import { t } from "../format.js";
import { isAway } from "../store.js";
import { html } from "./elements.js";

/** A line above a page, only while it is needed. @param {{ words?: string }} props what is kept meanwhile */
export const Away = ({ words = t("This is the last that is known.") }) => html`
  ${isAway.value && html`
    <p class="strip-note warn" role="status">
      <span class="spinner" aria-hidden="true"></span> Reconnecting. ${words}
    </p>
  `}
  ${isPolling.value && html`
    <p class="strip-note" role="status">This network holds live updates back. The page asks every 2 seconds.</p>
  `}
`;
