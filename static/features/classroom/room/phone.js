// The page of a participant: the card, the own prediction, the own robot, and after the reveal its place in the class.
import { signal } from "@preact/signals";
import { useEffect, useState } from "preact/hooks";
import { getCurve } from "../../../js/api.js";
import { Away } from "../../../js/components/away.js";
import { Dialog, html } from "../../../js/components/elements.js";
import { Loaded, Slot, withStyle } from "../../../js/features.js";
import { Prose } from "../components/prose.js";
import { codeInGroups } from "../../../js/format.js";
import { CardActions, Next } from "./card-actions.js";
import { Door, Failure, NoLanguage } from "./join.js";
import { May } from "./allowed-settings.js";
import { Answer, KINDS, scoreInWords } from "./questions.js";
import {
  arrived, busy, CLOSER, closerLink, goesOn, isRevealed, lastRunId, leave, ownAnswer, ownEntry, ownRun, ownWhatIf,
  replayed, room, shownResults,
} from "./room.js";

/** @import { Ask, Classroom, LessonCard, ResultEntry } from "../../../js/types.js" */

export function Phone() {
  const classroom = /** @type {Classroom} */ (room.value);
  if (classroom.role !== "participant") return html`<${Door} />`;
  const { me } = /** @type {{ me: NonNullable<Classroom["me"]> }} */ (classroom);
  return html`
    <header class="room-header">
      <p><b>${me.name}</b><span class="dim">seed ${me.seed}</span></p>
      <p class="dim code">${codeInGroups(classroom.code)}</p>
    </header>
    <${NoLanguage} />
    <${Away} words="Your name and your seed are kept." />
    ${classroom.state === "frozen" && html`
      <p class="strip-note" role="status">The teacher has stopped the class for a moment. Look to the front.</p>
    `}
    <main class="phone">
      ${classroom.state === "ended"
        ? html`<${Ended} />`
        : html`<${Present} key=${classroom.card} classroom=${classroom} />`}
    </main>
  `;
}

const Ended = () => html`
  <section class="phone-part">
    <h1>The lesson has ended</h1>
    <p>What your robots have learned stays with your teacher. Thank you.</p>
  </section>
`;

/** What who has not joined does not load. */
const loadOwnRobot = () => import("./participant-run.js").then(({ OwnRobot }) => OwnRobot);
const loadClass = () => import("./phone-results.js").then(({ ClassDots }) => ClassDots);
const loadWhatIf = () => import("./phone-results.js").then(({ WhatIfDots }) => WhatIfDots);
const loadTeaching = () => withStyle("features/classroom/style/teach.css", import("./teach-phone.js"))
  .then(({ TeachOnPhone }) => TeachOnPhone);
const loadOwnRun = () => import("./participant-run.js").then(({ OwnRun }) => OwnRun);

/** The card that is shown. @param {{ classroom: Classroom }} props */
function Present({ classroom }) {
  const { shown, html: texts, card, cards, state } = classroom;
  const isOpen = state === "open";
  // The reveal comes to all at once, and over a poor network: what draws it is there before.
  useEffect(() => { loadClass().catch(() => {}); }, []);
  return html`
    ${shown.teach ? html`<${Loaded} name="buttons" load=${loadTeaching} />`
      : replayed.value && html`<${Loaded} name="robot" load=${loadOwnRobot} />`}
    <article class="phone-part" aria-labelledby="card-title">
      <p class="dim">Card ${card + 1} of ${cards}</p>
      ${shown.title && html`<h1 id="card-title">${shown.title}</h1>`}
      <${Prose} text=${texts.text} />
    </article>
    ${!replayed.value && ownRun.value && html`<${Loaded} name="run" load=${loadOwnRun} />`}
    ${isRevealed.value && html`<${Revealed} classroom=${classroom} />`}
    ${shown.ask && html`<${Question} card=${shown} number=${card} text=${texts.ask} />`}
    ${shown.go && Object.keys(shown.may ?? {}).length > 0 && html`
      <${May} card=${shown} number=${card} isDisabled=${!isOpen || goesOn(ownRun.value)} />
    `}
    ${ownWhatIf.value && html`<${Loaded} name="thirty robots" load=${loadWhatIf} answer=${ownWhatIf.value} />`}
    <${Closer} card=${shown} />
    ${classroom.tournaments.length > 0 && html`<${Slot} name="phone of a room" room=${classroom} />`}
    ${!shown.teach && html`<${Next} card=${shown} />`}
    <${Leaving} />
    <${CardActions} card=${shown} number=${card} isOpen=${isOpen} />
  `;
}

