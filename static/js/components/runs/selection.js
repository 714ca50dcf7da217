// The bar of the selection: how many runs are selected, and what can be done with all of them.
import { useState } from "preact/hooks";
import { pending } from "../../actions.js";
import { count } from "../../format.js";
import { addressOf } from "../../page-state.js";
import { shownRuns } from "../../run-list.js";
import {
  clearSelection, deletable, deleteSelected, exported, selectAll, selected, tagSelected,
} from "../../run-selection.js";
import { MAX_COMPARED } from "../../compare.js";
import { isOperator } from "../../selectors.js";
import { served } from "../../store.js";
import { html, Problem } from "../elements.js";
import { RaceThem } from "../compare/race-them.js";

/** @import { Changed } from "../../types.js" */

export function Selection() {
  const { length } = selected.value;
  const isAll = length === shownRuns.value.length;
  return html`
    <div class=${`selection ${length ? "on" : ""}`} role="group" aria-label="Selected runs">
      <label class="check">
        <input type="checkbox" checked=${isAll} indeterminate=${length > 0 && !isAll}
          onClick=${() => (isAll ? clearSelection() : selectAll())} />
        ${length ? `${count(length, "run")} selected` : "Select all"}
      </label>
      ${length > 0 && html`<${SelectionActions} />`}
      <${Problem} at="selection" />
    </div>
  `;
}

function SelectionActions() {
  const { count: exportable, most, address } = exported.value;
  return html`
    <${CompareThem} />
    <${RaceThem} runs=${selected.value} />
    ${address
      ? html`<a class="secondary compact button" href=${address} download>Export ${exportable}</a>`
      : html`<span class="dim">${exportable ? `An export has up to ${most} runs.` : "None has ended yet."}</span>`}
    ${isOperator.value && html`<${TagThem} />`}
    ${isOperator.value && deletable.value.length > 0 && html`<${DeleteThem} />`}
    <button class="quiet compact" onClick=${clearSelection}>Clear</button>
  `;
}

function CompareThem() {
  const ids = selected.value.filter(({ kind }) => kind !== "experiment").map(({ id }) => id);
  if (ids.length < 2) return null;
  if (ids.length > MAX_COMPARED) return html`<span class="dim">Up to ${MAX_COMPARED} runs compare.</span>`;
  const address = addressOf({ view: "compare", compared: ids });
  return html`<a class="secondary compact button" href=${address}>Compare ${ids.length}</a>`;
}

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

function DeleteThem() {
  const { length } = deletable.value;
  const ids = deletable.value.map(({ id }) => id).join();
  // The runs that were asked about: another selection is asked about again.
  const [sureOf, setSureOf] = useState("");
  const isSure = sureOf === ids;
  return html`
    <button class="secondary compact bad" disabled=${pending.value.selection}
      onClick=${() => (isSure ? deleteSelected() : setSureOf(ids))}>
      ${isSure ? `Delete ${count(length, "run")} for good?` : `Delete ${length}`}
    </button>
  `;
}
