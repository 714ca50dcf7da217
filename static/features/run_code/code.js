// The dialog that shows a run as commands and as a Python program.
import { signal } from "@preact/signals";
import { useEffect, useState } from "preact/hooks";
import { copy } from "../../js/page.js";
import { getCode } from "./api.js";
import { messageOf } from "../../js/titles.js";
import { Dialog, html, Segments } from "../../js/components/elements.js";

/** @import { Signal } from "@preact/signals" */
/** @import { Run } from "../../js/types.js" */

/** The run whose code is shown; null before the first. @type {Signal<Run | null>} */
const shown = signal(null);
const isOpen = signal(false);

/** @param {Run} run */
export const showCode = (run) => {
  shown.value = run;
  isOpen.value = true;
};

const FORMS = [["command", "Command line"], ["python", "Python"]];

export const CodeDialog = () => shown.value && html`
  <${Dialog} id="code" style="code" labelledBy="code-title" isOpen=${isOpen}>
    ${isOpen.value && html`<${Code} run=${shown.value} key=${shown.value.id} />`}
  <//>
`;

/** @param {{ run: Run }} props */
function Code({ run }) {
  const [form, setForm] = useState("command");
  const [code, setCode] = useState(/** @type {Record<string, string> | null} */ (null));
  const [error, setError] = useState("");
  useEffect(() => {
    getCode(run.id).then(setCode, (failure) => setError(messageOf(failure)));
  }, []);
  return html`
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
