// Files of the run on stage, once it has ended.
import { downloads } from "../files.js";
import { shownRun } from "../on-stage.js";
import { isActive } from "../selectors.js";
import { html } from "./elements.js";
import { Slot } from "../features.js";

export function RunFiles() {
  const run = shownRun.value;
  if (!run || isActive(run) || !run.progress.done) return null;
  return html`
    <details class="more">
      <summary>Download this ${run.kind}</summary>
      <div class="own-choices">
        ${downloads(run).map(([label, href]) => html`<a class="to-report" href=${href} download="">${label}</a>`)}
        <${Slot} name="files of a walk" run=${run} look="to-report" />
      </div>
    </details>
  `;
}
