// The lesson of this page, the first one or that of the address: its cards, and how far this page is. A card of the
// first one may ask for a prediction, which is revealed at time-out.
import { computed, effect, signal } from "@preact/signals";
import { asTexts, change, page } from "../../js/page-state.js";
import { storedText } from "../../js/page.js";
import { isTimedOut, standings } from "../../js/race.js";
import { mayStart } from "../../js/selectors.js";
import { raceInView } from "../../js/on-stage.js";
import { agentOf, isLifted, isPreset, laneTitle, restriction } from "../../js/settings.js";

/** @import { Signal } from "@preact/signals" */
/** @import { PageState } from "../../js/page-state.js" */
/** @import { LessonCard, LessonView } from "../../js/types.js" */

/**
 * `state`: what of the page the card opens. `ask`: a question whose answer is one of the lanes. `isForOperators`:
 * whether it needs somebody who may start runs.
 * @typedef {{ title: string, text: string, state?: Partial<PageState>, ask?: "lane", isForOperators?: boolean }} Card
 */

/** @type {Card[]} */
const CARDS = [
  {
    title: "Moves",
    text: "A step puts one group of legs in another place. It has to find an order of moves that walks.",
  },
  {
    title: "Colours on the feet",
    text: "Squares are places that a foot can go to. Dark: worth little. Light: worth much.",
  },
  { title: "Who is ahead at time-out?", text: "Choose before the robots get there.", ask: "lane" },
  {
    title: "Change α while it learns", text: "What does the curve do?", isForOperators: true,
    state: { depth: "try", tab: "train" },
  },
  {
    title: "Take the power from a leg", text: "Hold the race, click a leg, race on. Who copes better?",
    isForOperators: true, state: { depth: "try", tab: "world" },
  },
  {
    title: "Where does the value come from?", text: "Find r, γ and Q′ in the rule.",
    state: { depth: "study", tab: "why" },
  },
  { title: "Is 0.3 the best α?", text: "Try others on thirty robots.", state: { depth: "study", tab: "what-if" } },
];

/** Whether the lesson was done or hidden: "done". */
const openState = storedText("lesson", "open");

/** The cards of the lesson for who looks at this page. */
export const cards = computed(() => (linked.value
  ? linked.value.cards.map(asCard)
  : CARDS.filter(({ isForOperators }) => mayStart.value || !isForOperators)));

/** A card of the lesson that the address names; its texts are read in a dialog. */
/** @type {(one: LessonCard, n: number) => Card} */
function asCard({ title, ask, state }, n) {
  const { form, ...pageState } = state ?? {};
  const set = Object.entries(pageState).filter(([, value]) => value !== null);
  return {
    title: title ?? `Card ${n + 1}`, text: ask?.text ?? "",
    state: { ...Object.fromEntries(set), ...(form && { form: asTexts(form) }) },
  };
}

/** Fields of a card's state that are null unless a link says them. */
const SAID_BY_LINKS = /** @type {const} */ (["run", "ghost", "moment", "depth", "tab", "pinned"]);

/** Show the lesson that the address names, from its open card on. */
export function followLesson() {
  effect(() => {
    // A card that runs nothing has no settings.
    restriction.value = linkedCard.value?.go
      ? { bounds: linkedCard.value.may ?? {}, reason: "The lesson's card sets" } : null;
  });
  effect(() => { isPreset.value = page.lesson.value !== null; });
  followLinkedLesson(() => {
    const number = Math.min(page.card.peek() ?? 1, cards.peek().length);
    const { state = {} } = cards.peek()[number - 1];
    // What the link says itself goes before what the card presets.
    const said = SAID_BY_LINKS.filter((name) => page[name].peek() !== null);
    const typed = page.form.peek();
    const preset = [...state.form ?? []].filter(([name]) => !typed.has(name));
    const pageState = Object.fromEntries(said.map((name) => [name, page[name].peek()]));
    openCard(number);
    change({ ...pageState, ...(state.form && { form: new URLSearchParams([...preset, ...typed]) }) });
  });
}

/** The number of the open card, from 1; null where the lesson is hidden. At a first visit it is the first. */
export const cardNumber = computed(() => {
  if (page.hidden.value.includes("card")) return null;
  const number = page.card.value ?? (openState.value === "done" || page.lesson.value !== null ? null : 1);
  return number !== null && number <= cards.value.length ? number : null;
});

/** The open card; null without one. */
export const card = computed(() => (cardNumber.value === null ? null : cards.value[cardNumber.value - 1]));

/** Open a card, and of the page what it is about. @param {number} number from 1 */
export function openCard(number) {
  const { state = {} } = cards.peek()[number - 1];
  change({ view: "race", card: number, hidden: page.hidden.peek().filter((name) => name !== "card"), ...state });
}

/** Go to another card; after the last one the lesson is done. @param {1 | -1} direction */
export function turnCard(direction) {
  const next = (cardNumber.peek() ?? 0) + direction;
  if (next > cards.peek().length) closeLesson();
  else if (next >= 1) openCard(next);
}

export const openLesson = () => openCard(1);

export const closeLesson = () => {
  openState.value = "done";
  change({ card: null, lesson: null });
};

// ---- the lesson that the address names, in place of the first one: it presets the page and hides what its cards do
// not show; that is courtesy, since only a room locks anything

/** Null without one, and until the server has answered. @type {Signal<LessonView | null>} */
export const linked = signal(null);
/** Why the lesson of the address cannot be shown. */
export const linkProblem = signal("");

/** Its open card; null without one. @type {import("@preact/signals").ReadonlySignal<LessonCard | null>} */
export const linkedCard = computed(() => linked.value?.cards[(page.card.value ?? 1) - 1] ?? null);

/** Whether a tab of the panel is shown by the open card. @param {string} tab */
export const isShown = (tab) => linkedCard.value?.show?.some((name) => name === tab) ?? true;

/** Load the lesson that the address names, and tell once it is there. @param {() => unknown} onLoaded */
export const followLinkedLesson = (onLoaded) => effect(() => {
  const id = page.lesson.value;
  linkProblem.value = "";
  if (id === linked.peek()?.id) return;
  linked.value = null;
  isLifted.value = false;
  if (id === null) return;
  // Most visits have none.
  import("./api.js").then(({ getLesson }) => getLesson(id)).then((lesson) => {
    if (page.lesson.peek() !== id) return;
    linked.value = lesson;
    onLoaded();
  }, ({ message }) => (linkProblem.value = message));
});

// ---- the prediction

/** The lane that was predicted to be ahead, and the race; null before. */
const predicted = signal(/** @type {{ race: string | null, lane: number } | null} */ (null));

/** The lanes that can be predicted: of the race in view. */
export const predictable = computed(() => (raceInView.value?.config.lanes ?? []).map((lane, number) => ({
  lane: number, title: laneTitle(lane), color: agentOf(lane.agent).color,
})));

/** The number of the predicted lane; null before the prediction, or where it was of another race. */
export const prediction = computed(() =>
  (predicted.value && predicted.value.race === (raceInView.value?.id ?? null) ? predicted.value.lane : null));

/** @param {number} lane */
export const predict = (lane) => {
  if (prediction.peek() === null && !isTimedOut.peek()) predicted.value = { race: raceInView.peek()?.id ?? null, lane };
};

/** The winners of the race in view, once it is decided; null before. */
export const outcome = computed(() =>
  (isTimedOut.value ? (standings.value ?? []).filter(({ rank }) => rank === 1) : null));
