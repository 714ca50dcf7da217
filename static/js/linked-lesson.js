// The lesson that the address names, in place of the first one. It presets the page and hides what its cards do not
// show; that is courtesy, since only a room locks anything.
import { computed, effect, signal } from "@preact/signals";
import { page } from "./page-state.js";

/** @import { Signal } from "@preact/signals" */
/** @import { LessonCard, LessonView } from "./types.js" */

/** Null without one, and until the server has answered. @type {Signal<LessonView | null>} */
export const linked = signal(null);
/** Why the lesson of the address cannot be shown. */
export const linkProblem = signal("");

/** Its open card; null without one. @type {import("@preact/signals").ReadonlySignal<LessonCard | null>} */
export const linkedCard = computed(() => linked.value?.cards[(page.card.value ?? 1) - 1] ?? null);

/** Whether a tab of the panel is shown by the open card. @param {string} tab */
export const isShown = (tab) => linkedCard.value?.show?.some((one) => one === tab) ?? true;

/**
 * The fields of a card's form as an address has them: lists with commas, of disturbances each by itself.
 * @param {Record<string, any>} form
 */
export function asTexts({ settings = {}, ...form }) {
  const pairs = Object.entries({ ...form, ...settings }).flatMap(([name, value]) => {
    if (name === "disturb" && Array.isArray(value)) return value.map((one) => [name, String(one)]);
    if (Array.isArray(value)) return [[name, value.join(",")]];
    return [[name, value !== null && typeof value === "object" ? JSON.stringify(value) : String(value)]];
  });
  return new URLSearchParams(pairs);
}

/** Load the lesson that the address names, and tell once it is there. @param {() => unknown} onLoaded */
export const followLinkedLesson = (onLoaded) => effect(() => {
  const id = page.lesson.value;
  linkProblem.value = "";
  if (id === linked.peek()?.id) return;
  linked.value = null;
  if (id === null) return;
  // Most visits have none.
  import("./classroom-api.js").then(({ getLesson }) => getLesson(id)).then((lesson) => {
    if (page.lesson.peek() !== id) return;
    linked.value = lesson;
    onLoaded();
  }, ({ message }) => (linkProblem.value = message));
});
