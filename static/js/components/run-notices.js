// Notices in the foot of the panel: a run that was interrupted or failed, or is not on the stage. Loaded when needed.
import { pending, resumeRun, showOnStage } from "../actions.js";
import { nameOf, said, sentence, t } from "../format.js";
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
      <p>
        ${run.kind === "race" ? t("The stage shows another run; your race goes on without a picture.")
          : t("The stage shows another run; your training goes on without a picture.")}
      </p>
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
      <p>
        <b>${run.kind === "race" ? t("The race failed.") : t("The training failed.")}</b>
        ${" "}${said(inFormWords(run.error ?? ""))}
      </p>
      <p>
        ${isOperator.value ? t("Change what it names, or let it go on from its last checkpoint.")
          : t("Change what it names.")}
        ${" "}${t("Other runs are not affected.")}
      </p>
      ${isOperator.value && run.can_resume && html`<${ResumeButton} run=${run} />`}
    </div>
  `;
}

/** Of the newest run, while another one is on stage: the stage offers to resume its own. */
function Interrupted() {
  const run = interruptedRun.value;
  if (!run) return null;
  const values = { run: sentence(run.kind), name: nameOf(run), step: run.progress.done, steps: run.progress.total };
  const words = run.kind === "training"
    ? t("{run} “{name}” was interrupted at step {step} of {steps}; it is not on the stage.", values)
    : t("{run} “{name}” was interrupted; it is not on the stage.", values);
  return html`
    <div class="notice">
      <p><b>${words}</b> ${said(run.error ?? "")}</p>
      <${ResumeButton} run=${run} />
    </div>
  `;
}
