// The dialog that opens a room: which lesson, and then its code and the way to its cockpit.
import { useEffect, useState } from "preact/hooks";
import { addressOf } from "../../../js/page-state.js";
import {
  chosenLesson, isBusy, isReachable, lessonInWords, lessons, opened, openRoom, problem, roomIsOpen, rooms,
} from "../lessons/list.js";
import { codeInGroups, inLanguage, shortAddress } from "../../../js/format.js";
import { Dialog, html } from "../../../js/components/elements.js";
import { PupilsWindow, Sharing } from "./sharing.js";

/** @import { ListedRoom, NewRoom } from "../../../js/types.js" */

export function OpenRoom() {
  const [needsApproval, setApproval] = useState(false);
  useEffect(() => {
    // The first lesson is as good as any to begin with.
    if (chosenLesson.value === null && lessons.value?.length) chosenLesson.value = lessons.value[0].id;
  }, [lessons.value]);
  return html`
    <${Dialog} isOpen=${roomIsOpen} id="open-room" labelledBy="open-room-title" style="open-room">
      <div class="dialog-head">
        <h2 id="open-room-title">${opened.value ? "The room is open" : "Open a room"}</h2>
        <button class="quiet square" aria-label="Close" onClick=${() => (roomIsOpen.value = false)}>✕</button>
      </div>
      ${opened.value ? html`<${Opened} room=${opened.value} />` : html`
        ${isReachable.value ? html`
          <p class="dim">A class joins by a code, without accounts. Each learner is one seed of one experiment.</p>
        ` : html`<${Sharing} />`}
        <${Choice} />
        <label class="check">
          <input type="checkbox" checked=${needsApproval} onChange=${() => setApproval(!needsApproval)} />
          Show names and results of participants only after I approve each
        </label>
        <div role="alert">${problem.value && html`<p class="problem">${problem}</p>`}</div>
        <button class=${isReachable.value ? "primary" : "secondary"}
          aria-disabled=${isBusy.value || !chosenLesson.value ? "true" : undefined}
          onClick=${() => chosenLesson.value && openRoom(needsApproval)}>
          ${isReachable.value ? "Open the room" : "Try a room on this computer alone"}
        </button>
        <${Rooms} title="Open rooms" found=${rooms.value.filter(({ state }) => state !== "ended")} />
        <${Rooms} title="Rooms that have ended"
          found=${rooms.value.filter(({ state }) => state === "ended").reverse()} />
      `}
    <//>
  `;
}

function Choice() {
  if (lessons.value === null) return html`<p role="status">Loading the lessons…</p>`;
  return html`
    <fieldset class="lesson-choice">
      <legend>Lesson</legend>
      ${lessons.value.map((lesson) => html`
        <label key=${lesson.id}>
          <input type="radio" name="lesson" value=${lesson.id} checked=${chosenLesson.value === lesson.id}
            onChange=${() => (chosenLesson.value = lesson.id)} />
          <span>
            <b>${lesson.title}</b>
            <span class="dim">${lessonInWords(lesson)}${lesson.is_built_in ? "" : " · made here"}</span>
          </span>
        </label>
      `)}
    </fieldset>
    <p class="fine"><a href=${addressOf({ view: "lessons" })} onClick=${() => (roomIsOpen.value = false)}>
      All lessons, and make one</a></p>
  `;
}

/** @param {{ room: NewRoom }} props */
const Opened = ({ room }) => html`
  ${room.qr_code ? html`
    <div class="opened-room">
      <img src=${room.qr_code} alt=${`QR code of ${room.address}`} />
      <div>
        <p class="room-code">${codeInGroups(room.code)}</p>
        <p class="address">${shortAddress(room.address)}</p>
      </div>
    </div>
  ` : html`
    <p>It is on this computer alone: phones cannot come to it.</p>
    <${PupilsWindow} address=${room.address} />
  `}
  <a class="primary button-link" href=${inLanguage(`r/${room.code}`)}>Teach: open the cockpit</a>
  <a class="secondary button-link" href=${inLanguage(`r/${room.code}?projector`)} target="_blank">Open the projector</a>
`;

/** @param {{ title: string, found: ListedRoom[] }} props */
const Rooms = ({ title, found }) => found.length > 0 && html`
  <section aria-label=${title}>
    <h3>${title}</h3>
    <ul class="open-rooms">
      ${found.map(({ code, title: lesson, participants }) => html`
        <li key=${code}>
          <a href=${inLanguage(`r/${code}`)}><b>${codeInGroups(code)}</b> ${lesson}</a>
          <span class="dim">${participants} in it</span>
        </li>
      `)}
    </ul>
  </section>
`;
