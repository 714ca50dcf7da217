// The projector: title and state, the way there, and the ranking in large.
import { Away } from "../../js/components/away.js";
import { html } from "../../js/components/elements.js";
import { shortAddress } from "../../js/format.js";
import { Table } from "./ranking.js";
import { stateInWords } from "./states.js";
import { entries, shownTournament, unranked } from "./tournament.js";
import { entriesInWords, rulesInWords, shortened } from "./words.js";

/** Rows for which the screen has room, the references among them. */
const MOST = 10;

export function Projector() {
  const { title, state, rules, standings, qr_code, address } = shownTournament();
  const isReference = (/** @type {number} */ number) => entries.value.get(number)?.is_reference === true;
  const shown = shortened(standings, isReference, MOST);
  return html`
    <main class="tournament-projector">
      <${Away} />
      <header>
        <div>
          <h1 title=${title}>${title}</h1>
          <p class="dim">
            <b class=${`tournament-state ${state}`}>${stateInWords(state)}</b> · ${rulesInWords(rules)}
          </p>
        </div>
        <div class="join-here">
          ${qr_code && html`
            <img class="qr-code" src=${qr_code} alt=${`QR code of ${address}`} />
            <p class="address">${shortAddress(address)}</p>
          `}
        </div>
      </header>
      ${shown.length > 0
        ? html`<${Table} standings=${shown} isShort=${true} />`
        : html`<p class="nothing-yet">Nothing has been judged on all draws yet.</p>`}
      <footer class="dim">
        <p>${countsInWords(standings.length - shown.length)}</p>
        <p>A range of ranks: the difference may be chance.</p>
      </footer>
    </main>
  `;
}

/** @param {number} count that are not on the screen */
function countsInWords(count) {
  const judging = unranked.value.length;
  return [
    count > 0 ? `${count} more in the ranking` : "",
    judging > 0 ? `${entriesInWords(judging)} being judged` : "",
  ].filter(Boolean).join(" · ");
}
