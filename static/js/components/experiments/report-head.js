// Which experiment it is, how far it is, what can be done with it and what can be taken away.
import { useState } from "preact/hooks";
import { pending } from "../../actions.js";
import { downloads, fileAddress, reportAddress } from "../../api.js";
import { sentence } from "../../format.js";
import { html } from "../../html.js";
import { isActive, isOperator } from "../../selectors.js";
import { discard, tell } from "../../experiments/actions.js";
import { paceOf } from "../../experiments/pace.js";
import { aboutRun, runTitle } from "../../experiments/titles.js";
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
        <${Deeds} run=${run} />
      </div>
      <p class="dim">${sentence(aboutRun(run))}</p>
      ${(isUnderWay || run.state === "stopped") && html`
        <div class="progress">
          <p><span class="num">${pace.label}</span><span class="dim num">${pace.left}</span></p>
          <${ProgressBar} label="Trials that are done" share=${pace.share} />
        </div>
      `}
      <${Note} run=${run} />
      <${Problem} at=${run.id} />
      ${!isUnderWay && html`<${Takeaways} run=${run} />`}
    </section>
  `;
}

const NOTES = {
  paused: "Paused. What is done is kept, and no core is kept busy.",
  stopped: "Stopped. What is shown is of the trials that were done. Resume, and only the rest is run.",
  interrupted: "The server ended before it did. What is done is kept; resume, and only the rest is run.",
};

function Note({ run }) {
  if (run.state === "failed") {
    return html`<div class="notice bad"><p><b>The experiment failed.</b> ${run.error}</p><p>What was done before is kept below; resume, and only the rest is run.</p></div>`;
  }
  return NOTES[run.state] ? html`<p class="notice">${NOTES[run.state]} ${run.state === "stopped" && run.error}</p>` : null;
}

function Deeds({ run }) {
  const [isSure, setSure] = useState(false);
  if (!isOperator.value) return null;
  const isHeld = pending.value[run.id];
  const deed = (verb, icon, title) => html`
    <button class="secondary compact" disabled=${isHeld} onClick=${() => tell(run, verb)}><${Icon} name=${icon} />${title}</button>
  `;
  return html`
    <div class="report-deeds">
      ${run.state === "running" && deed("pause", "pause", "Pause")}
      ${run.can_resume && deed("resume", "play", "Resume")}
      ${isActive(run) && deed("stop", "stop", "Stop")}
      ${!isActive(run) && html`
        <button class="quiet compact" disabled=${isHeld} onBlur=${() => setSure(false)} onClick=${() => (isSure ? discard(run) : setSure(true))}>
          ${isSure ? "Delete for good?" : "Delete"}
        </button>
      `}
    </div>
  `;
}

/** The report to hand out, its figures and its numbers. */
function Takeaways({ run }) {
  const files = run.result?.files ?? [];
  const figures = files.filter((name) => /\.(png|svg|pdf)$/.test(name));
  return html`
    <p class="takeaways">
      ${files.includes("report.html") && html`<a class="report-link" href=${reportAddress(run)} target="_blank" rel="noopener">Open the report</a>`}
      ${downloads(run).map(([title, href]) => html`<a href=${href} download>${title}</a>`)}
    </p>
    ${figures.length > 0 && html`
      <details class="more figures">
        <summary>Figures (${figures.length})</summary>
        <ul>${figures.map((name) => html`<li><a href=${fileAddress(run, name)} download>${name.split("/").at(-1)}</a></li>`)}</ul>
      </details>
    `}
  `;
}
