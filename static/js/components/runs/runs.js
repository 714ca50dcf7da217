// The view of all runs: the list with its filters on one side, the details of what was chosen on the other.
import { COLUMNS, shownColumns, toggleColumn } from "../../run-columns.js";
import { followDetails } from "../../run-details.js";
import { filters, followRunList, grouping, setFilters, setGrouping } from "../../run-list.js";
import { GROUPING_TITLES } from "../../run-groups.js";
import { followThumbnails } from "../../run-thumbnails.js";
import { page } from "../../page-state.js";
import { isPhone } from "../../page.js";
import { isOperator } from "../../selectors.js";
import { served } from "../../store.js";
import { html, Icon, Segments } from "../elements.js";
import { allKinds, Slot } from "../../features.js";
import { Details } from "./details.js";
import { List } from "./list.js";
import { SelectionBar } from "./selection.js";

/** @import { Changed } from "../../types.js" */

const KINDS = [["", "All"], ["training", "Trainings"], ["race", "Races"]];
const kinds = () => [...KINDS, ...allKinds().map(([name, { plural }]) => [name, plural])];
/** @type {[string, string][]} */
const STATES = ["running", "paused", "queued", "finished", "stopped", "failed", "interrupted"]
  .map((state) => [state, state]);
/** @type {[string, string][]} */
const SORTS = [
  ["newest", "newest first"], ["oldest", "oldest first"], ["name", "by name"], ["distance", "longest first"],
];

followRunList();
followThumbnails();
followDetails();

export function Runs() {
  const isCovered = isPhone.value && page.isOverList.value;
  return html`
    <div class="runs">
      <section class="list-column" aria-labelledby="runs-title" inert=${isCovered}>
        <${Head} />
        <${List} />
        ${isPhone.value && html`<${SelectionBar} />`}
      </section>
      ${(!isPhone.value || isCovered) && html`<${Details} />`}
      <${Slot} name="view of runs" />
    </div>
  `;
}

function Head() {
  const { kind, search } = filters.value;
  return html`
    <div class="runs-head">
      <h2 id="runs-title">Runs</h2>
      <input class="search" type="search" aria-label="Search names, ids, tags and notes"
        placeholder="Search" maxlength=${served().limits.name[1]} value=${search}
        onInput=${(/** @type {Changed} */ { target }) => setFilters({ search: target.value })} />
      <${Segments} label="Kind" choices=${kinds()} value=${kind}
        onValue=${(/** @type {string} */ value) => setFilters({ kind: value })} />
      <${Choice} label="Groups" choices=${Object.entries(GROUPING_TITLES)} value=${grouping.value}
        onValue=${setGrouping} />
      <${ViewMenu} />
      ${isOperator.value && html`<${Slot} name="head of the list of runs" />`}
    </div>
  `;
}

/** @param {{ label: string, choices: [string, string][], value: string, onValue: (value: string) => unknown }} props */
const Choice = ({ label, choices, value, onValue }) => html`
  <label class="choice">
    <span class="sr-only">${label}</span>
    <select onChange=${(/** @type {Changed} */ { target }) => onValue(target.value)}>
      ${choices.map(([choice, title]) => html`<option value=${choice} selected=${choice === value}>${title}</option>`)}
    </select>
  </label>
`;

/** What is seldom changed: the order, the state, and the columns. */
function ViewMenu() {
  const { state, sort } = filters.value;
  const shown = shownColumns.value;
  return html`
    <details class="menu view-menu">
      <summary class="quiet" title="Order, state and columns">
        <${Icon} name="columns" /><span>View</span>${state && html`<span class="badge">${state}</span>`}
      </summary>
      <div class="menu-body">
        <div class="field">
          <${Choice} label="Order" choices=${SORTS} value=${sort}
            onValue=${(/** @type {string} */ value) => setFilters({ sort: value })} />
          <${Choice} label="State" choices=${[["", "any state"], ...STATES]} value=${state}
            onValue=${(/** @type {string} */ value) => setFilters({ state: value })} />
        </div>
        <fieldset>
          <legend class="dim">Columns</legend>
          ${Object.entries(COLUMNS).map(([name, { title }]) => html`
            <label class="check" key=${name}>
              <input type="checkbox" checked=${shown.includes(name)} onChange=${() => toggleColumn(name)} />${title}
            </label>
          `)}
        </fieldset>
      </div>
    </details>
  `;
}
