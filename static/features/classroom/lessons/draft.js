// The lesson that is being made: kept by the browser until it is stored on the server.
import { computed, signal } from "@preact/signals";
import { page } from "../../../js/page-state.js";
import { storedText } from "../../../js/page.js";
import { depth } from "../../../js/workspace.js";

/** @import { LessonCard, LessonDocument, LessonView } from "../../../js/types.js" */

/** @type {LessonDocument} */
const EMPTY = { title: "", cards: [{ text: "" }] };
/** Fields of the form that a room says by itself. */
const LEFT_OUT = ["seed", "name", "pace"];
const REPEATED = "disturb";

const storedDraft = storedText("lesson-draft", "");

/** @returns {LessonDocument | null} */
function readKept() {
  try {
    const draft = JSON.parse(storedDraft.peek());
    return Array.isArray(draft?.cards) && draft.cards.length > 0 ? draft : null;
  } catch {
    return null;
  }
}

const document_ = signal(readKept());

/** The draft; null while none is made. */
export const draft = computed(() => document_.value);
/** The number of the card that is edited, from 0. */
export const chosen = signal(0);
/** That card. */
export const chosenCard = computed(() => draft.value?.cards[chosen.value] ?? null);

/** @param {LessonDocument | null} lesson */
function put(lesson) {
  document_.value = lesson;
  storedDraft.value = lesson === null ? "" : JSON.stringify(lesson);
}

/** Begin a lesson, or edit a copy of one. @param {LessonDocument} [lesson] */
export function begin(lesson = EMPTY) {
  put(lesson);
  chosen.value = 0;
}

/** Leave the draft, which is lost. */
export const discard = () => put(null);

/** @param {Partial<LessonDocument>} changes */
export const changeLesson = (changes) => put({ .../** @type {LessonDocument} */ (draft.peek()), ...changes });

/** @param {(cards: LessonCard[]) => LessonCard[]} change */
const changeCards = (change) => changeLesson({ cards: change([...draft.peek()?.cards ?? []]) });

/** Change the card that is edited. @param {Partial<LessonCard>} changes */
export const changeCard = (changes) =>
  changeCards((cards) => cards.map((card, n) => (n === chosen.peek() ? { ...card, ...changes } : card)));

/** Add a card after the one that is edited. */
export function addCard() {
  changeCards((cards) => cards.toSpliced(chosen.peek() + 1, 0, { text: "" }));
  chosen.value += 1;
}

/** Remove the card that is edited, unless it is the last one. */
export function removeCard() {
  if ((draft.peek()?.cards.length ?? 0) < 2) return;
  changeCards((cards) => cards.toSpliced(chosen.peek(), 1));
  chosen.value = Math.max(0, chosen.peek() - 1);
}

/** Move the card that is edited up or down. @param {1 | -1} direction */
export function moveCard(direction) {
  const to = chosen.peek() + direction;
  const all = draft.peek()?.cards ?? [];
  if (to < 0 || to >= all.length) return;
  changeCards((cards) => cards.toSpliced(chosen.peek(), 1).toSpliced(to, 0, cards[chosen.peek()]));
  chosen.value = to;
}

// ---- what a card takes of the page

/** The page as it is, as the state of a card: what differs from the defaults. */
export function pageAsState() {
  /** @type {Record<string, any>} */
  const form = {};
  for (const [name, text] of page.form.peek()) {
    if (name === REPEATED) form[name] = [...form[name] ?? [], text];
    else if (!LEFT_OUT.includes(name)) form[name] = text;
  }
  const { run, ghost, moment, clock, end, tab, pinned, camera, hidden } = page;
  const hiddenParts = hidden.peek();
  const set = {
    run: run.peek(), ghost: ghost.peek(), moment: moment.peek(), tab: tab.peek(), pinned: pinned.peek(),
    clock: run.peek() && clock.peek() !== "paper" ? clock.peek() : null,
    end: run.peek() && end.peek() !== "time-out" ? end.peek() : null,
    camera: camera.peek() === "directed" ? null : camera.peek(),
    hidden: hiddenParts.length > 0 ? hiddenParts : null,
    form: Object.keys(form).length > 0 ? form : null,
  };
  const entries = Object.entries(set).filter(([, value]) => value !== null);
  return /** @type {NonNullable<LessonCard["state"]>} */ ({ depth: depth.peek(), ...Object.fromEntries(entries) });
}

/** A lesson of the server as a document that can be edited: without what is null, and what the server adds. */
/** @type {(lesson: LessonView) => LessonDocument} */
export const documentOf = ({ title, language, minutes, ages, aims, before, after, cards }) =>
  without({ title, language, minutes, ages, aims, before, after, cards });

/** Leave out, at any depth, what is null or empty. @param {any} value @returns {any} */
function without(value) {
  if (Array.isArray(value)) return value.map(without);
  if (value === null || typeof value !== "object") return value;
  const pairs = Object.entries(value)
    .filter(([, field]) => field !== null && field !== undefined).map(([name, field]) => [name, without(field)]);
  // Bounds of a setting may be empty: all that is valid.
  return Object.fromEntries(pairs.filter(([, field]) => !isEmpty(field)));
}

/** @param {unknown} value */
const isEmpty = (value) => Array.isArray(value) && value.length === 0;

/** The draft as it is sent: without texts that are empty. @param {LessonDocument} lesson @returns {LessonDocument} */
export const toSend = ({ title, language, minutes, ages, aims, before, after, cards }) => without({
  title: title.trim(), language: language?.trim() || null, minutes: minutes ?? null, ages: ages?.trim() || null,
  aims: aims ?? [], before: before ?? null, after: before ? after ?? null : null,
  cards: cards.map(({ title: cardTitle, reveal, ...card }) => ({
    ...card, title: cardTitle?.trim() || null, reveal: revealToSend(reveal ?? null),
  })),
});

/** @param {LessonCard["reveal"]} reveal */
function revealToSend(reveal) {
  if (reveal === null || typeof reveal === "string") return reveal || null;
  const { text, answer = null } = /** @type {{ text?: string | null, answer?: string | number | null }} */ (reveal);
  return answer === null || answer === "" ? text || null : { text: text ?? "", answer };
}
