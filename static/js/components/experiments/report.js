// The report of one experiment. It fills while trials end.
import { useMemo } from "preact/hooks";
import { html } from "../../html.js";
import { summary, summaryError } from "../../experiments/summaries.js";
import { AtAGlance } from "./at-a-glance.js";
import { Claims } from "./claims.js";
import { FairClocks } from "./fair-clocks.js";
import { FigureFour } from "./figure-four.js";
import { LeftOut } from "./left-out.js";
import { Making } from "./making.js";
import { ReportHead } from "./report-head.js";
import { Story } from "./story.js";
import { SweepTable } from "./sweep-table.js";
import { TableOne } from "./table-one.js";
import { Versus } from "./versus.js";

const FIGURES = { table1: TableOne, figure4: FigureFour, sweep: SweepTable };

export function Report({ run }) {
  const known = summary.value;
  // Progress changes several times a second, the summary seldom.
  const findings = useMemo(() => html`<${Findings} known=${known} />`, [known]);
  const hasSeeds = known?.settings?.some(({ n }) => n > 0);
  return html`
    <${ReportHead} run=${run} />
    ${summaryError.value && html`<p class="problem" role="alert">${summaryError.value.message}</p>`}
    ${hasSeeds ? findings : html`<${Waiting} run=${run} />`}
  `;
}

function Findings({ known }) {
  const Figure = FIGURES[known.experiment];
  return html`
    <${LeftOut} trials=${known.trials} />
    ${Figure && html`<${Figure} known=${known} />`}
    <${AtAGlance} known=${known} />
    <${Versus} known=${known} />
    <${Claims} claims=${known.claims ?? []} isComplete=${known.trials.done >= known.trials.total} />
    <${Story} parts=${known.story ?? []} />
    <${FairClocks} timed=${known.timed ?? []} />
    <${Making} known=${known} />
  `;
}

const WORDS = {
  queued: "Waiting in the queue.",
  running: "Waiting for the first trials. Agents that look ahead come first, then one seed after the other.",
  paused: "Paused before the first trial ended.",
  failed: "No trial was completed.",
};

const Waiting = ({ run }) => html`
  <section class="panel waiting" aria-label="Report">
    <div class="no-rows" aria-hidden="true">${[0, 1, 2, 3].map(() => html`<i></i>`)}</div>
    <p class="dim">${WORDS[run.state] ?? "No trial was completed before the experiment ended."}</p>
  </section>
`;
