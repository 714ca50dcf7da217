// The deletions of a list that can be undone.
import { deletions, forgetDeletion, refusals, restore, restoring } from "../deletions.js";
import { html } from "./elements.js";

/** @import { Take } from "../deletions.js" */

/** The time of day, also of tomorrow: it is an hour from now. @param {number} time_ms since 1970 */
const clockTime = (time_ms) =>
  new Date(time_ms).toLocaleTimeString([], { hour: "2-digit", minute: "2-digit", hourCycle: "h23" });

/**
 * What was deleted lately, and why it was not restored.
 * @param {{ kind: string, take: Take, id?: string }} props the address of the list, and the one thing that is meant
 */
export function Deletions({ kind, take, id }) {
  const all = deletions.value.filter((deletion) => deletion.kind === kind && (!id || deletion.ids.includes(id)));
  const refused = refusals.value[kind];
  return html`
    ${all.length > 0 && html`
      <ul class="deletions" aria-label="Deleted">
        ${all.map((deletion) => html`
          <li key=${deletion.ids.join()}>
            <span>Deleted ${deletion.words}. It can be restored until ${clockTime(deletion.until)}.</span>
            <button class="link" disabled=${restoring.value[kind]} onClick=${() => restore(deletion, take)}
              aria-label=${`Undo: ${deletion.words}`}>Undo</button>
            <button class="quiet square small" aria-label=${`Dismiss: ${deletion.words}`}
              onClick=${() => forgetDeletion(deletion)}>✕</button>
          </li>
        `)}
      </ul>
    `}
    ${refused && html`<p class="problem" role="alert">${refused}</p>`}
  `;
}
