// The details beside the list: of one run, or of all that are selected.
import { pending, resumeRun, showOnStage } from "../../actions.js";
import { kindOf, Slot } from "../../features.js";
import { isPhone } from "../../page.js";
import { addressOf } from "../../page-state.js";
import { closeDetails, isOfSelection, isOpenedGone, subjects } from "../../run-details.js";
import { runGroups } from "../../run-list.js";
import { NO_SUCH_RUN, outcomeInWords, titleOf, withResult } from "../../run-words.js";
import { isOperator, isWalk } from "../../selectors.js";
import { isAway } from "../../store.js";
import { html, Icon, ProgressBar } from "../elements.js";
import { Problem } from "../foot.js";
import { ReplayLink } from "../replay-link.js";
import { Name, Notes, Tags } from "./annotations.js";
import { DeleteButton, RunMenu } from "./menu.js";
import { OneCurve, RaceResult, TrainingResult, Settings } from "./one.js";
import { State } from "./row.js";
import { Several } from "./several.js";

/** @import { AnyRun } from "../../runs.js" */
/** @import { DamagedRun, Run } from "../../types.js" */

export function Details() {
  const [first] = subjects.value;
  return html`
    <section class=${`details-column ${isPhone.value ? "over" : ""}`} aria-label="Details">
      ${isPhone.value && html`
        <button class="quiet back" onClick=${closeDetails}><${Icon} name="back" />Runs</button>
      `}
      ${detailsOf(first)}
    </section>
  `;
}

/** @param {AnyRun | undefined} first */
function detailsOf(first) {
  if (isOpenedGone.value) return html`<p class="dim nothing" role="status">${NO_SUCH_RUN}</p>`;
  if (!first) return html`<p class="dim nothing">Details of a run stand here.</p>`;
  if (isOfSelection.value) return html`<${Several} />`;
  return "damaged" in first ? html`<${Damaged} run=${first} />` : html`<${One} key=${first.id} run=${first} />`;
}

/** @param {{ run: DamagedRun }} props */
const Damaged = ({ run }) => html`
  <header class="details-head"><h2>${titleOf(run)}</h2><${State} state="damaged" /></header>
  <div class="details-body"><p class="bad">${run.damaged}</p><p class="dim">${run.id}</p></div>
  ${isOperator.value && html`
    <footer class="details-foot"><div class="row"><${DeleteButton} run=${run} /></div></footer>
  `}
`;

/** The name of a run by itself: with what it differs in from its group, where that is not in it. @param {Run} run */
function wholeName(run) {
  const title = titleOf(run);
  const group = runGroups.value.find(({ isSweep, rows }) => isSweep && rows.some((row) => row.run.id === run.id));
  const name = group?.rows.find((row) => row.run.id === run.id)?.name ?? title;
  return run.is_named || title.toLowerCase().includes(name.toLowerCase()) ? title : `${title}, ${name}`;
}

/** @param {{ run: Run }} props */
const One = ({ run }) => html`
  <header class="details-head">
    <${Name} run=${run} title=${withResult(wholeName(run), run)} />
    <p class="details-state"><${State} state=${run.state} run=${run} outcome=${outcomeInWords(run)} isTold /></p>
    <${RunMenu} run=${run} label="More actions" />
  </header>
  <div class="details-body">
    ${run.error && html`<p class="problem">${run.error}</p>`}
    ${run.kind === "training" && html`<${OneCurve} run=${run} /><${TrainingResult} run=${run} />`}
    ${run.kind === "race" && html`<${RaceResult} run=${run} />`}
    ${isWalk(run) ? html`<${Settings} run=${run} />` : html`<${OfKind} run=${run} />`}
    <div class="annotations"><${Tags} run=${run} /><${Notes} run=${run} /></div>
  </div>
  <${Foot} run=${run} />
`;

/** Of a run that is no walk, what its feature tells. @param {{ run: Run }} props */
function OfKind({ run }) {
  const kind = kindOf(run);
  if (!kind) return html`<p class="dim">It is kept. This server has left out what shows it.</p>`;
  const { share, label, left } = kind.paceOf(run);
  return html`
    <p>${kind.describe(run)}</p>
    <${ProgressBar} label=${kind.unit} share=${share} />
    <p class="dim">${label}${left && `, ${left}`}</p>
  `;
}

/** @param {{ run: Run }} props */
function Foot({ run }) {
  const isPending = pending.value[run.id] || isAway.value;
  const state = kindOf(run)?.stateOf(run.id);
  const canResume = isOperator.value && run.can_resume && run.state !== "paused";
  return html`
    <footer class="details-foot">
      <div class="row">
        ${canResume && html`
          <button class="secondary" disabled=${isPending} onClick=${() => resumeRun(run)}>Go on</button>
        `}
        ${isWalk(run) && isOperator.value && html`
          <button class="secondary" disabled=${isPending || run.state === "queued"}
            onClick=${() => showOnStage(run)} title="Everyone sees it">Show on the stage</button>
        `}
        <${Slot} name="actions on runs" runs=${[run]} />
      </div>
      ${isWalk(run) && run.progress.done > 0 && html`<${ReplayLink} id=${run.id}>Replay<//>`}
      ${state && html`<a class="to-report" href=${addressOf(state)}>Report</a>`}
      <${Problem} at=${run.id} />
    </footer>
  `;
}
