// After the end: the file and how to repeat it, the secret and the draws that follow from it, distances by draw.
import { DotStrip } from "../../js/components/dot-strip.js";
import { html, Icon } from "../../js/components/elements.js";
import { worldTitle } from "../../js/disturbances.js";
import { count, metres } from "../../js/format.js";
import { copy } from "../../js/page.js";
import { largest } from "../../js/scale.js";
import { agentOf } from "../../js/settings.js";
import { fileOf } from "./api.js";
import { entries, id, isWhole, shownTournament, nameOfNumber, shownStandings } from "./tournament.js";
import { failuresInWords, intervalInWords, shortName } from "./words.js";

/** @import { Judgement, RankedEntry } from "../../js/types.js" */

const HEADROOM = 1.04;
const LEAST_M = 0.1;
const VERIFY = `hexapods verify tournament-${id}.json`;

export function Ended() {
  const { secret, draws } = shownTournament();
  if (secret === null || draws === null) return null;
  return html`
    <section class="panel repeat" aria-labelledby="repeat-title">
      <h2 id="repeat-title">Check it</h2>
      <p>
        The file has the secret, the draws, all entries and what came of them. This command repeats the whole table, and
        tells each digit that differs:
      </p>
      <p class="command"><code>${VERIFY}</code>
        <button class="quiet compact" onClick=${() => copy(VERIFY, "Command copied.")}>Copy</button></p>
      <a class="primary as-button" href=${fileOf(id)} download=${`tournament-${id}.json`}>
        <${Icon} name="import" />Download the file
      </a>
    </section>
    <section class="panel distances" aria-labelledby="distances-title">
      <h2 id="distances-title">Distances on each draw</h2>
      <${Strips} />
      <details><summary>As a table</summary><${DistanceTable} /></details>
    </section>
    <section class="panel draws" aria-labelledby="draws-title">
      <h2 id="draws-title">Secret and draws</h2>
      <p class="dim">The secret, of which the SHA-256 was shown from the beginning:</p>
      <p><code class="digits">${secret}</code></p>
      <details open=${draws.length <= 20}>
        <summary>${count(draws.length, "draw")}</summary>
        <table class="draws-table">
          <thead><tr><th scope="col">Draw</th><th scope="col">Seed</th><th scope="col">World</th></tr></thead>
          <tbody>
            ${draws.map(({ seed, world }, n) => html`
              <tr key=${n}><th scope="row">${n + 1}</th><td class="num">${seed}</td><td>${worldTitle(world)}</td></tr>
            `)}
          </tbody>
        </table>
      </details>
    </section>
  `;
}

/** @param {number} number @returns {Judgement[]} */
const judgementsOf = (number) => entries.value.get(number)?.judgements ?? [];

/** The entries that are ranked, each with a dot for each draw, on one axis. */
function Strips() {
  const standings = shownStandings.value;
  const all = shownTournament().standings
    .flatMap(({ number }) => judgementsOf(number).map(({ distance_m }) => distance_m));
  const axis = { low: Math.min(0, ...all), high: HEADROOM * largest(all, LEAST_M) };
  return html`
    <ul class="draw-strips">
      ${standings.map((standing, n) => html`
        <${Strip} key=${standing.number} standing=${standing} axis=${axis} hasNumbers=${n === standings.length - 1} />
      `)}
    </ul>
    ${standings.length < shownTournament().standings.length && html`
      <button class="secondary" onClick=${() => (isWhole.value = true)}>
        Show all ${shownTournament().standings.length}</button>
    `}
  `;
}

/** @param {{ standing: RankedEntry, axis: { low: number, high: number }, hasNumbers: boolean }} props */
function Strip({ standing, axis, hasNumbers }) {
  const { number, iqm_m, low_m, high_m } = standing;
  const judgements = judgementsOf(number);
  const entry = entries.value.get(number);
  const failed = failuresInWords(standing, judgements.length);
  const reasons = [...new Set(judgements.flatMap(({ failure }) => (failure ? [failure] : [])))];
  const words = `${nameOfNumber(number)}: ${metres(iqm_m)}, 95 % interval ${intervalInWords(standing)} m`;
  return html`
    <li class=${entry?.is_own ? "own" : ""}>
      <p class="name" title=${nameOfNumber(number)}>${nameOfNumber(number)}</p>
      <${DotStrip} label=${words} points=${judgements.map(({ distance_m }) => distance_m)} ...${axis}
        typical=${{ iqm: iqm_m, low: low_m, high: high_m }} axis=${hasNumbers ? metres : null}
        color=${entry?.entry ? agentOf(entry.entry.agent).color : undefined} />
      ${failed && html`<p class="failed">${failed} draws, which count 0 m: ${reasons.join("; ")}</p>`}
    </li>
  `;
}

function DistanceTable() {
  const { standings, draws } = shownTournament();
  return html`
    <div class="scroller" tabindex="0" role="region" aria-label="Distances on each draw, in metres">
      <table class="draws-table by-draw">
        <thead>
          <tr>
            <th scope="col">Draw</th>
            ${standings.map(({ number }) => html`
              <th key=${number} scope="col">${shortName(nameOfNumber(number))}</th>
            `)}
          </tr>
        </thead>
        <tbody>
          ${(draws ?? []).map((_, n) => html`
            <tr key=${n}>
              <th scope="row">${n + 1}</th>
              ${standings.map(({ number }) => html`
                <td key=${number} class="num"><${Cell} judgement=${judgementsOf(number)[n]} /></td>
              `)}
            </tr>
          `)}
        </tbody>
      </table>
    </div>
  `;
}

/** @param {{ judgement: Judgement | undefined }} props */
const Cell = ({ judgement }) => (judgement?.failure
  ? html`<span class="failed" title=${judgement.failure}>failed</span>`
  : metres(judgement?.distance_m));
