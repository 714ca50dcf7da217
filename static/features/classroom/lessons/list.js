// The lessons and rooms of the server, and what is done with them.
import { signal } from "@preact/signals";
import * as api from "../api.js";
import { call } from "../../../js/api.js";
import { tellDeleted } from "../../../js/deletions.js";
import { count } from "../../../js/format.js";
import { begin, discard, documentOf, draft, toSend } from "./draft.js";

/** @import { Signal } from "@preact/signals" */
/** @import { Take } from "../../../js/deletions.js" */
/** @import { RequestError } from "../../../js/api.js" */
/** @import { ListedLesson, ListedRoom, NewLesson, NewRoom } from "../../../js/types.js" */

/** Null until the server has answered. @type {Signal<ListedLesson[] | null>} */
export const lessons = signal(null);
/** The rooms, those that have ended too, oldest first. @type {Signal<ListedRoom[]>} */
export const rooms = signal([]);
/** Whether phones can come to the server; true until it has answered. */
export const isReachable = signal(true);
/** Why the last request failed; empty while none has. */
export const problem = signal("");
/** Whether a request is under way. */
export const isBusy = signal(false);
/** The lesson that was stored last. @type {Signal<NewLesson | null>} */
export const saved = signal(null);
/** The room that was opened last. @type {Signal<NewRoom | null>} */
export const opened = signal(null);

/** Whether the dialog that opens a room is open, and the id of its lesson. */
export const roomIsOpen = signal(false);
/** @type {Signal<string | null>} */
export const chosenLesson = signal(null);

/** @param {() => Promise<unknown>} send */
async function perform(send) {
  if (isBusy.peek()) return;
  isBusy.value = true;
  problem.value = "";
  try {
    await send();
  } catch (error) {
    problem.value = /** @type {RequestError} */ (error).message;
  } finally {
    isBusy.value = false;
  }
}

/** Ask for the lessons and the rooms. */
export const refresh = async () => {
  try {
    lessons.value = (await api.listLessons()).items;
    const all = await call("GET", "rooms");
    rooms.value = all.items;
    isReachable.value = all.is_reachable;
  } catch (error) {
    problem.value = /** @type {RequestError} */ (error).message;
  }
};

/** Edit a copy of a lesson. @param {string} id */
export const edit = (id) => perform(async () => {
  begin(documentOf(await api.getLesson(id)));
  saved.value = null;
});

/** Store the draft. */
export const save = () => perform(async () => {
  const lesson = draft.peek();
  if (lesson === null) return;
  saved.value = await api.addLesson(toSend(lesson));
  await refresh();
});

/** Store the lesson of a file, and open it in the editor. @param {File} file */
export const importFile = (file) => perform(async () => {
  const added = await api.addLessonFile(file);
  begin(documentOf(await api.getLesson(added.id)));
  saved.value = added;
  await refresh();
});

/** Take in a lesson that is restored. @type {Take} */
export const takeRestored = async (send) => {
  await send();
  await refresh();
};

/** @type {(id: string, title: string) => Promise<void>} */
export const remove = (id, title) => perform(async () => {
  tellDeleted("lessons", await api.deleteLesson(id), `“${title}”`, takeRestored);
  if (saved.peek()?.id === id) saved.value = null;
  await refresh();
});

/** Leave the editor. */
export function leave() {
  discard();
  saved.value = null;
  problem.value = "";
}

/** Choose the lesson of a new room. @param {string | null} [id] */
export function askForRoom(id = null) {
  chosenLesson.value = id;
  opened.value = null;
  problem.value = "";
  roomIsOpen.value = true;
  refresh();
}

/** Open a room with the chosen lesson. @param {boolean} needs_approval */
export const openRoom = (needs_approval) => perform(async () => {
  opened.value = await api.openRoom({ lesson: chosenLesson.peek(), needs_approval });
  await refresh();
});

/** How long a lesson is, and for whom. @param {ListedLesson} lesson */
export const lessonInWords = ({ cards, minutes, ages, has_knowledge_question }) => [
  count(cards, "card"), minutes && `${minutes}\u00a0min`, ages, has_knowledge_question && "a question before and after",
].filter(Boolean).join(" · ");
