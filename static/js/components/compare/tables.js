// Results and settings of compared runs side by side, a column for each run.
import { signal } from "@preact/signals";
import { comparable, comparedResults, comparedSettings } from "../../compare.js";
import { html } from "../elements.js";
import { Key } from "./key.js";

/** @import { Changed } from "../../types.js" */
/** @import { Row } from "../../compare.js" */

const isOnlyDifferent = signal(false);

export const Results = () => html`
  <section class="panel" aria-labelledby="compare-results">
    <h2 id="compare-results">Results</h2>
    <${Columns} label="Results" rows=${comparedResults.value} />
  </section>
`;

export function Settings() {
  const rows = comparedSettings.value;
  const different = rows.filter(({ differs }) => differs);
  const shown = isOnlyDifferent.value ? different : rows;
  return html`
    <section class="panel" aria-labelledby="compare-settings">
      <div class="compare-head">
        <h2 id="compare-settings">Settings</h2>
        <span class="dim">${different.length} of ${rows.length} differ</span>
        <label class="check">
          <input type="checkbox" checked=${isOnlyDifferent.value}
            onChange=${(/** @type {Changed} */ { target }) => (isOnlyDifferent.value = target.checked)} />
          Only differences
        </label>
      </div>
      ${shown.length > 0
        ? html`<${Columns} label="Settings" rows=${shown} isMarked />`
        : html`<p class="dim">All their settings are the same.</p>`}
    </section>
  `;
}

/** `isMarked`: rows that differ are marked. @param {{ label: string, rows: Row[], isMarked?: boolean }} props */
const Columns = ({ label, rows, isMarked = false }) => html`
  <div class="scroller" tabindex="0" role="region" aria-label=${`${label} side by side`}>
    <table class="side-by-side" style=${{ "--columns": comparable.value.length }}>
      <thead>
        <tr>
          <td></td>
          ${comparable.value.map((entry) => html`
            <th scope="col" key=${entry.id}>
              <${Key} one=${entry} /> <span class="column-title">${entry.title}</span></th>
          `)}
        </tr>
      </thead>
      <tbody>
        ${rows.map((row) => html`
          <tr key=${row.name} class=${isMarked && row.differs ? "differs" : ""}>
            <th scope="row">
              ${row.title}${isMarked && row.differs && html`<span class="sr-only">, differs</span>`}
            </th>
            ${row.cells.map((text, n) => html`
              <td class=${row.best.includes(n) ? "best" : ""}>
                ${text ?? "–"}${row.best.includes(n) && html`<span class="sr-only">, the farthest</span>`}
              </td>
            `)}
          </tr>
        `)}
      </tbody>
    </table>
  </div>
`;
