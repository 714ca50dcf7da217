// The numbers of a chart as a table, folded.
import { useState } from "preact/hooks";
import { html } from "../html.js";
import { thinned } from "../scale.js";

const MOST_ROWS = 100;

export function AsTable({ caption, columns, rows }) {
  const [isOpen, setOpen] = useState(false);
  return html`
    <details class="as-table" onToggle=${({ target }) => setOpen(target.open)}>
      <summary>As a table</summary>
      ${isOpen && html`
        <div class="scroller" tabindex="0" role="region" aria-label=${caption}>
          <table>
            <caption class="sr-only">${caption}</caption>
            <thead><tr>${columns.map((title) => html`<th scope="col">${title}</th>`)}</tr></thead>
            <tbody>${thinned(rows, MOST_ROWS).map((cells) => html`<${Row} cells=${cells} />`)}</tbody>
          </table>
        </div>
      `}
    </details>
  `;
}

const Row = ({ cells: [first, ...others] }) => html`
  <tr><th scope="row">${first}</th>${others.map((one) => html`<td>${one}</td>`)}</tr>
`;
