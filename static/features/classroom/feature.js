// Lessons and rooms. The card below the time bar is there from the start, of the first lesson or of that which the
// address names: a question or a task, and the way to the next one. All else is loaded when it is opened.
import { computed, effect, untracked } from "@preact/signals";
import { useEffect, useLayoutEffect, useRef } from "preact/hooks";
import { t } from "../../js/format.js";
import { pending, resume, resumeRun, setShared } from "../../js/actions.js";
import { earlyEndOf } from "../../js/narrative/moment.js";
import { change, page } from "../../js/page-state.js";
import { helpIsOpen, isCardFolded } from "../../js/page.js";
import { followRuns } from "../../js/runs.js";
import { isOperator, mayChange, mayStart } from "../../js/selectors.js";
import { isPreset } from "../../js/settings.js";
import { isAway, isGone, options } from "../../js/store.js";
import { isAtLeast, isPanelHidden, openTab, tab } from "../../js/workspace.js";
import { html } from "../../js/components/elements.js";
import { Loaded, withStyle } from "../../js/features.js";
import { candidates, FIRST, goTo, LEARNING, notedAt, show, vote, voteFor } from "./first-lesson.js";
import {
  isComing, isInPicture, isShown, keep, lessonProgress, linked, linkProblem, practice, race, restart, stateOf,
} from "./lesson.js";

/** @import { Feature, Run } from "../../js/types.js" */
/** @import { FirstCard, Said } from "./first-lesson.js" */

// ---- the cards, and which one is open

/** The cards of the first lesson that this page has. */
const first = computed(() => FIRST.filter(({ isThere }) => isThere?.() ?? true));

/** Number of the open card of the first lesson, from 1; 0 once it is done. */
const firstNumber = computed(() => {
  const { at } = lessonProgress.value;
  if (at === "done") return 0;
  const place = FIRST.findIndex(({ name }) => name === at);
  // Of a card that this page does not have, the next.
  return 1 + first.value.findIndex((card) => FIRST.indexOf(card) >= place);
});

/** How many cards the lesson has. */
export const total = computed(() => linked.value?.cards.length ?? first.value.length);

/** The number of the open card, from 1; null where the lesson is hidden. */
export const cardNumber = computed(() => {
  if (page.hidden.value.includes("card") || options.value === null) return null;
  if (page.lesson.value !== null) {
    const number = page.card.value ?? 1;
    return linked.value !== null && number <= total.value ? number : null;
  }
  return lessonProgress.value.isHidden ? null : firstNumber.value || null;
});

/** What a card says. @param {number} number from 1 @returns {Said} */
function saidOn(number) {
  if (linked.value === null) return saidBy(first.value[number - 1]);
  const { title, ask } = linked.value.cards[number - 1];
  return { title: title ?? t("Card {number}", { number }), text: ask?.text ?? "", press: null };
}

/** What the cards say now, for those who read all of them. */
export const cards = computed(() => (options.value === null
  ? [] : Array.from({ length: total.value }, (_, n) => ({ ...saidOn(n + 1), ...askOf(n + 1) }))));

/** What a card asks, for those who read all of them. @param {number} number @returns {{ ask?: "lane" }} */
const askOf = (number) => (linked.value === null && first.value[number - 1].name === "vote" ? { ask: "lane" } : {});

/** Whether the open card asks for the vote. */
const isVoting = computed(() => cardNumber.value !== null && askOf(cardNumber.value).ask !== undefined);

/** What the open card says; null without one. */
export const card = computed(() => (cardNumber.value === null ? null : saidOn(cardNumber.value)));

/** Open a card, and of the page what it is about. @param {number} number from 1 */
export function openCard(number) {
  const hidden = page.hidden.peek().filter((name) => name !== "card");
  const linkedCards = linked.peek()?.cards;
  if (linkedCards) change({ view: "race", card: number, hidden, ...stateOf(linkedCards[number - 1]) });
  else {
    keep({ at: first.peek()[number - 1].name, isHidden: false });
    change({ card: null, hidden });
  }
}

/** Leave the lesson of the address. */
export const leave = () => change({ card: null, lesson: null });

/** Hide the lesson; the first one goes on from there when it is opened again. */
export const closeLesson = () => (page.lesson.peek() === null ? keep({ isHidden: true }) : leave());

/** Open the first lesson where it was left; from its beginning once it is done. */
export function openLesson() {
  if (lessonProgress.peek().at === "done") restart();
  keep({ isHidden: false });
  change({ view: "race", card: null, lesson: null, hidden: page.hidden.peek().filter((name) => name !== "card") });
}

