// The paper's claims with verdicts over all seeds, in each case that was tried.
import { html } from "../../html.js";

const VERDICTS = {
  holds: ["holds", "✓", "Holds"],
  "does not hold": ["fails", "✕", "Does not hold"],
  "not established": ["open", "?", "Not established"],
  depends: ["mixed", "±", "Depends"],
};

export const Claims = ({ claims, isComplete }) => claims.length > 0 && html`
  <section class="panel claims" aria-labelledby="claims">
    <h2 id="claims">The paper’s claims over all seeds</h2>
    ${!isComplete && html`<p class="dim">So far: a verdict may change until the last trial has ended.</p>`}
    <ul>${claims.map((one) => html`<${Claim} key=${one.id} ...${one} />`)}</ul>
  </section>
`;

function Claim({ claim, criterion, verdict, evidence, where }) {
  const hasCases = where.length > 1;
  return html`
    <li class="claim">
      <${Verdict} verdict=${verdict} />
      <div>
        <p><b>${claim}</b></p>
        <p class="dim">${evidence}</p>
        <details>
          <summary>${hasCases ? `All ${where.length} cases` : "Criterion"}</summary>
          <p class="dim">Criterion: ${criterion}</p>
          ${hasCases && html`
            <ul class="cases">${where.map((one) => html`<${Case} key=${one.label} ...${one} />`)}</ul>
          `}
        </details>
      </div>
    </li>
  `;
}

const Case = ({ label, verdict, evidence }) => html`
  <li><${Verdict} verdict=${verdict} /><p><b>${label}</b> <span class="dim">${evidence}</span></p></li>
`;

function Verdict({ verdict }) {
  const [kind, sign, word] = VERDICTS[verdict] ?? ["open", "?", verdict];
  return html`<p class=${`verdict ${kind}`}><span aria-hidden="true">${sign}</span>${word}</p>`;
}
