// The report of one experiment. It fills while trials end.
import { useMemo } from "preact/hooks";
import { pending, runAgain } from "../../../js/actions.js";
import { getComparison, getFigure } from "../api.js";
import { setFormOf } from "../form.js";
import { forgetPreset } from "../presets.js";
import { command, deleteExperiment, summary, summaryError } from "../runs.js";
import { showSeed } from "../seeds.js";
import { configInWords, findingIn } from "../words.js";
import { downloads, partOf } from "../../../js/files.js";
import { addressOf, page } from "../../../js/page-state.js";
import { isActive, isOperator } from "../../../js/selectors.js";
import { saveFile } from "../../../js/save-file.js";
import { messageOf } from "../../../js/titles.js";
import { html, Icon, ProgressBar } from "../../../js/components/elements.js";
import { Problem } from "../../../js/components/foot.js";
import { editHere, EditorOf, isEdited } from "../../../js/components/runs/annotations.js";
import { Findings } from "./all-findings.js";
import { formIsOpen, unsayable } from "./dialog.js";
import { Seeds } from "./seeds.js";
import { StateOf } from "./state-of.js";
import { paceOf, runTitle } from "../feature.js";

/** @import { Run, State, Verb } from "../../../js/types.js" */
/** @import { ComponentChildren } from "preact" */
/** @import { SaveFigure } from "./two-settings.js" */

/** Id of the menu from which name, tags and notes are changed. */
const MORE = "more-of-report";

/** @param {{ run: Run }} props */
export function Report({ run }) {
  const newest = summary.value;
  // Progress changes several times a second, the summary seldom.
  const findings = useMemo(() => html`
    <${Findings} summary=${newest} onSeed=${showSeed} compare=${comparisonOf(run.id)} saveFigure=${figureOf(run.id)}>
      <${Seeds} summary=${newest} />
    <//>
  `, [newest, run.id]);
  const hasSeeds = newest?.settings?.some(({ n }) => n > 0);
  const finding = findingIn(newest);
  return html`
    <section class="report" aria-label=${`Experiment: ${runTitle(run)}`}>
      <${ReportHead} run=${run} />
      <div class="report-body" tabindex="0" role="group" aria-label="Report, to be scrolled">
        <${Progress} run=${run} />
        <${Note} run=${run} />
        <${Problem} at=${run.id} />
        ${summaryError.value && html`<p class="problem" role="alert">${messageOf(summaryError.value)}</p>`}
        <div class="gist">
          ${finding && html`<p class="finding" role="heading" aria-level="3">${soFar(run)}${finding}</p>`}
          <p class="dim">${configInWords(run.config)}</p>
          <${OwnWords} run=${run} />
        </div>
        ${hasSeeds ? findings : html`<${Waiting} run=${run} />`}
      </div>
    </section>
  `;
}

/** @param {string} id */
const comparisonOf = (id) => (/** @type {string} */ a, /** @type {string} */ b) => getComparison(id, a, b);

/** Save a figure of an experiment for a paper. @param {string} id @returns {SaveFigure} */
const figureOf = (id) => async (kind, columns, settings) => {
  const query = new URLSearchParams({ kind, columns });
  for (const key of settings) query.append("setting", key);
  saveFile(await getFigure(id, query), `${kind}-${id}.zip`);
};

/** Its tags and notes. @param {{ run: Run }} props */
function OwnWords({ run }) {
  const tags = (run.tags ?? []).join(", ");
  return html`
    ${isEdited(run, "tags")
      ? html`<${EditorOf} run=${run} field="tags" opener=${MORE} />`
      : tags && html`<p class="dim">Tags: ${tags}</p>`}
    ${isEdited(run, "notes")
      ? html`<${EditorOf} run=${run} field="notes" opener=${MORE} />`
      : run.notes && html`<p class="notes">${run.notes}</p>`}
  `;
}

/** @param {Run} run */
const soFar = (run) => run.state !== "finished" && html`<span class="so-far">So far: </span>`;

/** @type {Partial<Record<State, string>>} */
const WORDS = {
  queued: "Waiting in the queue.",
  running: "Waiting for the first trials. Agents that look ahead come first, then one seed after the other.",
  paused: "Paused before the first trial ended.",
  failed: "No trial was completed.",
};

/** @param {{ run: Run }} props */
const Waiting = ({ run }) => html`
  <section class="panel waiting" aria-label="Report">
    <div class="no-rows" aria-hidden="true">${[0, 1, 2, 3].map(() => html`<i></i>`)}</div>
    <p class="dim">${WORDS[run.state] ?? "No trial was completed before the experiment ended."}</p>
  </section>
`;

// ---- the head: the experiment's name and state, and what can be done with it

