// The menu of a run: all that can be done with it, and its files.
import { useEffect, useRef, useState } from "preact/hooks";
import { attempt, copySettings, deleteRun, pending, runAgain } from "../../actions.js";
import { archiveAddress, downloads, notInstalled, rendered, saveExport } from "../../files.js";
import { listed } from "../../format.js";
import { addressOf } from "../../page-state.js";
import { isActive, isOperator, isWalk, mayChange, mayStart } from "../../selectors.js";
import { html } from "../elements.js";
import { edit } from "./annotations.js";
import { kindOf, rowsOfRuns, runRow } from "../../features.js";

/** @import { AnyRun } from "../../runs.js" */
/** @import { ExportOption, Run } from "../../types.js" */

const MARGIN_PX = 8;

/** Place the body of an open menu in the window, wherever its list is scrolled to. @param {HTMLDetailsElement} menu */
function place(menu) {
  const body = /** @type {HTMLElement} */ (menu.querySelector(".menu-body"));
  const { right, bottom } = menu.getBoundingClientRect();
  const lowest = innerHeight - body.offsetHeight - MARGIN_PX;
  body.style.top = `${Math.max(MARGIN_PX, Math.min(bottom + 4, lowest))}px`;
  body.style.right = `${Math.max(MARGIN_PX, document.documentElement.clientWidth - right)}px`;
}

/** @param {{ run: AnyRun, label: string }} props */
export function RunMenu({ run, label }) {
  const menu = useRef(/** @type {HTMLDetailsElement | null} */ (null));
  const [isOpen, setOpen] = useState(false);
  useEffect(() => {
    if (!isOpen || !menu.current) return undefined;
    const { current } = menu;
    place(current);
    // It stays in the window, and would be beside another run.
    const close = (/** @type {Event} */ { target }) =>
      !(target instanceof Node && current.contains(target)) && current.removeAttribute("open");
    addEventListener("scroll", close, true);
    addEventListener("resize", close);
    return () => {
      removeEventListener("scroll", close, true);
      removeEventListener("resize", close);
    };
  }, [isOpen]);
  return html`
    <details class="menu run-menu" ref=${menu}
      onToggle=${(/** @type {import("../../types.js").Toggled} */ { target }) => setOpen(target.open)}>
      <summary class="quiet square small" aria-label=${label}>⋯</summary>
      <div class="menu-body">
        ${isOpen && ("damaged" in run
          ? html`${isOperator.value && html`<${DeleteButton} run=${run} />`}`
          : html`<${Items} run=${run} />`)}
      </div>
    </details>
  `;
}

/** @param {Run} run */
const mayRunAgain = (run) => (isWalk(run) ? mayStart.value : isOperator.value && kindOf(run) !== null);

/** @param {{ run: Run }} props */
function Items({ run }) {
  const state = kindOf(run)?.stateOf(run.id);
  return html`
    ${state && html`<a href=${addressOf(state)}>Its report</a>`}
    ${mayStart.value && isWalk(run) && html`<a href="#" onClick=${() => copySettings(run)}>Use its settings</a>`}
    ${rowsOfRuns.value.map((row) => html`
      <button key=${row.title} onClick=${() => runRow(row, run)}>${row.title}</button>
    `)}
    ${mayRunAgain(run) && html`<button onClick=${() => runAgain(run)}>Run again</button>`}
    ${mayChange(run) && html`
      <button onClick=${() => edit(run, "name")}>Rename</button>
      <button onClick=${() => edit(run, "tags")}>${run.tags?.length ? "Change its tags" : "Add tags"}</button>
      <button onClick=${() => edit(run, "notes")}>${run.notes ? "Change its notes" : "Add notes"}</button>
    `}
    <${Downloads} run=${run} />
    ${isOperator.value && isWalk(run) && !isActive(run) && run.progress.done > 0 && html`
      ${rendered().map((file) => html`<${RenderButton} key=${file.title} run=${run} file=${file} />`)}
      ${notInstalled().map(([install, titles]) => html`
        <p class="dim">${listed(titles)}: not installed on the server; <code>${install}</code> adds it.</p>
      `)}
    `}
    ${mayChange(run) && !isActive(run) && html`<${DeleteButton} run=${run} />`}
  `;
}

/**
 * Has a file computed; the menu says so until it is there, and why there is none is told in the row.
 * @param {{ run: Run, file: ExportOption }} props
 */
function RenderButton({ run, file }) {
  const [isRendering, setRendering] = useState(false);
  const onClick = async () => {
    setRendering(true);
    await attempt(run.id, () => saveExport(run, file));
    setRendering(false);
  };
  return html`
    <button disabled=${pending.value[run.id]} onClick=${onClick} aria-live="polite">
      ${isRendering ? `${file.title}: being rendered…` : file.title}
    </button>
  `;
}

/** @param {{ run: Run }} props */
function Downloads({ run }) {
  const hasEnded = !isActive(run);
  const hasBegun = run.progress.done > 0 || run.result;
  const files = [
    ...(!isWalk(run) || (hasEnded && hasBegun) ? downloads(run) : []),
    ...(hasEnded ? [["Archive (zip)", archiveAddress(run)]] : []),
  ];
  return html`
    <p class="menu-part dim">${files.length ? "Download" : "Nothing to download."}</p>
    ${files.map(([label, href]) => html`<a href=${href} download>${label}</a>`)}
  `;
}

/** @param {{ run: AnyRun }} props */
export function DeleteButton({ run }) {
  const [isSure, setSure] = useState(false);
  return html`
    <button class="bad" disabled=${pending.value[run.id]} onClick=${() => (isSure ? deleteRun(run) : setSure(true))}>
      ${isSure ? "Delete for good?" : "Delete"}
    </button>
  `;
}
