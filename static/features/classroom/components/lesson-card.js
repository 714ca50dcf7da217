// The lesson's card below the time bar: a question or a task, one's own prediction, and the way to the next one.
import { signal } from "@preact/signals";
import { useEffect } from "preact/hooks";
import {
  card, cardNumber, cards, closeLesson, linked, linkProblem, outcome, predict, predictable, prediction, turnCard,
} from "../lesson.js";
import { listed } from "../../../js/format.js";
import { isCardFolded, isPhone } from "../../../js/page.js";
import { isAtLeast } from "../../../js/workspace.js";
import { html } from "../../../js/components/elements.js";
import { Loaded, withStyle } from "../../../js/features.js";

/** Whether the card of the lesson that the address names is read in full. */
export const readerIsOpen = signal(false);

const loadReader = () =>
  withStyle("style/card.css", import("./lesson-reader.js")).then(({ LessonReader }) => LessonReader);

export function LessonCard() {
  const shown = card.value;
  // A new one is not folded, as on a phone the one before may be.
  useEffect(() => {
    isCardFolded.value = false;
  }, [cardNumber.value]);
  if (linkProblem.value) return html`<${NoLesson} />`;
  if (!shown) return null;
  const isLast = cardNumber.value === cards.value.length;
  return html`
    <section class="card-bar" aria-label="Lesson">
      <span class="card-number">Card ${cardNumber} of ${cards.value.length}</span>
      <p aria-live="polite"><b>${shown.title}${/[?.]$/.test(shown.title) ? "" : "."}</b>${" "}
        <span>${shown.ask && (outcome.value || isPhone.value) ? "" : shown.text}</span></p>
      ${shown.ask && html`<${Prediction} />`}
      ${linked.value && html`
        <button class="secondary compact" onClick=${() => (readerIsOpen.value = true)}>Read</button>
        <${Loaded} name="card of the lesson" load=${loadReader} />
      `}
      <button class="secondary compact" onClick=${() => turnCard(1)}>${isLast ? "Done" : "Next"}</button>
      ${isAtLeast("try") && html`
        <button class="quiet square small" aria-label="Hide the lesson" title="Hide the lesson" onClick=${closeLesson}>
          ✕
        </button>
      `}
    </section>
  `;
}

/** The address names a lesson that is not here. */
const NoLesson = () => html`
  <section class="card-bar" aria-label="Lesson">
    <p role="alert">${linkProblem}</p>
    <button class="secondary compact" onClick=${closeLesson}>Without a lesson</button>
  </section>
`;

/** The lanes to choose from; then what was chosen, and at time-out what came of it. */
export function Prediction() {
  const lanes = predictable.value;
  const predictedLane = lanes.find(({ lane }) => lane === prediction.value);
  const winners = outcome.value;
  if (winners?.length) {
    const isRight = winners.some(({ lane }) => lane === prediction.value);
    const verdict = `It ${winners.length > 1 ? "is level:" : "was"} ${listed(winners.map(({ title }) => title))}.`;
    const remark = isRight ? " You were right." : ` You chose ${predictedLane?.title}.`;
    return html`<p class="prediction" role="status">${verdict}${predictedLane && remark}</p>`;
  }
  if (predictedLane) {
    return html`
      <p class="prediction" style=${{ "--agent": predictedLane.color }}>
        Your prediction: <span class="swatch"></span><b>${predictedLane.title}</b>
      </p>
    `;
  }
  return html`
    <span class="prediction" role="group" aria-label="Your prediction">
      ${lanes.map(({ lane, title, color }) => html`
        <button class="chip" style=${{ "--agent": color }} onClick=${() => predict(lane)}>
          <span class="swatch"></span>${title}
        </button>
      `)}
      ${lanes.length === 0 && html`<span class="dim">Start a race first.</span>`}
    </span>
  `;
}
