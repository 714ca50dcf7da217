// The list: what all of it has on top, its groups with their notes, and what it says where there is nothing.
import { useEffect, useRef } from "preact/hooks";
import { count } from "../../format.js";
import { COLUMNS, shownColumns } from "../../run-columns.js";
import {
  clearFilters, filters, isFiltered, knownTags, listedRuns, runGroups, runList, setFilters,
} from "../../run-list.js";
import { clearSelection, selectAll, selected, setSelected } from "../../run-selection.js";
import { connection, requestRun } from "../../store.js";
import { Deletions } from "../deletions.js";
import { html } from "../elements.js";
import { Slot } from "../../features.js";
import { RunRow } from "./row.js";

/** @import { Group } from "../../run-groups.js" */

const MAX_TAGS = 12;

export function List() {
  const groups = runGroups.value;
  const widths = shownColumns.value.map((name) => COLUMNS[name].width);
  const style = {
    "--columns": widths.map((width) => `${width}rem`).join(" "),
    "--columns-width": `calc(${widths.reduce((sum, width) => sum + width, 0)}rem + ${widths.length} * var(--row-gap))`,
  };
  const body = useRef(/** @type {HTMLElement | null} */ (null));
  const isThere = groups.length > 0;
  // What a link opens or selects may be far down.
  useEffect(() => {
    body.current?.querySelector(".run.open, .run:has(.run-box :checked)")?.scrollIntoView({ block: "nearest" });
    // Names stay in view where columns need more room than there is.
    if (body.current) body.current.scrollLeft = 0;
  }, [isThere]);
  return html`
    <div class="list-body" ref=${body} style=${style} aria-busy=${runList.isLoading.value ? "true" : "false"}>
      ${groups.length > 0 && html`<${Titles} />`}
      ${connection.value === "reconnecting" && html`
        <p class="cut-off-note" role="status">
          <span class="spinner" aria-hidden="true"></span>Reconnecting. This is the last known state.
        </p>
      `}
      <${Deletions} kind="runs" take=${requestRun} />
      <${Tags} />
      <${Slot} name="list of runs" />
      ${groups.length === 0
        ? html`<${NoRuns} />`
        : html`
          <div class="groups" onKeyDown=${moveByKey}>
            ${groups.map((group) => html`<${GroupOfRuns} key=${group.key} group=${group} />`)}
          </div>
        `}
      <${More} />
    </div>
  `;
}

/** Selects all, and names the columns. */
function Titles() {
  const { length } = selected.value;
  const isAll = length === listedRuns.value.length;
  return html`
    <div class="titles">
      <label class="check select-all">
        <input type="checkbox" checked=${isAll} indeterminate=${length > 0 && !isAll}
          onClick=${() => (isAll ? clearSelection() : selectAll())} />
        ${length ? `${count(length, "run")} selected` : "Select all"}
      </label>
      ${length > 0 && html`<button class="link clear" onClick=${clearSelection}>Clear</button>`}
      ${shownColumns.value.map((name) => html`
        <span class="title" key=${name} aria-hidden="true">${COLUMNS[name].title}</span>
      `)}
    </div>
  `;
}

// ---- groups

/** @param {{ group: Group }} props */
function GroupOfRuns({ group: { title, facts, rows, isSweep } }) {
  const notes = isSweep ? rows.flatMap(({ run, name }) => ("notes" in run && run.notes ? [{ run, name }] : [])) : [];
  return html`
    <section class="group">
      ${title && html`
        <div class="group-head">
          <h3>${title}</h3><p class="dim">${facts.join(" · ")}</p>
          ${notes.map(({ run, name }) => html`
            <p class="kept" key=${run.id}>${notes.length > 1 && html`<b>${name}: </b>`}${firstLine(run.notes)}</p>
          `)}
        </div>
      `}
      <ul aria-label=${title ? `Runs: ${title}` : "Runs"}>
        ${rows.map((row) => html`<${RunRow} key=${row.run.id} row=${row} hasNote=${!isSweep} />`)}
      </ul>
    </section>
  `;
}

/** @param {string} text */
const firstLine = (text) => text.split("\n")[0];

/** The tags in use, to filter by. */
function Tags() {
  const { tag } = filters.value;
  const commonTags = knownTags.value.slice(0, MAX_TAGS);
  const all = tag === "" || commonTags.includes(tag) ? commonTags : [tag, ...commonTags];
  if (all.length === 0) return null;
  return html`
    <div class="tags" role="group" aria-label="Tag">
      ${all.map((name) => html`
        <button key=${name} class="tag-chip" aria-pressed=${name === tag ? "true" : "false"}
          onClick=${() => setFilters({ tag: name === tag ? "" : name })}>${name}</button>
      `)}
    </div>
  `;
}

// ---- where there is nothing to list, or more

function NoRuns() {
  if (runList.error.value) return null;
  if (!runList.isListed.value) {
    return html`<p class="no-runs" role="status"><span class="spinner" aria-hidden="true"></span> Loading…</p>`;
  }
  if (!isFiltered.value) return html`<div class="no-runs"><${FirstVisit} /></div>`;
  return html`
    <div class="no-runs">
      <p role="status">No run matches these filters.</p>
      <button class="secondary" onClick=${clearFilters}>Show all runs</button>
    </div>
  `;
}

const FirstVisit = () => html`
  <p><b>No runs yet.</b></p>
  <p>
    Every run is kept here, with its curve, its table, its recording or its
    report. <a href="#">Start the first one</a><${Slot} name="first run" />.
  </p>
`;

function More() {
  const { error, hasMore, isLoading, loadMore } = runList;
  if (!hasMore.value && !error.value) return null;
  const isNewest = filters.value.sort === "newest";
  return html`
    <div class="older">
      <p role="alert">${error}</p>
      <button class="secondary" aria-disabled=${isLoading.value ? "true" : undefined} onClick=${loadMore}>
        ${error.value ? "Try again" : `Show ${isNewest ? "older" : "more"} runs`}
      </button>
      ${error.value && isFiltered.value && html`
        <button class="secondary" onClick=${clearFilters}>Show all runs</button>
      `}
    </div>
  `;
}

// ---- keys in the list, while the box or the name of a run has the focus

/** @type {Record<string, number>} */
const STEPS = { ArrowDown: 1, ArrowUp: -1 };
const STOPS = [".run-box input", ".run-open"];

/**
 * Up and down go to the next run, with Shift they select it too; Ctrl+A selects all, Escape none.
 * @param {KeyboardEvent & { target: HTMLElement, currentTarget: HTMLElement }} event
 */
function moveByKey(event) {
  const { key, target, shiftKey } = event;
  const stop = STOPS.find((selector) => target.matches(selector));
  if (!stop) return;
  if (key in STEPS) {
    const all = /** @type {HTMLElement[]} */ ([...event.currentTarget.querySelectorAll(stop)]);
    const next = all[all.indexOf(target) + STEPS[key]];
    if (next && shiftKey) {
      setSelected(idOf(target), true);
      setSelected(idOf(next), true, true);
    }
    next?.focus();
  } else if (key === "a" && (event.ctrlKey || event.metaKey)) selectAll();
  else if (key === "Escape") clearSelection();
  else return;
  event.preventDefault();
}

/** The id of the run in whose row an element is. @param {HTMLElement} element */
function idOf(element) {
  const box = element.closest(".run")?.querySelector(".run-box input");
  return box instanceof HTMLInputElement ? box.value : "";
}
