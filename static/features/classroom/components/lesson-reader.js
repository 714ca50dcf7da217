// A card of the lesson that the address names, in full: its text, its question, and what is revealed.
import { useEffect, useState } from "preact/hooks";
import { cardNumber } from "../feature.js";
import { linked, linkedCard } from "../lesson.js";
import { readerIsOpen } from "../linked-lesson.js";
import { Answer, draftOf } from "../room/questions.js";
import { t } from "../../../js/format.js";
import { Dialog, html } from "../../../js/components/elements.js";
import { Prose } from "./prose.js";

/** @import { LessonView } from "../../../js/types.js" */

export function LessonReader() {
  const [isRevealed, setRevealed] = useState(false);
  const number = (cardNumber.value ?? 1) - 1;
  useEffect(() => setRevealed(false), [number]);
  // Each card is read first; what it is about is on the page behind.
  useEffect(() => { readerIsOpen.value = true; }, [linked.value?.id, number]);
  const [card, texts] = [linkedCard.value, linked.value?.html[number]];
  if (!card || !texts) return null;
  const answer = draftOf(card, number);
  return html`
    <${Dialog} isOpen=${readerIsOpen} id="lesson-reader" labelledBy="reader-title" style="reader">
      <p class="dim">${linked.value?.title} · card ${number + 1} of ${linked.value?.cards.length}</p>
      <${About} lesson=${linked.value} number=${number} />
      <h2 id="reader-title">${card.title ?? t("Card {number}", { number: number + 1 })}</h2>
      <${Prose} text=${texts.text} />
      ${card.ask && html`
        <section class="question" aria-label="Question">
          <${Prose} text=${texts.ask} />
          <${Answer} card=${card} number=${number} locked=${isRevealed && answer !== undefined ? answer : undefined} />
        </section>
      `}
      ${texts.reveal && isRevealed && html`<div class="revealed"><${Prose} text=${texts.reveal} /></div>`}
      <div class="row">
        <button class="primary" onClick=${() => (readerIsOpen.value = false)}>To the page</button>
        ${texts.reveal && !isRevealed && html`
          <button class="secondary" onClick=${() => setRevealed(true)}>Reveal</button>
        `}
      </div>
      <${Taught} />
      <p class="fine dim">
        Outside of a room the lesson presets the page and hides parts of it as a courtesy: nothing is locked, and your
        answer stays on this page.
      </p>
    <//>
  `;
}

/** How long the lesson is, for whom, and what it is for: at its first card. */
/** @param {{ lesson: LessonView, number: number }} props */
const About = ({ lesson: { minutes, ages, aims }, number }) => number === 0 && html`
  ${(minutes || ages) && html`
    <p class="dim">
      ${[minutes && t("{minutes}\u00a0{minutes|minute|minutes}", { minutes }), ages].filter(Boolean).join(" · ")}
    </p>
  `}
  ${aims.length > 0 && html`<ul class="aims">${aims.map((aim) => html`<li key=${aim}>${aim}</li>`)}</ul>`}
`;

/** Told while parts of the lesson are left out. */
const Taught = () => linked.value?.is_taught && html`
  <p class="dim" role="status">
    A class is taught this lesson at present: what it reveals, and the cards that are still to come, are here once the
    room has ended.
  </p>
`;
