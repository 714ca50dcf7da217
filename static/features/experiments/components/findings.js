// Findings over all seeds: gaits together, learners against each other, claims, conclusions, real clock.
import { useMemo } from "preact/hooks";
import { pooledTable, timedTable, versusTable } from "../result-tables.js";
import { withGroupedDigits } from "../../../js/format.js";
import { html } from "../../../js/components/elements.js";
import { StripKey } from "./report-tools.js";
import { ResultTable } from "./result-table.js";

/** @import { ClaimView, Finding, NarrativeSection, Summary } from "../../../js/types.js" */

const POOLED_SIGNS = ["seed", "typical", "greedy", "half"];

/** All gaits together: how near learners come to greedy, and how many walk. @param {{ summary: Summary }} props */
export function AtAGlance({ summary }) {
  const table = useMemo(() => pooledTable(summary), [summary]);
  if (!table) return null;
  const { title, ...rows } = table;
  return html`
    <section class="panel glance" aria-labelledby="glance">
      <h2 id="glance">${title}</h2>
      <p class="dim">Total distance as a share of greedy’s in the same place; a robot that gets half as far walks.</p>
      <${StripKey} signs=${POOLED_SIGNS} color=${rows.groups[0].rows[0].cells[0].strip?.color} />
      <${ResultTable} table=${rows} name=${title} />
    </section>
  `;
}

/** Learners against each other. @param {{ summary: Summary }} props */
export const Versus = ({ summary }) => summary.versus?.length > 0 && html`
  <section class="panel versus" aria-labelledby="versus">
    <h2 id="versus">Learners against each other</h2>
    <p class="dim">The chance that a seed of the first gets further than a seed of the second; a half is a tie.</p>
    <${ResultTable} table=${versusTable(summary)} />
  </section>
`;

/** Races in which decisions cost the time measured on the machine. @param {{ summary: Summary }} props */
export const FairClocks = ({ summary }) => summary.timed?.length > 0 && html`
  <section class="panel fair-clocks" aria-labelledby="fair-clocks">
    <h2 id="fair-clocks">Under the real clock</h2>
    <p class="dim">
      The distances above are under the paper clock. Here a decision costs the time that it took on this machine: one
      race in each place, with the first seed; distances at time-out.
    </p>
    <${ResultTable} table=${timedTable(summary)} />
  </section>
`;

// ---- the paper's claims with verdicts over all seeds, in each case that was tried

/** @type {Record<string, string[]>} */
const VERDICTS = {
  holds: ["holds", "✓", "Holds"],
  "does not hold": ["fails", "✕", "Does not hold"],
  "not established": ["open", "?", "Not established"],
  depends: ["mixed", "±", "Depends"],
};

/** @param {{ claims: ClaimView[], isComplete: boolean }} props */
export const Claims = ({ claims, isComplete }) => claims.length > 0 && html`
  <section class="panel claims" aria-labelledby="claims">
    <h2 id="claims">The paper’s claims over all seeds</h2>
    <p class="dim">
      The paper says neither how the state is read nor how stiff the servos are, so each claim is judged in every case
      that was tried. “Not established” means that the 95 % interval leaves it open.
    </p>
    ${!isComplete && html`<p class="dim">So far: a verdict may change until the last trial has ended.</p>`}
    <ul>${claims.map((claim) => html`<${Claim} key=${claim.id} ...${claim} />`)}</ul>
  </section>
`;

/** @param {{ claim: string, criterion: string, verdict: string, evidence: string, where: Finding[] }} props */
function Claim({ claim, criterion, verdict, evidence, where }) {
  const hasCases = where.length > 1;
  return html`
    <li class="claim">
      <${Verdict} verdict=${verdict} />
      <div>
        <h3>${withGroupedDigits(claim)}</h3>
        <p class="dim">${withGroupedDigits(evidence)}</p>
        <details>
          <summary>${hasCases ? `All ${where.length} cases` : "Criterion"}</summary>
          <p class="dim">Criterion: ${withGroupedDigits(criterion)}</p>
          ${hasCases && html`
            <ul class="cases">${where.map((finding) => html`<${Case} key=${finding.label} ...${finding} />`)}</ul>
          `}
        </details>
      </div>
    </li>
  `;
}

/** @param {{ label: string, verdict: string, evidence: string }} props */
const Case = ({ label, verdict, evidence }) => html`
  <li>
    <${Verdict} verdict=${verdict} />
    <p><b>${label}</b> <span class="dim">${withGroupedDigits(evidence)}</span></p>
  </li>
`;

/** @param {{ verdict: string }} props */
function Verdict({ verdict }) {
  const [kind, sign, word] = VERDICTS[verdict] ?? ["open", "?", verdict];
  return html`<p class=${`verdict ${kind}`}><span aria-hidden="true">${sign}</span>${word}</p>`;
}

// ---- conclusions in prose, written by the server from this run's numbers

/** @param {{ parts: NarrativeSection[] }} props */
export const Narrative = ({ parts }) => parts.length > 0 && html`
  <section class="panel narrative" aria-labelledby="conclusions">
    <h2 id="conclusions">Findings</h2>
    ${parts.map(({ heading, text }) => html`
      <h3>${heading}</h3>
      ${text.split("\n\n").map((paragraph) => html`<p>${withGroupedDigits(paragraph)}</p>`)}
    `)}
  </section>
`;