// ---- what keeps a card from what it says

/** Of a run that ended too early. @param {Run} run @returns {Said} */
function ofEarlyEnd(run) {
  const verb = earlyEndOf(run)?.verb ?? "";
  const isRace = run.kind === "race";
  const title = t("The {run} {verb}.", { run: isRace ? t("race") : t("training"), verb });
  if (run.can_resume && isOperator.value) {
    const isHeld = Boolean(pending.value[run.id]) || isAway.value;
    return { title, text: t("It can go on."), press: { label: t("Go on"), run: () => resumeRun(run), isHeld } };
  }
  const again = isRace ? goTo("ready", () => keep({ race: null })) : restart;
  return { title, text: "", press: { label: isRace ? t("Back to the start") : t("Begin again"), run: again } };
}

/** Of a run that waits for a person to let it go on. @param {Run} run @returns {Said} */
const ofPause = (run) => ({
  title: run.kind === "race" ? t("The race is paused.") : t("The training is paused."), text: "",
  press: { label: t("Go on"), run: resume, isHeld: isAway.value },
});

/** Of a run that does not go on by itself; null of others. @param {Run} run */
function ofHalt(run) {
  // Who may start nothing watches what there is of a practice; a race that was not decided answers no vote.
  if (earlyEndOf(run) && (mayStart.value || run.kind === "race")) return ofEarlyEnd(run);
  return run.state === "paused" && mayChange(run) ? ofPause(run) : null;
}

/** While the server is away a card waits; a vote does not need it. @param {Said} said @returns {Said} */
const ofAway = ({ title, press }) => ({
  title, text: t("The server is away. The lesson goes on when it is back."), press: press && { ...press, isHeld: true },
});

/** What a card says: first of all what keeps its promise from the screen, and the press that mends it. */
/** @param {FirstCard} firstCard @returns {Said} */
function saidBy(firstCard) {
  if (isAway.value) return ofAway(firstCard.say());
  const run = { practice, race, none: null }[firstCard.of ?? "none"]?.value ?? null;
  const halt = run && ofHalt(run);
  if (halt) return halt;
  const said = firstCard.say();
  if (run === null || firstCard.holds?.()) return said;
  if (!isInPicture(run)) {
    const label = run.kind === "race" ? t("Show the race") : t("Show the practice");
    return { ...said, press: { label, run: () => show(run), isHeld: isComing(run) } };
  }
  const tabs = ["board", ...(firstCard.shows === LEARNING ? ["train"] : [])];
  const isOnBoard = !isPanelHidden.value && tabs.includes(tab.value);
  return isOnBoard ? said : { ...said, press: { label: t("To the board"), run: () => openTab("board") } };
}

// ---- what turns the cards

/** The card that what is on the page brings now: of those after the open one the first whose event has happened. */
const due = computed(() => {
  if (cardNumber.value === null || page.lesson.value !== null) return null;
  const [open, ...after] = first.value.slice(cardNumber.value - 1);
  if (open.holds?.()) return null;
  // A step whose explanation was closed by other means is done with.
  return (open.holds ? after[0] : after.find(({ comes }) => comes?.())) ?? null;
});

/** Open a card that what happens has brought. @param {FirstCard} next */
function comeTo(next) {
  keep({ at: next.name, ...notedAt(next) });
  // The race that is talked about stays, where it is this page's.
  if (next.name === "finish" && isOperator.peek() && lessonProgress.peek().isMine) setShared({ stay: true });
}

/** Let what happens turn the cards of the first lesson, and note the runs that it is about. */
function followFirstLesson() {
  followRuns(computed(() => [lessonProgress.value.practice, lessonProgress.value.race].flatMap((id) => id ?? [])));
  effect(() => {
    const { practice: practiceId, race: raceId } = lessonProgress.value;
    if (raceId && isGone(raceId)) keep({ race: null, at: "ready" });
    if (practiceId && isGone(practiceId)) restart();
  });
  effect(() => {
    const next = due.value;
    if (next !== null) untracked(() => comeTo(next));
  });
}

/** Show the lesson that the address names, or else the first one from its card on. */
export function followLesson() {
  effect(() => { isPreset.value = page.lesson.value !== null; });
  effect(() => {
    const number = page.card.value;
    if (number !== null && page.lesson.value === null && options.value) {
      untracked(() => openCard(Math.min(number, total.peek())));
    }
  });
  followFirstLesson();
}

