// What the paper says, and whether it holds over all seeds.
import { html } from "../../html.js";

const VERDICTS = {
  holds: ["holds", "✓", "Holds"],
  "does not hold": ["fails", "✕", "Does not hold"],
  "not established": ["open", "?", "Not established"],
};

export const Claims = ({ claims, isComplete }) => claims.length > 0 && html`
  <section class="panel claims" aria-labelledby="claims">
    <h2 id="claims">What the paper says, and what these seeds say</h2>
    ${!isComplete && html`<p class="dim">So far: a verdict may change until the last trial has ended.</p>`}
    <ul>${claims.map((one) => html`<${Claim} key=${one.id} ...${one} />`)}</ul>
  </section>
`;

function Claim({ claim, verdict, evidence }) {
  const [kind, sign, word] = VERDICTS[verdict] ?? ["open", "?", verdict];
  return html`
    <li class="claim">
      <p class=${`verdict ${kind}`}><span aria-hidden="true">${sign}</span>${word}</p>
      <div><p><b>${claim}</b></p><p class="dim">${evidence}</p></div>
    </li>
  `;
}
