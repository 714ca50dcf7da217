// The view of all runs: filters, order, selection, import, and the list.
import { useEffect, useState } from "preact/hooks";
import { isOperator } from "../../selectors.js";
import { dismissImport, importFiles, imports } from "../../run-import.js";
import {
  clearFilters, filters, followRunList, isFiltered, knownTags, runList, setFilters, shownRuns,
} from "../../run-list.js";
import { clearSelection, selectAll, setSelected } from "../../run-selection.js";
import { served } from "../../store.js";
import { html, Icon, Segments } from "../elements.js";
import { CodeDialog } from "./code.js";
import { RunRow } from "./row.js";
import { Selection } from "./selection.js";

/** @import { Changed } from "../../types.js" */

const KINDS = [["", "All"], ["training", "Trainings"], ["race", "Races"], ["experiment", "Experiments"]];
const STATES = ["running", "paused", "queued", "finished", "stopped", "failed", "interrupted"]
  .map((state) => [state, state]);
const SORTS = [
  ["newest", "newest first"], ["oldest", "oldest first"], ["name", "by name"], ["distance", "longest first"],
];
const MAX_TAGS = 12;

followRunList();

export function Runs() {
  const shown = shownRuns.value;
  const isDragging = useDrop();
  return html`
    <section class=${`panel runs ${isDragging ? "drop" : ""}`} aria-labelledby="runs-title"
      aria-busy=${runList.isLoading.value ? "true" : "false"}>
      <${Head} />
      <${Tags} />
      <${Imports} />
      ${shown.length > 0 && html`<${Selection} />`}
      ${shown.length === 0
        ? html`<${NoRuns} />`
        : html`
          <ul class="run-list" aria-label="Runs" onKeyDown=${moveByKey}>
            ${shown.map((run) => html`<${RunRow} key=${run.id} run=${run} />`)}
          </ul>
        `}
      <${More} />
      ${isDragging && html`<p class="drop-note" role="status">Drop to take in: archives of runs, or Q-tables</p>`}
      <${CodeDialog} />
    </section>
  `;
}

function Head() {
  const { kind, state, search, sort } = filters.value;
  return html`
    <div class="runs-head">
      <h2 id="runs-title">Runs</h2>
      ${isOperator.value && html`<${ImportButton} />`}
      <${Segments} label="Kind" choices=${KINDS} value=${kind}
        onValue=${(/** @type {string} */ value) => setFilters({ kind: value })} />
      <${Choice} label="State" choices=${[["", "any state"], ...STATES]} value=${state}
        onValue=${(/** @type {string} */ value) => setFilters({ state: value })} />
      <${Choice} label="Order" choices=${SORTS} value=${sort}
        onValue=${(/** @type {string} */ value) => setFilters({ sort: value })} />
      <input class="search" type="search" aria-label="Search names, ids, tags and notes"
        placeholder="Name, id, tag or note" maxlength=${served().limits.name[1]} value=${search}
        onInput=${(/** @type {Changed} */ { target }) => setFilters({ search: target.value })} />
    </div>
  `;
}

/** @param {{ label: string, choices: [string, string][], value: string, onValue: (value: string) => unknown }} props */
const Choice = ({ label, choices, value, onValue }) => html`
  <label class="choice">
    <span class="sr-only">${label}</span>
    <select onChange=${(/** @type {Changed} */ { target }) => onValue(target.value)}>
      ${choices.map(([one, title]) => html`<option value=${one} selected=${one === value}>${title}</option>`)}
    </select>
  </label>
`;

/** The tags in use, to filter by. */
function Tags() {
  const { tag } = filters.value;
  const known = knownTags.value.slice(0, MAX_TAGS);
  const all = tag === "" || known.includes(tag) ? known : [tag, ...known];
  if (all.length === 0) return null;
  return html`
    <div class="tags" role="group" aria-label="Tag">
      ${all.map((one) => html`
        <button key=${one} class="chip" aria-pressed=${one === tag ? "true" : "false"}
          onClick=${() => setFilters({ tag: one === tag ? "" : one })}>${one}</button>
      `)}
    </div>
  `;
}

// ---- what the list says where there is nothing to list

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
    Every training, race and experiment is kept here, with its curve, its table, its recording or its
    report. <a href="#">Start the first one</a>${isOperator.value && ", or drop the file of an exported one here"}.
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

// ---- import, by a button and by dropping files anywhere

function ImportButton() {
  /** @param {{ target: HTMLInputElement }} event */
  const onChange = ({ target }) => {
    importFiles([...target.files ?? []]);
    // So that the same file can be chosen again.
    target.value = "";
  };
  return html`
    <label class="file-button">
      <${Icon} name="import" />Import…
      <input class="sr-only" type="file" multiple accept=".zip,.npz" onChange=${onChange} />
    </label>
  `;
}

const Imports = () => html`
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

/** Take in files that are dropped on the page while this view is open; whether files are dragged over it. */
function useDrop() {
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
  return isDragging;
}

// ---- keys in the list, while the box of a run has the focus

/** @type {Record<string, number>} */
const STEPS = { ArrowDown: 1, ArrowUp: -1 };

/**
 * Up and down go to the next run, with Shift they select it too; Ctrl+A selects all, Escape none.
 * @param {KeyboardEvent & { target: HTMLInputElement, currentTarget: HTMLElement }} event
 */
function moveByKey(event) {
  const { key, target, shiftKey } = event;
  if (!target.matches(".run-box input")) return;
  if (key in STEPS) {
    const boxes = /** @type {HTMLInputElement[]} */ ([...event.currentTarget.querySelectorAll(".run-box input")]);
    const next = boxes[boxes.indexOf(target) + STEPS[key]];
    if (next && shiftKey) {
      setSelected(target.value, true);
      setSelected(next.value, true, true);
    }
    next?.focus();
  } else if (key === "a" && (event.ctrlKey || event.metaKey)) selectAll();
  else if (key === "Escape") clearSelection();
  else return;
  event.preventDefault();
}
