// The menu of a picture, with its downloads.
import { useState } from "preact/hooks";
import { html } from "./elements.js";

/** @import { ComponentChildren } from "preact" */

/** @typedef {"png" | "svg" | "csv"} FileKind */

/** @type {Record<FileKind, string>} */
const TITLES = { png: "Download as PNG", svg: "Download as SVG", csv: "Download its numbers as CSV" };

/**
 * `children` come before the downloads.
 * @param {{
 *   label: string, kinds: FileKind[], save: (kind: FileKind) => Promise<unknown>, children?: ComponentChildren
 * }} props
 */
export function FileMenu({ label, kinds, save, children }) {
  const [problem, setProblem] = useState("");
  /** @param {FileKind} kind */
  const download = (kind) => {
    setProblem("");
    save(kind).catch(() => setProblem("The file could not be made. Load the page again."));
  };
  return html`
    <details class="menu chart-menu">
      <summary class="quiet square small" aria-label=${label}>⋯</summary>
      <div class="menu-body">
        ${children}
        ${kinds.map((kind) => html`<button class="quiet" onClick=${() => download(kind)}>${TITLES[kind]}</button>`)}
        ${problem && html`<p class="bad" role="alert">${problem}</p>`}
      </div>
    </details>
  `;
}
