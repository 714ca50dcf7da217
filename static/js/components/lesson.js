// A first lesson in four steps: open on the first visit until it is done or skipped, and again from the help.
import { useEffect, useRef, useState } from "preact/hooks";
import { primaryAction } from "../actions.js";
import { closeLesson, lesson } from "../page.js";
import { isOperator } from "../selectors.js";
import { html } from "./elements.js";

/** [title, words]; the last is for those who can start a run. */
const steps = () => [
  ["What moves", "In each step a robot puts one pair of its legs in another place. Some moves carry it forward, some " +
    "back, and some nowhere: it has to find an order of moves that walks."],
  ["What the colours on the feet mean", "The squares below a learner’s feet are the places that a foot can go to. " +
    "Dark: the learner expects little from that move. Light: it expects much."],
  ["What the learner tries", "At first it moves at random. After each step it measures how far that took it, and " +
    "corrects the value of that move in its table. The more it has practised, the more often it makes the best move."],
  ["What to change first", `Press “${primaryAction.value.label}” and watch. Then change one thing, the practice ` +
    "or the learning rate α, and race again. “What if?” tries the settings with thirty robots at once."],
];

export function Lesson() {
  return lesson.value ? html`<${Card} />` : null;
}

function Card() {
  const [at, setAt] = useState(0);
  const card = useRef(/** @type {HTMLElement | null} */ (null));
  useEffect(() => {
    // After the dialog that opened it has given the focus back.
    if (lesson.peek() === "again") setTimeout(() => card.current?.focus());
  }, []);
  const all = isOperator.value ? steps() : steps().slice(0, -1);
  const [title, words] = all[at];
  const isLast = at === all.length - 1;
  const close = () => {
    closeLesson();
    document.getElementById("main")?.focus({ preventScroll: true });
  };
  return html`
    <section class="panel lesson" aria-labelledby="lesson-title" tabindex="-1" ref=${card}>
      <div class="lesson-head">
        <h2 id="lesson-title">A first lesson</h2>
        <span class="dim">${at + 1} of ${all.length}<span class="wide-only">, two minutes in all</span></span>
        <button class="quiet" onClick=${close}>Skip the lesson</button>
      </div>
      <p aria-live="polite"><b>${title}.</b> ${words}</p>
      <div class="row">
        <button class="secondary compact" disabled=${at === 0} onClick=${() => setAt(at - 1)}>Back</button>
        <button class="secondary compact" onClick=${isLast ? close : () => setAt(at + 1)}>
          ${isLast ? "Done" : "Next"}
        </button>
      </div>
    </section>
  `;
}
