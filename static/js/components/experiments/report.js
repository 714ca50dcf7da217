// The report of one experiment. It fills while trials end.
import { useMemo, useState } from "preact/hooks";
import { pending } from "../../actions.js";
import { command, deleteExperiment, paceOf, summary, summaryError } from "../../experiments/runs.js";
import { downloads, fileAddress, reportAddress } from "../../files.js";
import { count, duration } from "../../format.js";
import { isActive, isOperator } from "../../selectors.js";
import { describeRun, messageOf, runTitle, simulatorTitle } from "../../titles.js";
import { html, Icon, Problem, ProgressBar } from "../elements.js";
import { FigureFour } from "./figure-four.js";
import { AtAGlance, Claims, FairClocks, Narrative, Versus } from "./findings.js";
import { Seeds } from "./seeds.js";
import { SweepTable } from "./sweep-table.js";
import { TableOne } from "./table-one.js";
import { Worlds } from "./worlds.js";

/** @import { Run, State, Summary, Verb } from "../../types.js" */

const FIGURES = {
  table1: TableOne, figure4: FigureFour, sweep: SweepTable,
  league: Worlds, recovery: Worlds, groups: Worlds, bodies: Worlds,
};

/** @param {{ run: Run }} props */
export function Report({ run }) {
  const known = summary.value;
  // Progress changes several times a second, the summary seldom.
  const findings = useMemo(() => html`<${Findings} known=${known} />`, [known]);
  const hasSeeds = known?.settings?.some(({ n }) => n > 0);
  return html`
    <${ReportHead} run=${run} />
    ${summaryError.value && html`<p class="problem" role="alert">${messageOf(summaryError.value)}</p>`}
    ${hasSeeds ? findings : html`<${Waiting} run=${run} />`}
  `;
}

/** @param {{ known: Summary }} props */
function Findings({ known }) {
  const Figure = FIGURES[known.experiment];
  return html`
    <${LeftOut} trials=${known.trials} />
    ${Figure && html`<${Figure} known=${known} />`}
    <${Seeds} known=${known} />
    ${!known.worlds?.length && html`<${AtAGlance} known=${known} />`}
    <${Versus} known=${known} />
    <${Claims} claims=${known.claims ?? []} isComplete=${known.trials.done >= known.trials.total} />
    <${Narrative} parts=${known.story ?? []} />
    <${FairClocks} timed=${known.timed ?? []} />
    <${Making} known=${known} />
  `;
}

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

// ---- the head: the experiment's state, its actions and its downloads

/** @param {{ run: Run }} props */
function ReportHead({ run }) {
  const pace = paceOf(run);
  const isUnderWay = isActive(run) || run.state === "interrupted";
  return html`
    <section class="panel report-head" aria-label=${`Experiment: ${runTitle(run)}`}>
      <div class="title-row">
        <h2>${runTitle(run)}</h2>
        <p class=${`state ${run.state}`}><span class="dot" aria-hidden="true"></span>${run.state}</p>
        <${Actions} run=${run} />
      </div>
      <p class="dim">${describeRun(run)}</p>
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

/** @type {Partial<Record<State, string>>} */
const NOTES = {
  paused: "Paused. Finished trials are kept, and no core is used.",
  stopped: "Stopped. The report covers the completed trials. Resume to run only the rest.",
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
  return html`<p class="notice">${NOTES[run.state]} ${run.state === "stopped" && run.error}</p>`;
}

/** @param {{ run: Run }} props */
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

/** @param {{ run: Run, verb: Verb, icon: string, title: string }} props */
const CommandButton = ({ run, verb, icon, title }) => html`
  <button class="secondary compact" disabled=${pending.value[run.id]} onClick=${() => command(run, verb)}>
    <${Icon} name=${icon} />${title}
  </button>
`;

/** @param {{ run: Run }} props */
function DeleteButton({ run }) {
  const [isSure, setSure] = useState(false);
  const onClick = () => (isSure ? deleteExperiment(run) : setSure(true));
  return html`
    <button class="quiet compact" disabled=${pending.value[run.id]} onBlur=${() => setSure(false)} onClick=${onClick}>
      ${isSure ? "Delete for good?" : "Delete"}
    </button>
  `;
}

/** @param {{ run: Run }} props */
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

/** @param {{ run: Run }} props */
const ReportLink = ({ run }) => html`
  <a class="report-link" href=${reportAddress(run)} target="_blank" rel="noopener">Open the report</a>
`;

/** @param {{ run: Run, name: string }} props */
const Figure = ({ run, name }) => html`
  <li><a href=${fileAddress(run, name)} download>${name.split("/").at(-1)}</a></li>
`;

// ---- trials without a distance, with the reasons

/** @param {{ trials: Summary["trials"] }} props */
function LeftOut({ trials }) {
  const aside = trials.set_aside ?? [];
  const failures = trials.failures ?? [];
  if (!aside.length && !trials.failed) return null;
  const counts = [
    trials.failed && `${count(trials.failed, "trial")} failed`,
    aside.length && `${count(aside.length, "trial")} set aside`,
  ];
  return html`
    <section class="panel left-out" aria-labelledby="left-out">
      <h2 id="left-out">Left out: ${counts.filter(Boolean).join(", ")}</h2>
      <p class="dim">
        A trial is set aside when it has killed its worker three times, or cannot be run. All others are in the figures.
      </p>
      <details class="more">
        <summary>Which, and why</summary>
        <ul>
          ${[...failures, ...aside].map(({ label, key, reason }) => html`
            <li>${label ?? key}: <span class="dim">${reason}</span></li>
          `)}
        </ul>
      </details>
    </section>
  `;
}

// ---- what is needed to repeat it: seeds, versions, machine and time

/** @param {(string | 0 | false | null | undefined)[]} parts */
const joined = (parts) => parts.filter(Boolean).join(", ");


/** @param {Summary} known */
const simulatorOf = ({ config, versions = {} }) => {
  const version = config.simulator === "mujoco" ? versions.mujoco : null;
  return [simulatorTitle(config.simulator), version].filter(Boolean).join(" ");
};

/** @param {Summary} known */
const versionsOf = ({ versions = {} }) =>
  joined(Object.entries(versions).filter(([name]) => name !== "mujoco").map(([name, version]) => `${name} ${version}`));

/** @param {Summary} known */
const machineOf = ({ machine = {} }) => joined([machine.platform, machine.cores && count(machine.cores, "core")]);

/** @param {{ cost: Summary["cost"] }} one */
const timeOf = ({ cost }) =>
  cost && joined([
    cost.wall_s && duration(cost.wall_s),
    cost.trials_per_s && `${cost.trials_per_s.toPrecision(3)} trials a second`,
    cost.workers && count(cost.workers, "worker"),
  ]);

/** @param {{ known: Summary }} props */
function Making({ known }) {
  const { seeds, seed } = known.config;
  const rows = [
    ["Seeds", `${count(seeds, "seed")}, spawned from ${seed}`],
    ["Simulator", simulatorOf(known)],
    ["Versions", versionsOf(known)],
    ["Machine", machineOf(known)],
    ["Time", timeOf(known)],
  ];
  return html`
    <section class="panel making" aria-labelledby="making">
      <h2 id="making">Method</h2>
      <dl>
        ${rows.filter(([, value]) => value !== undefined && value !== null).map(([name, value]) => html`
          <div><dt>${name}</dt><dd>${value}</dd></div>
        `)}
      </dl>
    </section>
  `;
}
