// The menu of a run: all that can be done with it, and its files.
import { useEffect, useRef, useState } from "preact/hooks";
import { copySettings, pending, runAgain } from "../../actions.js";
import { deleteRun } from "../../run-deletions.js";
import { fillersOf, kindOf, rowsOfRuns, runRow, Slot } from "../../features.js";
import { downloads } from "../../files.js";
import { addressOf } from "../../page-state.js";
import { isActive, isOperator, isWalk, mayChange, mayStart } from "../../selectors.js";
import { html } from "../elements.js";
import { edit } from "./annotations.js";

/** @import { AnyRun } from "../../runs.js" */
/** @import { Run } from "../../types.js" */

const MARGIN_PX = 8;
/** The place of the files that each run has once it has ended. */
const OF_ENDED = "files of a run that has ended";

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
    // What features add to it may come later.
    const body = new ResizeObserver(() => place(current));
    body.observe(/** @type {HTMLElement} */ (current.querySelector(".menu-body")));
    // It stays in the window, and would be beside another run.
    const close = (/** @type {Event} */ { target }) =>
      !(target instanceof Node && current.contains(target)) && current.removeAttribute("open");
    addEventListener("scroll", close, true);
    addEventListener("resize", close);
    return () => {
      body.disconnect();
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
      <${Slot} name="files of a walk for operators" run=${run} />
    `}
    ${mayChange(run) && !isActive(run) && html`<${DeleteButton} run=${run} />`}
  `;
}

/** @param {{ run: Run }} props */
function Downloads({ run }) {
  const hasEnded = !isActive(run);
  const hasWalked = isWalk(run) && hasEnded && (run.progress.done > 0 || Boolean(run.result));
  const files = hasWalked || !isWalk(run) ? downloads(run) : [];
  const hasFiles = files.length > 0 || (hasEnded && fillersOf(OF_ENDED).length > 0);
  return html`
    <p class="menu-part dim">${hasFiles ? "Download" : "Nothing to download."}</p>
    ${files.map(([label, href]) => html`<a href=${href} download="">${label}</a>`)}
    ${hasWalked && html`<${Slot} name="files of a walk" run=${run} />`}
    ${hasEnded && html`<${Slot} name=${OF_ENDED} run=${run} />`}
  `;
}

/** @param {{ run: AnyRun }} props */
export const DeleteButton = ({ run }) => html`
  <button class="bad" disabled=${pending.value[run.id]} onClick=${() => deleteRun(run)}>Delete</button>
`;
