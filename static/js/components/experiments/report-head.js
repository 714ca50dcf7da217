// The head of a report: the experiment's state, its actions and its downloads.
import { useState } from "preact/hooks";
import { pending } from "../../actions.js";
import { downloads, fileAddress, reportAddress } from "../../api.js";
import { sentence } from "../../format.js";
import { html } from "../../html.js";
import { isActive, isOperator } from "../../selectors.js";
import { command, deleteExperiment } from "../../experiments/actions.js";
import { paceOf } from "../../experiments/pace.js";
import { describeRun, runTitle } from "../../experiments/titles.js";
import { Icon } from "../icon.js";
import { Problem } from "../problem.js";
import { ProgressBar } from "../progress-bar.js";

export function ReportHead({ run }) {
  const pace = paceOf(run);
  const isUnderWay = isActive(run) || run.state === "interrupted";
  return html`
    <section class="panel report-head" aria-labelledby="report-title">
      <div class="title-row">
        <h2 id="report-title">${runTitle(run)}</h2>
        <p class=${`state ${run.state}`}><span class="dot" aria-hidden="true"></span>${run.state}</p>
        <${Actions} run=${run} />
      </div>
      <p class="dim">${sentence(describeRun(run))}</p>
      ${(isUnderWay || run.state === "stopped") && html`
        <div class="progress">
          <p><span class="num">${pace.label}</span><span class="dim num">${pace.left}</span></p>
          <${ProgressBar} label="Trials that are done" share=${pace.share} />
        </div>
      `}
      <${Note} run=${run} />
      <${Problem} at=${run.id} />
      ${!isUnderWay && html`<${Downloads} run=${run} />`}
    </section>
  `;
}

const NOTES = {
  paused: "Paused. Finished trials are kept, and no core is used.",
  stopped: "Stopped. The report is of the trials that were done. Resume to run only the rest.",
  interrupted: "The server ended before the experiment did. Finished trials are kept; resume to run only the rest.",
};

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
  return html`<p class="notice">${NOTES[run.state]} ${run.state === "stopped" && run.error}</p>`;
}

function Actions({ run }) {
  if (!isOperator.value) return null;
  return html`
    <div class="report-actions">
      ${run.state === "running" && html`<${CommandButton} run=${run} verb="pause" icon="pause" title="Pause" />`}
      ${run.can_resume && html`<${CommandButton} run=${run} verb="resume" icon="play" title="Resume" />`}
      ${isActive(run) && html`<${CommandButton} run=${run} verb="stop" icon="stop" title="Stop" />`}
      ${!isActive(run) && html`<${DeleteButton} run=${run} />`}
    </div>
  `;
}

const CommandButton = ({ run, verb, icon, title }) => html`
  <button class="secondary compact" disabled=${pending.value[run.id]} onClick=${() => command(run, verb)}>
    <${Icon} name=${icon} />${title}
  </button>
`;

function DeleteButton({ run }) {
  const [isSure, setSure] = useState(false);
  const onClick = () => (isSure ? deleteExperiment(run) : setSure(true));
  return html`
    <button class="quiet compact" disabled=${pending.value[run.id]} onBlur=${() => setSure(false)} onClick=${onClick}>
      ${isSure ? "Delete for good?" : "Delete"}
    </button>
  `;
}

function Downloads({ run }) {
  const files = run.result?.files ?? [];
  const figures = files.filter((name) => /\.(png|svg|pdf)$/.test(name));
  return html`
    <p class="takeaways">
      ${files.includes("report.html") && html`<${ReportLink} run=${run} />`}
      ${downloads(run).map(([title, href]) => html`<a href=${href} download>${title}</a>`)}
    </p>
    ${figures.length > 0 && html`
      <details class="more figures">
        <summary>Figures (${figures.length})</summary>
        <ul>${figures.map((name) => html`<${Figure} run=${run} name=${name} />`)}</ul>
      </details>
    `}
  `;
}

const ReportLink = ({ run }) => html`
  <a class="report-link" href=${reportAddress(run)} target="_blank" rel="noopener">Open the report</a>
`;

const Figure = ({ run, name }) => html`
  <li><a href=${fileAddress(run, name)} download>${name.split("/").at(-1)}</a></li>
`;
