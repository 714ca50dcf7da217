// The presentation on the stage that all share: which card is shown, and how; told by the presenter's own keys, or by a
// remote on another device. Every presenter's window of this stage follows it.
import { computed, effect } from "@preact/signals";
import { setShared } from "../../js/actions.js";
import { deck } from "../../js/features.js";
import { change, page } from "../../js/page-state.js";
import { isTimedOut } from "../../js/race.js";
import { isOperator } from "../../js/selectors.js";
import { stage } from "../../js/store.js";
import { explainingTab } from "../../js/workspace.js";

/** @import { PageState } from "../../js/page-state.js" */
/** @import { Presentation } from "../../js/types.js" */

/** @type {Presentation} */
const NOTHING = { card: null, shows_why: false, is_blank: false, code: "large" };
/** Sizes of the QR code, in the order of its key. @type {Presentation["code"][]} */
export const CODES = ["large", "small", "none"];

export const presentation = computed(() => stage.value?.presentation ?? NOTHING);

/** Change the presentation for every presenter's window. @param {Partial<Presentation>} changes */
export const tell = (changes) => {
  if (isOperator.peek()) setShared({ presentation: { ...presentation.peek(), ...changes } });
};

/** Go to the next card, or to the one before. @param {1 | -1} direction */
export function turnPage(direction) {
  const next = (presentation.peek().card ?? 0) + direction;
  if (next >= 1 && next <= deck.peek().cards.peek().length) tell({ card: next, shows_why: false });
}

export const nextCard = () => turnPage(1);
export const previousCard = () => turnPage(-1);
export const turnCode = () =>
  tell({ code: CODES[(CODES.indexOf(presentation.peek().code) + 1) % CODES.length] });
export const toggleWhy = () => tell({ shows_why: !presentation.peek().shows_why });
export const toggleBlank = () => tell({ is_blank: !presentation.peek().is_blank });

/** Let this page, while it is presented, show what the presentation says; then it is as it was before. */
export function followPresentation() {
  /** @type {Partial<PageState> | null} */
  let before = null;
  effect(() => {
    if (page.isPresenting.value) before = { depth: page.depth.peek(), tab: page.tab.peek() };
    else if (before !== null) {
      change(before);
      before = null;
    }
  });
  effect(() => {
    const { card, shows_why } = presentation.value;
    if (!page.isPresenting.value) return;
    const { number, open } = deck.peek();
    if (card !== null && card !== number.peek()) open(card);
    change({ tab: shows_why ? explainingTab.value : "board", depth: "watch" });
  });
  // Who wants to watch has the address by the end of the first race: the robots get its room.
  let hasShrunk = false;
  effect(() => {
    if (hasShrunk || !page.isPresenting.value || !isTimedOut.value) return;
    hasShrunk = true;
    if (presentation.peek().code === "large") tell({ code: "small" });
  });
}