/** @param {{ run: Run }} props */
const ReportHead = ({ run }) => html`
  <div class="report-head">
    <button class="quiet back-to-list" onClick=${() => (page.report.value = null)}>
      <span aria-hidden="true">‹</span> Back
    </button>
    <div class="report-name">
      ${isEdited(run, "name")
        ? html`<${EditorOf} run=${run} field="name" opener=${MORE} />`
        : html`<h2>${runTitle(run)}</h2>`}
      <${StateOf} run=${run} />
    </div>
    <${Commands} run=${run} />
    <${Actions} run=${run} />
  </div>
`;

/** @param {{ run: Run }} props */
function Progress({ run }) {
  if (!isActive(run) && !["interrupted", "stopped"].includes(run.state)) return null;
  const pace = paceOf(run);
  return html`
    <div class="progress">
      <p><span class="num">${pace.label}</span><span class="dim num">${pace.left}</span></p>
      <${ProgressBar} label="Trials that are done" share=${pace.share} />
    </div>
  `;
}

/** @type {Partial<Record<State, string>>} */
const NOTES = {
  paused: "Paused. Finished trials are kept, and no core is used.",
  stopped: "Stopped. Resume to run only the rest.",
  interrupted: "The server ended before the experiment did. Finished trials are kept; resume to run only the rest.",
};

/** @param {{ run: Run }} props */
function Note({ run }) {
  if (run.state === "failed") {
    return html`
      <div class="notice bad">
        <p><b>The experiment failed.</b> ${run.error}</p>
        <p>Trials that were done before are kept below; resume to run only the rest.</p>
      </div>
    `;
  }
  if (!NOTES[run.state]) return null;
  const isStopped = run.state === "stopped";
  const covered = isStopped && hasReport(run) ? "The report covers the completed trials." : "";
  return html`<p class="notice">${NOTES[run.state]} ${covered} ${isStopped && run.error}</p>`;
}

/** What steers it; on a phone by pictures alone, so that all fit in a line. @param {{ run: Run }} props */
const Commands = ({ run }) => isOperator.value && html`
  <div class="report-commands">
    ${run.state === "running" && html`<${CommandButton} run=${run} verb="pause" icon="pause" title="Pause" />`}
    ${run.can_resume && html`<${CommandButton} run=${run} verb="resume" icon="play" title="Resume" />`}
    ${isActive(run) && html`<${CommandButton} run=${run} verb="stop" icon="stop" title="Stop" />`}
  </div>
`;

/** @param {{ run: Run }} props */
const Actions = ({ run }) => html`
  <div class="report-actions">
    ${isOperator.value && html`
      <button class="secondary compact" onClick=${() => repeatWith(run)}>Repeat with…</button>
    `}
    <${Menu} title="Files"><${Files} run=${run} /><//>
    ${isOperator.value && html`
      <${Menu} title="⋯" id=${MORE} label="More about this experiment">
        <button disabled=${pending.value[run.id]} onClick=${() => runAgain(run)}>Run again</button>
        <button onClick=${() => editHere(run, "name")}>Rename</button>
        <button onClick=${() => editHere(run, "tags")}>${run.tags?.length ? "Change its tags" : "Add tags"}</button>
        <button onClick=${() => editHere(run, "notes")}>${run.notes ? "Change its notes" : "Add notes"}</button>
        <a href=${addressOf({ view: "runs", opened: run.id, isOverList: true })}>Show in Runs</a>
        ${!isActive(run) && html`<${DeleteButton} run=${run} />`}
      <//>
    `}
  </div>
`;

/** @param {{ run: Run, verb: Verb, icon: string, title: string }} props */
const CommandButton = ({ run, verb, icon, title }) => html`
  <button class="quiet compact" disabled=${pending.value[run.id]} onClick=${() => command(run, verb)}>
    <${Icon} name=${icon} /><span>${title}</span>
  </button>
`;

/** Open the form with what this experiment was. @param {Run} run */
function repeatWith(run) {
  forgetPreset();
  unsayable.value = setFormOf(run.config);
  formIsOpen.value = true;
}

/** @param {{ title: string, id?: string, label?: string, children: ComponentChildren }} props */
const Menu = ({ title, id, label, children }) => html`
  <details class="menu report-menu">
    <summary id=${id} class=${`quiet ${label ? "square" : ""}`} aria-label=${label}>${title}</summary>
    <div class="menu-body">${children}</div>
  </details>
`;

/** @param {{ run: Run }} props */
const DeleteButton = ({ run }) => html`
  <button class="bad" disabled=${pending.value[run.id]} onClick=${() => deleteExperiment(run)}>Delete</button>
`;

/** @param {Run} run */
const hasReport = (run) => Boolean(run.result?.files?.includes("report.html"));

/** What can be taken away: the report and the numbers. @param {{ run: Run }} props */
function Files({ run }) {
  return html`
    ${hasReport(run) && html`
      <a href=${partOf(run, "report")} target="_blank" rel="noopener">Open the report</a>
    `}
    ${downloads(run).map(([title, href]) => html`<a href=${href} download="">${title}</a>`)}
  `;
}
