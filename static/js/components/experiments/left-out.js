// Trials that gave no distance: named, so that nobody takes their absence for a result.
import { count } from "../../format.js";
import { html } from "../../html.js";

export function LeftOut({ trials }) {
  const aside = trials.set_aside ?? [];
  const failures = trials.failures ?? [];
  if (!aside.length && !trials.failed) return null;
  return html`
    <section class="panel left-out" aria-labelledby="left-out">
      <h2 id="left-out">Left out: ${[
        trials.failed && `${count(trials.failed, "trial")} failed`,
        aside.length && `${count(aside.length, "trial")} set aside`,
      ].filter(Boolean).join(", ")}</h2>
      <p class="dim">A trial is set aside when it has killed its worker three times, or cannot be run. All others are in the figures.</p>
      <details class="more">
        <summary>Which, and why</summary>
        <ul>${[...failures, ...aside].map(({ key, reason }) => html`<li><code>${key}</code> <span class="dim">${reason}</span></li>`)}</ul>
      </details>
    </section>
  `;
}
