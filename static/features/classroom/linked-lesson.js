// The lesson that the address names, which most visits do not have: it presets the page, and its buttons read a card in
// full and turn the cards.
import { effect, signal } from "@preact/signals";
import { t } from "../../js/format.js";
import { change, page } from "../../js/page-state.js";
import { isLifted, restriction } from "../../js/settings.js";
import { html } from "../../js/components/elements.js";
import { getLesson } from "./api.js";
import { LessonReader } from "./components/lesson-reader.js";
import { cardNumber, leave, openCard, total } from "./feature.js";
import { linked, linkedCard, linkProblem, stateOf } from "./lesson.js";

/** @import { LessonView } from "../../js/types.js" */

/** Whether its card is read in full. */
export const readerIsOpen = signal(false);

/** Fields of a card's state that are null unless a link says them. */
const SAID_BY_LINKS = /** @type {const} */ (["run", "ghost", "moment", "depth", "tab", "pinned"]);

/** Open the card of the address, and of what its state presets that which the link does not say itself. */
function openLinkedCard() {
  const number = Math.min(page.card.peek() ?? 1, total.peek());
  const { form: preset = null } = stateOf(/** @type {LessonView} */ (linked.peek()).cards[number - 1]);
  const said = SAID_BY_LINKS.filter((name) => page[name].peek() !== null);
  const typed = page.form.peek();
  const others = [...preset ?? []].filter(([name]) => !typed.has(name));
  const pageState = Object.fromEntries(said.map((name) => [name, page[name].peek()]));
  openCard(number);
  change({ ...pageState, ...(preset && { form: new URLSearchParams([...others, ...typed]) }) });
}

/** Load the lesson that the address names, and preset the page once it is there. */
export function followLinkedLesson() {
  effect(() => {
    // A card that runs nothing has no settings.
    restriction.value = linkedCard.value?.go
      ? { bounds: linkedCard.value.may ?? {}, reason: t("The lesson's card sets") } : null;
  });
  effect(() => {
    const id = page.lesson.value;
    linkProblem.value = "";
    if (id === linked.peek()?.id) return;
    linked.value = null;
    isLifted.value = false;
    if (id === null) return;
    getLesson(id).then((lesson) => {
      if (page.lesson.peek() !== id) return;
      linked.value = lesson;
      openLinkedCard();
    }, ({ message }) => (linkProblem.value = message));
  });
}

/** Go to the next card; after the last the lesson is left. */
const turnCard = () => (cardNumber.peek() === total.peek() ? leave() : openCard((cardNumber.peek() ?? 0) + 1));

/** Its buttons on the card below the time bar. */
export const Buttons = () => html`
  <button class="secondary compact" onClick=${() => (readerIsOpen.value = true)}>Read</button>
  <${LessonReader} />
  <button class="secondary compact" onClick=${turnCard}>
    ${cardNumber.value === total.value ? t("Done") : t("Next")}
  </button>
`;
