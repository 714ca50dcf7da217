// Notices in the foot of the panel: a run that was interrupted or failed, or is not on the stage. Loaded when needed.
import { pending, resumeRun, showOnStage } from "../actions.js";
import { sentence, whole } from "../format.js";
import { interruptedRun, offStage, shownRun } from "../on-stage.js";
import { isOperator, mayChange } from "../selectors.js";
import { isAway } from "../store.js";
import { inFormWords } from "../titles.js";
import { html } from "./elements.js";
import { Problem } from "./foot.js";

/** @import { Run } from "../types.js" */

export const RunNotices = () => html`<${Interrupted} /><${Failure} /><${OffStage} />`;

function OffStage() {
  const run = offStage.value;
  if (!run) return null;
  return html`
    <div class="notice">
      <p>The stage shows another run; your ${run.kind} goes on without a picture.</p>
      <button class="secondary" onClick=${() => showOnStage(run)}>Show on the stage</button>
      <${Problem} at=${run.id} />
    </div>
  `;
}

/** @param {{ run: Run }} props */
const ResumeButton = ({ run }) => html`
  <button class="secondary" disabled=${pending.value[run.id] || isAway.value} onClick=${() => resumeRun(run)}>
    Go on
  </button>
  <${Problem} at=${run.id} />
`;

function Failure() {
  const run = shownRun.value;
  if (run?.state !== "failed" || !mayChange(run)) return null;
  return html`
    <div class="notice bad">
      <p><b>The ${run.kind} failed.</b> ${inFormWords(run.error ?? "")}</p>
      <p>
        Change what it names${isOperator.value && ", or let it go on from its last checkpoint"}. Other runs are not
        affected.
      </p>
      ${isOperator.value && run.can_resume && html`<${ResumeButton} run=${run} />`}
    </div>
  `;
}

/** Of the newest run, while another one is on stage: the stage offers to resume its own. */
function Interrupted() {
  const run = interruptedRun.value;
  if (!run) return null;
  const { done, total } = run.progress;
  const where = run.kind === "training" ? ` at step ${whole(done)} of ${whole(total)}` : "";
  return html`
    <div class="notice">
      <p><b>${sentence(run.kind)} “${run.name}” was interrupted${where}; it is not on the stage.</b> ${run.error}</p>
      <${ResumeButton} run=${run} />
    </div>
  `;
}
