// One experiment: what is known of it already, filling while its trials end.
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

const PICTURES = { table1: TableOne, figure4: FigureFour, sweep: SweepTable };

export function Report({ run }) {
  const known = summary.value;
  // A run changes several times a second, what its trials show does not.
  const findings = useMemo(() => html`<${Findings} known=${known} />`, [known]);
  const hasSeeds = known?.settings?.some(({ n }) => n > 0);
  return html`
    <${ReportHead} run=${run} />
    ${summaryError.value && html`<p class="problem" role="alert">${summaryError.value.message}</p>`}
    ${hasSeeds ? findings : html`<${Waiting} run=${run} />`}
  `;
}

function Findings({ known }) {
  const Picture = PICTURES[known.experiment];
  return html`
    <${LeftOut} trials=${known.trials} />
    ${Picture && html`<${Picture} known=${known} />`}
    <${AtAGlance} known=${known} />
    <${Versus} known=${known} />
    <${Claims} claims=${known.claims ?? []} isComplete=${known.trials.done >= known.trials.total} />
    <${Story} parts=${known.story ?? []} />
    <${FairClocks} timed=${known.timed ?? []} />
    <${Making} known=${known} />
  `;
}

const WORDS = {
  queued: "It starts as soon as what runs before it has ended.",
  running: "The first trials are on their way. The agents that look ahead come first, then seed by seed.",
  paused: "It was paused before its first trial ended.",
  failed: "No trial was completed.",
};

const Waiting = ({ run }) => html`
  <section class="panel waiting" aria-label="Report">
    <div class="no-rows" aria-hidden="true">${[0, 1, 2, 3].map(() => html`<i></i>`)}</div>
    <p class="dim">${WORDS[run.state] ?? "No trial was completed before it ended."}</p>
  </section>
`;
