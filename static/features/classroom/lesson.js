// What the page has of lessons: how far this browser is in the first one, and the lesson that the address names in its
// place. The latter presets the page and hides what its cards do not show; that is courtesy, since only a room locks
// anything.
import { computed, signal } from "@preact/signals";
import { asTexts, page } from "../../js/page-state.js";
import { shownRun } from "../../js/on-stage.js";
import { storedText } from "../../js/page.js";
import { isOwn } from "../../js/player.js";
import { isActive, runOf } from "../../js/selectors.js";
import { scene, stage } from "../../js/store.js";

/** @import { ReadonlySignal, Signal } from "@preact/signals" */
/** @import { PageState } from "../../js/page-state.js" */
/** @import { LessonCard, LessonView, Run } from "../../js/types.js" */

// ---- the first lesson, as far as this browser is

/**
 * `at`: name of the open card, or "done". `isHidden`: whether it is hidden meanwhile. `practice`, `race`: ids of the
 * runs that it is about. `isMine`: whether this browser has started that practice. `vote`: the agent voted for.
 * `outcome`: what was said of the race when it was decided.
 * @typedef {{
 *   at: string, isHidden: boolean, practice: string | null, race: string | null, isMine: boolean, vote: string | null,
 *   outcome: { headline: string, work: string } | null,
 * }} Progress
 */

/** @type {Progress} */
const BEGINNING = {
  at: "start", isHidden: false, practice: null, race: null, isMine: false, vote: null, outcome: null,
};
const stored = storedText("first-lesson", "{}");

/** How far this browser is in the first lesson; a damaged text of its storage is its beginning. */
export const lessonProgress = computed(() => {
  try {
    return /** @type {Progress} */ ({ ...BEGINNING, ...JSON.parse(stored.value) });
  } catch {
    return BEGINNING;
  }
});

/** @param {Partial<Progress>} changes */
export const keep = (changes) => { stored.value = JSON.stringify({ ...lessonProgress.peek(), ...changes }); };

/** Begin again. */
export const restart = () => { stored.value = "{}"; };

/** Kinds of its runs. */
export const KINDS = { practice: "training", race: "race" };

/** The run that the lesson is about, once it is known. @param {"practice" | "race"} of */
const runOfLesson = (of) => computed(() => {
  const run = runOf(lessonProgress.value[of]);
  return run?.kind === KINDS[of] ? run : null;
});
export const practice = runOfLesson("practice");
export const race = runOfLesson("race");

/** Whether the picture is of a run. @param {Run | null} run */
export const isInPicture = (run) => run !== null && shownRun.value?.id === run.id && scene.value?.run_id === run.id;

/** Whether the stage that this page follows is about to show a run. @param {Run} run */
export const isComing = (run) => !isOwn.value && isActive(run) && stage.value?.run_id === run.id;

// ---- the lesson that the address names

/** Null without one, and until the server has answered. @type {Signal<LessonView | null>} */
export const linked = signal(null);
/** Why the lesson of the address cannot be shown. */
export const linkProblem = signal("");

/** Its open card; null without one. @type {ReadonlySignal<LessonCard | null>} */
export const linkedCard = computed(() => linked.value?.cards[(page.card.value ?? 1) - 1] ?? null);

/** Whether a tab of the panel is shown by the open card. @param {string} tab */
export const isShown = (tab) => linkedCard.value?.show?.some((name) => name === tab) ?? true;

/** What a card opens of the page. @param {LessonCard} card @returns {Partial<PageState>} */
export function stateOf({ state }) {
  const { form, ...pageState } = state ?? {};
  const set = Object.entries(pageState).filter(([, value]) => value !== null);
  return { ...Object.fromEntries(set), ...(form && { form: asTexts(form) }) };
}
