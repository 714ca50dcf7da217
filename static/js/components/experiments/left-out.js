// Trials without a distance, with the reasons.
import { count } from "../../format.js";
import { html } from "../../html.js";

export function LeftOut({ trials }) {
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
        <ul>${[...failures, ...aside].map((one) => html`<${Reason} trial=${one.key} reason=${one.reason} />`)}</ul>
      </details>
    </section>
  `;
}

const Reason = ({ trial, reason }) => html`<li><code>${trial}</code> <span class="dim">${reason}</span></li>`;
