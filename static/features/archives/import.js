// Import of runs: by a button, by dropping files anywhere, and what came of each file.
import { useEffect, useState } from "preact/hooks";
import { html, Icon } from "../../js/components/elements.js";
import { isOperator } from "../../js/selectors.js";
import { dismissImport, importFiles, imports } from "./imports.js";

export function ImportButton() {
  /** @param {{ target: HTMLInputElement }} event */
  const onChange = ({ target }) => {
    importFiles([...target.files ?? []]);
    // So that the same file can be chosen again.
    target.value = "";
  };
  return html`
    <label class="file-button" title="Import archives of runs, or Q-tables">
      <${Icon} name="import" /><span>Import…</span>
      <input class="sr-only" type="file" multiple accept=".zip,.npz" onChange=${onChange} />
    </label>
  `;
}

export const Imports = () => html`
  <ul class="imports" aria-label="Imports" aria-live="polite">
    ${imports.value.map(({ key, name, state, words }) => html`
      <li key=${key} class=${state === "refused" ? "problem" : "notice"}>
        <span>
          ${state === "busy" && html`<span class="spinner" aria-hidden="true"></span>`} <b>${name}</b> ${words}
        </span>
        ${state !== "busy" && html`
          <button class="quiet square small" aria-label="Dismiss" onClick=${() => dismissImport(key)}>✕</button>
        `}
      </li>
    `)}
  </ul>
`;

export const DropHint = () => isOperator.value && html`, or drop the file of an exported one here`;

/** Takes in files that are dropped on the page while this view is open, and says so while files are dragged over it. */
export function Drop() {
  const [isDragging, setDragging] = useState(false);
  useEffect(() => {
    /** @param {DragEvent} event */
    const hasFiles = (event) => isOperator.peek() && event.dataTransfer?.types.includes("Files");
    /** @type {Record<string, (event: any) => unknown>} */
    const listeners = {
      dragover(event) {
        if (!hasFiles(event)) return;
        event.preventDefault();
        setDragging(true);
      },
      dragleave: ({ relatedTarget }) => relatedTarget === null && setDragging(false),
      drop(event) {
        if (!hasFiles(event)) return;
        event.preventDefault();
        setDragging(false);
        importFiles([...event.dataTransfer.files]);
      },
    };
    for (const [name, listener] of Object.entries(listeners)) addEventListener(name, listener);
    return () => {
      for (const [name, listener] of Object.entries(listeners)) removeEventListener(name, listener);
    };
  }, []);
  return isDragging &&
    html`<p class="drop-note" role="status">Drop to take in: archives of runs, or Q-tables</p>`;
}
