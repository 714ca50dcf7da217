// Files of a run's walk: links to those that the server streams, and buttons for those that it renders.
import { useState } from "preact/hooks";
import { attempt, pending } from "../../js/actions.js";
import { html } from "../../js/components/elements.js";
import { listed } from "../../js/format.js";
import { notInstalled, rendered, saveExport, walkFiles } from "./files.js";

/** @import { ExportOption, Run } from "../../js/types.js" */

/** @param {{ run: Run, look?: string }} props */
export const WalkFiles = ({ run, look }) =>
  walkFiles(run).map(([label, href]) => html`<a key=${label} class=${look} href=${href} download="">${label}</a>`);

/** @param {{ run: Run }} props */
export const RenderedFiles = ({ run }) => html`
  ${rendered().map((file) => html`<${RenderButton} key=${file.title} run=${run} file=${file} />`)}
  ${notInstalled().map(([install, titles]) => html`
    <p class="dim">${listed(titles)}: not installed on the server; <code>${install}</code> adds it.</p>
  `)}
`;

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
