// Before the room: its door for a stranger, a wrong code, and what all pages of a room share.
import { useState } from "preact/hooks";
import { html } from "../../../js/components/elements.js";
import { codeInGroups, inLanguage, listed, t } from "../../../js/format.js";
import { LANGUAGES } from "../../../js/page-state.js";
import { waits } from "./busy-server.js";
import { busy, code as typedCode, failures, isRemoved, join, missingLanguage, refusal, room } from "./room.js";

/** Why something failed, or what it waits for, beside its button. @param {{ at: string }} props */
export const Failure = ({ at }) => html`
  <div role="alert">${failures.value[at] && html`<p class="problem">${failures.value[at]}</p>`}</div>
  <div role="status">${waits.value[at] && html`<${Wait} ...${waits.value[at]} />`}</div>
`;

/** That a request is made again by itself. @param {{ words: string, left_s: number }} props */
const Wait = ({ words, left_s }) => html`
  <p>
    <span class="spinner" aria-hidden="true"></span> ${words} This page tries again by
    itself<span aria-hidden="true"> in ${left_s} s</span>.
  </p>
`;

/** Told where the address names a language that there is not. */
export const NoLanguage = () => missingLanguage && html`
  <p class="strip-note" role="status">There is no language “${missingLanguage}” here. There are ${languages}.</p>
`;

const languages = listed(Object.entries(LANGUAGES).map(([code, name]) => `${name} (${code})`));

export const Waiting = () => html`
  <main class="door">
    ${waits.value.room ? html`<div role="status"><${Wait} ...${waits.value.room} /></div>`
      : html`<p role="status"><span class="spinner" aria-hidden="true"></span> Looking for the room…</p>`}
  </main>
`;

/** Where there is no room of this code: why, and a field for another one. */
export function Closed() {
  const [typed, setTyped] = useState("");
  const other = typed.replace(/[^\p{L}\p{N}]/gu, "").toUpperCase();
  return html`
    <main class="door">
      <p class="brand"><img src="../static/favicon.svg" alt="" width="24" height="24" />Racing Hexapods</p>
      <${NoLanguage} />
      <h1>
        ${typedCode.length > 16 ? t("No room of this code") : t("No room {code}", { code: typedCode })}
      </h1>
      <p role="alert">${refusal}</p>
      <label for="other-code">Code on the projector</label>
      <input id="other-code" class="code-field" type="text" maxlength="16" autocomplete="off"
        autocapitalize="characters" spellcheck=${false} value=${typed}
        onInput=${(/** @type {any} */ { target }) => setTyped(target.value)} />
      <a class="primary as-button" href=${other ? inLanguage(other) : undefined}
        aria-disabled=${other ? undefined : "true"}>
        Go to the room
      </a>
    </main>
  `;
}

/** A stranger sees the lesson's title, and joins with one press. */
export function Door() {
  const { code, title, state, participants } = /** @type {any} */ (room.value);
  if (state === "ended") {
    return html`
      <main class="door">
        <h1>${title}</h1>
        <p role="status">This room has ended. Ask your teacher for the code of a new one.</p>
      </main>
    `;
  }
  return html`
    <main class="door">
      <p class="brand"><img src="../static/favicon.svg" alt="" width="24" height="24" />Racing Hexapods</p>
      <${NoLanguage} />
      <h1>${title}</h1>
      ${isRemoved.value && html`
        <p class="strip-note warn" role="alert">
          You are not in this room any more: your teacher has taken you out, or the seat was needed and you had done
          nothing yet. You can join again, with another name and another robot.
        </p>
      `}
      <p class="dim">Room <b class="code">${codeInGroups(code)}</b>
        ${participants > 0 && t(" · {number} in it", { number: participants })}</p>
      <button class="primary" disabled=${busy.value.join} onClick=${join}>Join</button>
      <${Failure} at="join" />
      <p class="dim">You get a name from a list and a robot of your own. No account is needed.</p>
    </main>
  `;
}
