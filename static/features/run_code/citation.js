// How to cite the run on stage, in the help.
import { useState } from "preact/hooks";
import { html } from "../../js/components/elements.js";
import { nameOf, t } from "../../js/format.js";
import { shownRun } from "../../js/on-stage.js";
import { linkTo } from "../../js/page-state.js";
import { copy } from "../../js/page.js";
import { version } from "../../js/store.js";
import { messageOf } from "../../js/titles.js";
import { getCode } from "./api.js";

/** @import { Run } from "../../js/types.js" */

/** How to name a run so that it can be repeated: the version, its seed, its hash and its command. */
export function Citation() {
  const run = shownRun.value;
  const [text, setText] = useState("");
  if (!run || !run.progress.done) return null;
  const cite = async () => {
    try {
      const { command } = await getCode(run.id);
      const words = citationOf(run, command);
      setText((await copy(words, t("Citation copied."))) ? t("Copied: {words}", { words }) : words);
    } catch (error) {
      setText(messageOf(/** @type {Error} */ (error)));
    }
  };
  return html`
    <h2>Cite this run</h2>
    <p class="dim">
      ${nameOf(run)}: version, seed, hash of what it learned or recorded, and the command that repeats it.
    </p>
    <p><button type="button" class="secondary compact" onClick=${cite}>Copy the citation</button></p>
    ${text && html`<pre class="citation" tabindex="0" role="region" aria-label="Citation">${text}</pre>`}
  `;
}

/** @type {(run: Run, command: string) => string} */
function citationOf(run, command) {
  const hash = run.result?.q_table_sha256 ?? run.result?.recording_sha256;
  return [
    `Racing Hexapods ${version.value}, ${run.kind} "${run.name}" (${run.id}), ${run.created_at.slice(0, 10)}`,
    `seed ${run.config.seed}${hash ? `, SHA-256 ${hash}` : ""}`,
    linkTo({ run: run.id }), command.trim(),
  ].join("\n");
}
