// A table of a result: a row for each setting, agent or place, with values, intervals, and strips with every seed.
import { useRef, useState } from "preact/hooks";
import { count } from "../../../js/format.js";
import { DotStrip } from "../../../js/components/dot-strip.js";
import { html } from "../../../js/components/elements.js";
import { FileMenu } from "../../../js/components/charts.js";
import { isPrinting } from "../printing.js";

/** @import { OnSeed } from "./all-findings.js" */
/** @import { FileKind } from "../../../js/components/charts.js" */
/** @import { Cell, Strip } from "../result-cells.js" */
/** @import { Column, Row, Table } from "../result-tables.js" */
/** @import { ComponentChildren } from "preact" */

const MAX_ROWS = 60;

/**
 * `name` of its file; a table with strips can be saved as a picture, with the legend of its panel.
 * @param {{ table: Table, name?: string, onSeed?: OnSeed | null }} props
 */
export function ResultTable({ table: { caption, title, heads, columns, groups }, name = caption, onSeed = null }) {
  const [isWhole, setWhole] = useState(false);
  const frame = useRef(/** @type {HTMLElement | null} */ (null));
  const strips = columns.filter(({ isStrip }) => isStrip).length;
  const number = groups.reduce((sum, { rows }) => sum + rows.length, 0);
  const isCut = number > MAX_ROWS && groups.length === 1 && !isWhole && !isPrinting.value;
  /** @param {FileKind} kind */
  const save = async (kind) => {
    const { saveTable } = await import("../../../js/components/table-files.js");
    const element = /** @type {HTMLTableElement} */ (frame.current?.querySelector("table"));
    const legend = element.closest(".panel")?.querySelector(".strip-key") ?? null;
    await saveTable(/** @type {"png" | "svg"} */ (kind), { table: element, legend, title: name });
  };
  return html`
    <div class="result-table" ref=${frame}>
      ${title && html`<h3>${title}</h3>`}
      ${strips > 0 && html`<${FileMenu} label=${`Download ${name}`} kinds=${["png", "svg"]} save=${save} />`}
      <div class="scroller" tabindex="0" role="region" aria-label=${`Table: ${caption}`}>
        <table class="facts-table stacking" role="table" style=${{ "--strips": strips }}>
          <caption class="sr-only">${caption}</caption>
          <thead role="rowgroup"><tr role="row">
            ${heads.map((head) => html`<th role="columnheader" scope="col">${head}</th>`)}
            ${columns.map((column) => html`<${Head} ...${column} />`)}
          </tr></thead>
          ${groups.map((group) => html`
            <tbody role="rowgroup">
              ${(isCut ? group.rows.slice(0, MAX_ROWS) : group.rows).map((row, n) => html`
                <${TableRow} key=${row.key} row=${row} columns=${columns} onSeed=${onSeed}>
                  ${n === 0 && group.title && html`
                    <th role="rowheader" class="group-name" scope="rowgroup" rowspan=${group.rows.length}>
                      <${Name} title=${group.title} note=${group.note} />
                    </th>
                  `}
                <//>
              `)}
            </tbody>
          `)}
        </table>
      </div>
      ${isCut && html`
        <div class="older">
          <button class="secondary" onClick=${() => setWhole(true)}>Show all ${count(number, "setting")}</button>
        </div>
      `}
    </div>
  `;
}

/** @param {Column} props */
const Head = ({ title, words, isStrip }) => html`
  <th role="columnheader" scope="col" class=${isStrip ? "wide-cell" : undefined} title=${words}>${title}</th>
`;

/** @param {{ title: string, note?: string }} props */
const Name = ({ title, note }) => html`${title}${note && html` <span class="dim">${note}</span>`}`;

/** `children`: the name of its group. */
/** @param {{ row: Row, columns: Column[], onSeed: OnSeed | null, children: ComponentChildren }} props */
const TableRow = ({ row: { title, note, color, isDim, cells }, columns, onSeed, children }) => html`
  <tr role="row" class=${isDim ? "dim-row" : undefined} style=${color && { "--agent": color }}>
    ${children}
    <th role="rowheader" scope="row">
      ${color && html`<i class="swatch"></i> `}<${Name} title=${title} note=${note} />
    </th>
    ${cells.map((cell, n) => html`<${TableCell} cell=${cell} column=${columns[n]} onSeed=${onSeed} />`)}
  </tr>
`;

/** @param {{ cell: Cell, column: Column, onSeed: OnSeed | null }} props */
function TableCell({ cell: { text, note, printed, isBold, badge, strip }, column: { title, isStrip }, onSeed }) {
  const style = ["num", isStrip && "wide-cell", !text && !note && "no-value"].filter(Boolean).join(" ");
  return html`
    <td role="cell" data-label=${title} class=${style}>
      <p class="cell-words">
        ${isBold ? html`<b>${text}</b>` : text ?? (note ? "" : "–")}
        ${badge && html` <span class="first">${badge}</span>`}
        ${note && html` <span class="dim">${note}</span>`}
      </p>
      ${strip && html`<${SeedStrip} strip=${strip} onSeed=${onSeed} />`}
      ${printed && html`<p class="printed dim">${printed}</p>`}
    </td>
  `;
}

/** @param {{ strip: Strip, onSeed: OnSeed | null }} props */
function SeedStrip({ strip: { source, ...strip }, onSeed }) {
  const onDot = source && onSeed && ((/** @type {number} */ n) => onSeed(source.setting, source.points_m[n] ?? NaN));
  return html`<${DotStrip} ...${strip} onDot=${onDot ?? null} />`;
}