// ---- as it is drawn

/** The buttons of a lesson of the address. */
const loadButtons = () => withStyle("style/card.css", import("./linked-lesson.js")).then(({ Buttons }) => Buttons);

/** Where the focus goes when it was in a card that is no more: to the open tab. */
const focusTab = () => {
  const element = document.querySelector("[role=tab][aria-selected=true]") ?? document.getElementById("main");
  /** @type {HTMLElement | null} */ (element)?.focus();
};

/**
 * Keep the focus in the card while it changes: what had it may be gone, as the lanes are once the vote is made.
 * @param {{ current: HTMLElement | null }} bar
 */
function useFocusKept(bar) {
  // As it was before this change is drawn.
  const hadFocus = bar.current?.contains(document.activeElement) ?? false;
  useLayoutEffect(() => {
    if (!hadFocus || bar.current?.contains(document.activeElement)) return;
    const next = bar.current?.querySelector(".to-press button, button.to-press");
    if (next) /** @type {HTMLElement} */ (next).focus();
    else requestAnimationFrame(focusTab);
  });
}

function CardBar() {
  const shown = card.value;
  const bar = useRef(/** @type {HTMLElement | null} */ (null));
  useFocusKept(bar);
  // A new one is not folded, as on a phone the one before may be.
  useEffect(() => {
    isCardFolded.value = false;
  }, [cardNumber.value]);
  if (linkProblem.value) return html`<${NoLesson} />`;
  if (!shown) return null;
  return html`
    <section class="card-bar" aria-label="Lesson" ref=${bar}>
      <span class="card-number">
        <span class="sr-only">Card${" "}</span>${cardNumber}<span class="of">${" "}of${" "}</span>${total}
      </span>
      <p aria-live="polite"><b>${shown.title}</b>${" "}<span>${shown.text}</span></p>
      ${linked.value
        ? html`<${Loaded} name="card of the lesson" load=${loadButtons} />` : html`<${Highlighted} said=${shown} />`}
      ${isAtLeast("try") && html`
        <button class="quiet square small" aria-label="Hide the lesson" title="Hide the lesson" onClick=${closeLesson}>
          ✕
        </button>
      `}
    </section>
  `;
}

/** What is to be pressed next, and nothing else is highlighted: a button, or the lanes to vote for. */
/** @param {{ said: Said }} props */
const Highlighted = ({ said: { press } }) => (press === null
  ? html`<${Vote} />`
  : html`
    <button class="to-press" aria-disabled=${press.isHeld ? "true" : undefined} title="Next in the lesson"
      onClick=${() => press.isHeld || press.run()}>${press.label}</button>
  `);

/** The lanes to vote for, and which one was. */
export const Vote = () => html`
  <span class="prediction to-press" role="group" aria-label="Your vote">
    ${candidates.value.map(({ agent, title, color }) => html`
      <button class="chip" style=${{ "--agent": color }} aria-pressed=${vote.value === agent ? "true" : "false"}
        onClick=${() => voteFor(agent)}><span class="swatch"></span>${title}</button>
    `)}
  </span>
`;

/** The address names a lesson that is not here. */
const NoLesson = () => html`
  <section class="card-bar" aria-label="Lesson">
    <p role="alert">${linkProblem}</p>
    <button class="secondary compact" onClick=${leave}>Without a lesson</button>
  </section>
`;

const FirstLesson = () => html`
  <button type="button" class="secondary" onClick=${() => { helpIsOpen.value = false; openLesson(); }}>
    Show the first lesson
  </button>
`;

/** @type {Partial<Feature>} */
export default {
  menu: [
    { title: t("Lessons"), order: 30, group: "class", href: "#lessons" },
    {
      title: t("Open a room…"), order: 31, group: "class", for: "operator", dialog: "rooms",
      call: "lessons/list.js#askForRoom",
    },
    {
      title: () => (card.value ? t("Hide the lesson") : t("The first lesson")), order: 33, group: "help",
      run: () => (card.peek() ? closeLesson : openLesson)(),
    },
  ],
  slots: { card: { component: CardBar }, "buttons of the help": { component: FirstLesson } },
  follow: followLesson,
  // Of who watches and is to vote nothing else is asked.
  hidesTab: (name) => !isShown(name) || (isVoting.value && !isAtLeast("try")),
  deck: { cards, number: cardNumber, open: openCard, Question: Vote },
};
