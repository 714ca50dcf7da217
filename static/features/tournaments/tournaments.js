// The dialog of tournaments: their list, and for operators the form of a new one.
import { Deletions } from "../../js/components/deletions.js";
import { html, Dialog, Icon } from "../../js/components/elements.js";
import { ago, codeInGroups, shortAddress } from "../../js/format.js";
import { copy } from "../../js/page.js";
import { isOperator } from "../../js/selectors.js";
import { failures, isNew, isOpen, opened, ownRoom, showForm, showList, takeRestored, tournaments } from "./list.js";
import { stateInWords, tournamentPage } from "./states.js";
import { entriesInWords } from "./words.js";
import { NewTournamentForm } from "./new-tournament.js";

/** @import { ListedTournament, Tournament } from "../../js/types.js" */

export function Tournaments() {
  const isForm = isNew.value && !opened.value;
  return html`
    <${Dialog} isOpen=${isOpen} id="tournaments" labelledBy="tournaments-title" style="tournaments">
      <div class="dialog-head">
        <h2 id="tournaments-title">${titleOf(isForm)}</h2>
        <button class="quiet square" aria-label="Close" onClick=${() => (isOpen.value = false)}>✕</button>
      </div>
      ${opened.value && isNew.value && html`<${Opened} tournament=${opened.value} />`}
      ${isForm && html`<${NewTournamentForm} />`}
      ${!isNew.value && html`<${List} />`}
    <//>
  `;
}

/** @param {boolean} isForm */
const titleOf = (isForm) => (isForm ? "Open a tournament" : isNew.value ? "The tournament is open" : "Tournaments");

function List() {
  const all = tournaments.value;
  return html`
    <p class="dim">
      Learners and searchers are entered, and judged by the server on secret seeds and worlds.
    </p>
    <div role="alert">${failures.value.list && html`<p class="problem">${failures.value.list}</p>`}</div>
    <${Deletions} kind="tournaments" take=${takeRestored} />
    ${all === null && !failures.value.list && html`<p role="status">Loading the tournaments…</p>`}
    ${all?.length === 0 && html`<p>There is none yet.</p>`}
    ${all !== null && all.length > 0 && html`
      <ul class="tournament-list">
        ${all.map((tournament) => html`<${Row} key=${tournament.id} tournament=${tournament} />`)}
      </ul>
    `}
    ${isOperator.value && html`<button class="primary" onClick=${showForm}>Open a tournament…</button>`}
  `;
}

/** @param {{ tournament: ListedTournament }} props */
const Row = ({ tournament: { id, title, room, state, entries, created_at } }) => html`
  <li>
    <a href=${tournamentPage(id)}>${title}</a>
    <span class="dim">
      ${[stateInWords(state), entriesInWords(entries), room ? `room ${codeInGroups(room)}` : "", ago(created_at)]
        .filter(Boolean).join(" · ")}
    </span>
  </li>
`;

/** @param {{ tournament: Tournament }} props */
const Opened = ({ tournament: { id, title, address, qr_code, room } }) => html`
  <div class="opened-tournament">
    ${qr_code && html`<img src=${qr_code} alt=${`QR code of ${address}`} />`}
    <div>
      <p><b>${title}</b></p>
      <p class="address">${shortAddress(address)}</p>
      <button class="secondary compact" onClick=${() => copy(address, "Link copied.")}>
        <${Icon} name="link" />Copy the link
      </button>
    </div>
  </div>
  ${room && html`<p>The phones of the room have a button that leads there.</p>`}
  <a class="primary button-link" href=${tournamentPage(id)}>Go to the tournament</a>
  <a class="secondary button-link" href=${`${tournamentPage(id)}?projector`} target="_blank">Open the projector</a>
  ${ownRoom.value === null && html`<button class="quiet" onClick=${showList}>All tournaments</button>`}
`;
