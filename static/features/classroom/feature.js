// Lessons and rooms: the card of the first lesson is there from the start, all else is loaded when it is opened.
import { helpIsOpen } from "../../js/page.js";
import { html } from "../../js/components/elements.js";
import { LessonCard, Prediction } from "./components/lesson-card.js";
import { card, cardNumber, cards, closeLesson, followLesson, isShown, openCard, openLesson } from "./lesson.js";

/** @import { Feature } from "../../js/types.js" */

const FirstLesson = () => html`
  <button type="button" class="secondary" onClick=${() => { helpIsOpen.value = false; openLesson(); }}>
    Show the first lesson
  </button>
`;

/** @type {Partial<Feature>} */
export default {
  menu: [
    { title: "Lessons", order: 30, group: "class", href: "#lessons" },
    {
      title: "Open a room…", order: 31, group: "class", for: "operator", dialog: "rooms",
      call: "lessons/list.js#askForRoom",
    },
    {
      title: () => (card.value ? "Hide the lesson" : "The first lesson"), order: 33, group: "help",
      run: () => (card.peek() ? closeLesson : openLesson)(),
    },
  ],
  slots: { card: { component: LessonCard }, "buttons of the help": { component: FirstLesson } },
  follow: followLesson,
  hidesTab: (tab) => !isShown(tab),
  deck: { cards, number: cardNumber, open: openCard, Question: Prediction },
};
