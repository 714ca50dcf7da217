// What an operator does: show the way to the tournament, end it, delete it after the end.
import { signal } from "@preact/signals";
import { Dialog, html, Icon } from "../../js/components/elements.js";
import { shortAddress } from "../../js/format.js";
import { copy } from "../../js/page.js";
import { busy, end, failures, id, shownTournament, remove, unranked } from "./tournament.js";

/** @import { Changed } from "../../js/types.js" */

const endIsOpen = signal(false);
const deleteIsOpen = signal(false);
const isWaitingDropped = signal(false);

export function Operator() {
  const { state, may_end, is_operator } = shownTournament();
  if (!is_operator) return null;
  return html`
    <section class="panel operator" aria-labelledby="operator-title">
      <h2 id="operator-title">For you as an operator</h2>
      <${Way} />
      <div class="row">
        <a class="secondary as-button" href=${`${encodeURIComponent(id)}?projector`} target="_blank">
          <${Icon} name="present" />Projector
        </a>
        ${state === "ended"
          ? html`<button class="quiet" onClick=${() => (deleteIsOpen.value = true)}>Delete…</button>`
          : may_end && html`<button class="quiet" onClick=${() => (endIsOpen.value = true)}>End…</button>`}
      </div>
    </section>
    <${EndDialog} />
    <${DeleteDialog} />
  `;
}

/** QR code and link. */
function Way() {
  const { address, qr_code } = shownTournament();
  return html`
    <div class="way">
      ${qr_code && html`<img src=${qr_code} alt=${`QR code of ${address}`} />`}
      <div>
        <p class="address">${shortAddress(address)}</p>
        <button class="secondary compact" onClick=${() => copy(address, "Link copied.")}>
          <${Icon} name="link" />Copy the link
        </button>
      </div>
    </div>
  `;
}

/** @param {{ name: string }} props */
const Failure = ({ name }) => html`
  <div role="alert">${failures.value[name] && html`<p class="problem">${failures.value[name]}</p>`}</div>
`;

function EndDialog() {
  const waiting = unranked.value.length;
  const press = async () => {
    if (await end(isWaitingDropped.peek())) endIsOpen.value = false;
  };
  return html`
    <${Dialog} isOpen=${endIsOpen} id="end-dialog" labelledBy="end-title">
      <h2 id="end-title">End the tournament?</h2>
      <p>
        Nobody can enter any more. Then secret, seeds, worlds, and the settings of all entries are shown to everybody.
      </p>
      ${waiting > 0 && html`
        <label class="check">
          <input type="checkbox" checked=${isWaitingDropped.value}
            onChange=${(/** @type {Changed} */ { target }) => (isWaitingDropped.value = target.checked)} />
          Drop the ${waiting === 1 ? "entry that is" : `${waiting} entries that are`} not judged yet
        </label>
        ${!isWaitingDropped.value && html`<p class="dim">They are judged first; until then the secret is kept.</p>`}
      `}
      <${Failure} name="end" />
      <div class="row">
        <button class="danger" disabled=${busy.value.end} onClick=${press}>End the tournament</button>
        <button class="quiet" onClick=${() => (endIsOpen.value = false)}>No, go on</button>
      </div>
    <//>
  `;
}

const DeleteDialog = () => html`
  <${Dialog} isOpen=${deleteIsOpen} id="delete-dialog" labelledBy="delete-title">
    <h2 id="delete-title">Delete the tournament?</h2>
    <p>
      Its entries, their tables and the result are deleted here; for an hour that can be undone. A file that was
      downloaded stays.
    </p>
    <${Failure} name="delete" />
    <div class="row">
      <button class="danger" disabled=${busy.value.delete} onClick=${remove}>Delete the tournament</button>
      <button class="quiet" onClick=${() => (deleteIsOpen.value = false)}>No, keep it</button>
    </div>
  <//>
`;
