// What can be done with all runs that are selected; on a phone a bar at the thumb leads there.
import { useState } from "preact/hooks";
import { pending } from "../../actions.js";
import { openDetails } from "../../run-details.js";
import { clearSelection, deletable, deleteSelected, selected, tagSelected } from "../../run-selection.js";
import { isOperator } from "../../selectors.js";
import { served } from "../../store.js";
import { html } from "../elements.js";
import { Slot } from "../../features.js";
import { Problem } from "../foot.js";

/** @import { Changed } from "../../types.js" */

export const SelectionActions = () => html`
  <div class="selection-actions" role="group" aria-label="Selected runs">
    <${Slot} name="actions on selected runs" />
    ${isOperator.value && html`<${TagThem} />`}
    ${isOperator.value && deletable.value.length > 0 && html`<${DeleteThem} />`}
    <${Problem} at="selection" />
  </div>
`;

function TagThem() {
  const [tag, setTag] = useState("");
  /** @param {Event} event */
  const submit = async (event) => {
    event.preventDefault();
    if (tag.trim() && (await tagSelected(tag))) setTag((now) => (now === tag ? "" : now));
  };
  return html`
    <form class="in-place" onSubmit=${submit}>
      <input type="text" aria-label="Tag for the selected runs" placeholder="Add a tag"
        maxlength=${served().limits.tag[1]} value=${tag}
        onInput=${(/** @type {Changed} */ { target }) => setTag(target.value)} />
      <button class="secondary compact" disabled=${pending.value.selection}>Tag</button>
    </form>
  `;
}

const DeleteThem = () => html`
  <button class="secondary compact bad" disabled=${pending.value.selection} onClick=${deleteSelected}>
    Delete ${deletable.value.length}
  </button>
`;

/** Leads to what can be done with the selection. */
export function SelectionBar() {
  const [first] = selected.value;
  if (!first) return null;
  return html`
    <div class="selection-bar" role="group" aria-label="Selection">
      <button class="quiet" onClick=${clearSelection}>Clear</button>
      <button class="primary" onClick=${() => openDetails(first.id)}>
        ${selected.value.length > 1 ? `Look at these ${selected.value.length}` : "Look at this one"}
      </button>
    </div>
  `;
}
