// What the paper says, and whether it holds over all seeds: in each case that was tried.
import { html } from "../../html.js";

const VERDICTS = {
  holds: ["holds", "✓", "Holds"],
  "does not hold": ["fails", "✕", "Does not hold"],
  "not established": ["open", "?", "Not established"],
  depends: ["mixed", "±", "Depends"],
};

export const Claims = ({ claims, isComplete }) => claims.length > 0 && html`
  <section class="panel claims" aria-labelledby="claims">
    <h2 id="claims">What the paper says, and what these seeds say</h2>
    ${!isComplete && html`<p class="dim">So far: a verdict may change until the last trial has ended.</p>`}
    <ul>${claims.map((one) => html`<${Claim} key=${one.id} ...${one} />`)}</ul>
  </section>
`;

function Claim({ claim, criterion, verdict, evidence, where }) {
  return html`
    <li class="claim">
      <${Verdict} verdict=${verdict} />
      <div>
        <p><b>${claim}</b></p>
        <p class="dim">${evidence}</p>
        <details>
          <summary>${where.length > 1 ? `All ${where.length} cases` : "What we take it to mean"}</summary>
          <p class="dim">Taken to mean: ${criterion}</p>
          ${where.length > 1 && html`<ul class="cases">${where.map((one) => html`<${Case} key=${one.label} ...${one} />`)}</ul>`}
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
