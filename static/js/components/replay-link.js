// A link to a replay, which opens on this page.
import { addressOf } from "../page-state.js";
import { openReplay } from "../player.js";
import { html } from "./elements.js";

/** @import { ComponentChildren } from "preact" */

/** @param {{ id: string, ghost?: string | null, label?: string | null, children: ComponentChildren }} props */
export function ReplayLink({ id, ghost = null, label = null, children }) {
  /** @param {MouseEvent} event */
  const open = (event) => {
    // A click with a key opens the link in another tab.
    if (event.ctrlKey || event.metaKey || event.shiftKey) return;
    event.preventDefault();
    openReplay(id, { ghost });
  };
  return html`
    <a class="to-report" href=${addressOf({ run: id, ghost })} aria-label=${label} onClick=${open}>${children}</a>
  `;
}
