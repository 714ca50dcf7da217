// The dialog that shows a run as commands and as a Python program.
import { signal } from "@preact/signals";
import { useEffect, useRef, useState } from "preact/hooks";
import { copy } from "../../share.js";
import { getCode } from "../../api.js";
import { messageOf } from "../../titles.js";
import { html, Segments } from "../elements.js";

/** @import { Run } from "../../types.js" */

/** The run whose code is shown; null while the dialog is closed. */
const shown = signal(/** @type {import("../../types.js").Run | null} */ (null));

/** @param {import("../../types.js").Run} run */
export const showCode = (run) => (shown.value = run);

const FORMS = [["command", "Command line"], ["python", "Python"]];

export const CodeDialog = () => shown.value && html`<${Dialog} run=${shown.value} key=${shown.value.id} />`;

/** @param {{ run: Run }} props */
function Dialog({ run }) {
  const dialog = useRef(/** @type {HTMLDialogElement | null} */ (null));
  const [form, setForm] = useState("command");
  const [code, setCode] = useState(/** @type {Record<string, string> | null} */ (null));
  const [error, setError] = useState("");
  useEffect(() => {
    dialog.current?.showModal();
    getCode(run.id).then(setCode, (failure) => setError(messageOf(failure)));
  }, []);
  const close = () => (shown.value = null);
  /** @param {MouseEvent} event */
  const onBackdrop = ({ target }) => target === dialog.current && close();
  return html`
    <dialog class="help code" ref=${dialog} onClose=${close} onClick=${onBackdrop} aria-labelledby="code-title">
      <div class="help-body">
        <div class="code-head">
          <h2 id="code-title">${run.name || "The run"} as code</h2>
          <${Segments} label="Form" choices=${FORMS} value=${form} onValue=${setForm} />
        </div>
        <p class="dim">It makes exactly this ${run.kind}, to the last bit; wall times aside.</p>
        ${code
          ? html`<pre tabindex="0" role="region" aria-label="Code"><code>${code[form]}</code></pre>`
          : html`<p role=${error ? "alert" : "status"}>${error || "Loading…"}</p>`}
        <form method="dialog">
          ${code && html`<${CopyButton} text=${code[form]} />`}
          <button class="secondary" autofocus>Close</button>
        </form>
      </div>
    </dialog>
  `;
}

/**
 * Copies a text; says so on itself, since a message of the page is under the dialog.
 * @param {{ text: string }} props
 */
function CopyButton({ text }) {
  const [words, setWords] = useState("Copy");
  const onClick = async () => setWords((await copy(text, "Code copied.")) ? "Copied" : "Select it to copy it");
  useEffect(() => setWords("Copy"), [text]);
  return html`<button type="button" class="secondary" onClick=${onClick} aria-live="polite">${words}</button>`;
}