const leavingIsOpen = signal(false);

/** The way out, which asks once more. */
function Leaving() {
  const { name = "" } = room.value?.me ?? {};
  const go = async () => {
    if (await leave()) leavingIsOpen.value = false;
  };
  return html`
    <button class="quiet" onClick=${() => (leavingIsOpen.value = true)}>Leave the room…</button>
    <${Dialog} isOpen=${leavingIsOpen} id="leaving" labelledBy="leaving-title">
      <h2 id="leaving-title">Leave the room?</h2>
      <p>
        This phone forgets that you are ${name}. Your answers and robots stay with the class, under that name: your
        teacher can delete them.
      </p>
      <${Failure} at="leave" />
      <div class="row">
        <button class="danger" disabled=${busy.value.leave} onClick=${go}>Leave</button>
        <button class="quiet" autofocus onClick=${() => (leavingIsOpen.value = false)}>No, stay</button>
      </div>
    <//>
  `;
}

// ---- the question

/** @param {{ card: LessonCard, number: number, text: string }} props */
function Question({ card, number, text }) {
  const locked = ownAnswer.value;
  return html`
    <section class="phone-part question" aria-label="Question">
      <${Prose} text=${text} />
      ${locked === undefined && isRevealed.value
        ? html`<p class="dim">You gave no prediction before the reveal.</p>`
        : html`<${Answer} card=${card} number=${number} locked=${locked} actual=${useOwnCurve(card)} />`}
      ${locked !== undefined && html`<p class="lock-note" role="status">Locked. It cannot be changed any more.</p>`}
    </section>
  `;
}

/** The learning curve of the own run, once it has ended, where the question is a chart. @param {LessonCard} card */
function useOwnCurve({ ask }) {
  const [curve, setCurve] = useState(/** @type {number[][]} */ ([]));
  const id = ask && KINDS[ask.kind].onChart && ownRun.value?.state === "finished" ? ownRun.value.id : null;
  useEffect(() => {
    if (id === null) return;
    getCurve(id).then(({ evaluations }) =>
      setCurve(evaluations.map(({ step, distance_m }) => [step, /** @type {number} */ (distance_m)])), () => {});
  }, [id]);
  return curve;
}

// ---- what came of it

/** Ways to the tabs of the dashboard that the card shows, with the own run. @param {{ card: LessonCard }} props */
function Closer({ card }) {
  const tabs = [...new Set([...(card.show ?? []), card.state?.tab ?? ""])].filter((tab) => tab in CLOSER);
  if (!lastRunId.value || tabs.length === 0) return null;
  return html`
    <nav class="closer" aria-label="Look closer">
      ${tabs.map((tab) => html`
        <a key=${tab} class="secondary as-button" href=${closerLink(tab)} target="_blank">${CLOSER[tab]}</a>
      `)}
    </nav>
  `;
}

// ---- after the reveal

/** Whether the picture of the own run is not yet where its distance can be told. @param {ResultEntry | null} entry */
const isStillShown = (entry) =>
  entry?.run?.state === "finished" && entry.run.kind !== "what-if" && !arrived.value.has(entry.run.id);

/** @param {{ classroom: Classroom }} props */
function Revealed({ classroom }) {
  const results = shownResults.value;
  const entry = ownEntry.value;
  if (isStillShown(entry)) {
    return html`
      <p class="dim waiting" role="status">The class comes when your robot is at its end.</p>
    `;
  }
  return html`
    <section class="phone-part revealed" aria-label="The class">
      ${results && results.distances_m.length > 0 && html`<${Loaded} name="class" load=${loadClass} />`}
      ${entry?.score && html`
        <p class="score" role="status">${scoreInWords(entry, /** @type {Ask} */ (classroom.shown.ask))}</p>
      `}
      ${classroom.html.reveal && html`<${Prose} text=${classroom.html.reveal} />`}
    </section>
  `;
}
