// The tournaments of a room, on the pages of the room.
import { html } from "../../js/components/elements.js";
import { Part, partsOf, wantDialog, wantedDialogs } from "../../js/features.js";
import { options } from "../../js/store.js";
import { askForTournament } from "./list.js";
import { presentTournaments, stateInWords, tournamentPage } from "./states.js";

/** @import { Classroom } from "../../js/types.js" */

/** All walk as the card opens the page. @param {Classroom} room */
function openForm({ code, shown }) {
  wantDialog("tournaments");
  askForTournament(code, shown.state?.form ?? {});
}

/** @param {{ room: Classroom }} props */
export const InCockpit = ({ room }) => html`
  <section class="panel room-tournaments" aria-labelledby="room-tournaments-title">
    <h2 id="room-tournaments-title">Tournaments</h2>
    ${room.tournaments.length > 0 && html`
      <ul>
        ${room.tournaments.map(({ id, title, state }) => html`
          <li key=${id}>
            <a href=${tournamentPage(id)}>${title}</a><span class="dim">${stateInWords(state)}</span>
          </li>
        `)}
      </ul>
    `}
    ${room.state !== "ended" && html`
      <button class="secondary" disabled=${options.value === null} onClick=${() => openForm(room)}>
        Start a tournament…
      </button>
    `}
  </section>
  ${wantedDialogs.value.includes("tournaments") && html`<${Part} part=${partsOf("dialogs").tournaments} />`}
`;

/** @param {{ room: Classroom }} props */
export const OnPhone = ({ room }) => presentTournaments(room).map(({ id, title, state }) => html`
  <a key=${id} class="secondary as-button" href=${tournamentPage(id)}>
    ${state === "open" ? "Enter" : "See"} the tournament: ${title}
  </a>
`);

/** @param {{ room: Classroom }} props */
export const OnProjector = ({ room }) => presentTournaments(room).map(({ id, title }) => html`
  <p key=${id} class="join-address">
    <a href=${`${tournamentPage(id)}?projector`}>Tournament: ${title}</a>
  </p>
`);
