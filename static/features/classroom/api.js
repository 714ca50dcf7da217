// Lessons and rooms over the REST API.
import { addressOf, call, roomAddressOf, start } from "../../js/api.js";
import { translation } from "../../js/format.js";

/** @import { Deleted } from "../../js/api.js" */
/** @import { Classroom, Clock, Joined, LessonDocument, LessonList, LessonView } from "../../js/types.js" */
/** @import { NewLesson, NewRoom } from "../../js/types.js" */
/** @import { QTable, Results, Run, TeachingState, WhatIfAnswer } from "../../js/types.js" */

const YAML = "application/yaml";
/** The language in which built-in lessons are read. @type {Record<string, string>} */
const language = translation ? { language: document.documentElement.lang } : {};
const inItsLanguage = translation ? `?${new URLSearchParams(language)}` : "";

// ---- lessons

/** @returns {Promise<LessonList>} */
export const listLessons = () => call("GET", `lessons${inItsLanguage}`);
/** @type {(id: string) => Promise<LessonView>} */
export const getLesson = (id) => call("GET", `lessons/${encodeURIComponent(id)}${inItsLanguage}`);
/** @type {(lesson: LessonDocument) => Promise<NewLesson>} */
export const addLesson = (lesson) => call("POST", "lessons", lesson);
/** Store the lesson of a file, in YAML or JSON. @type {(file: File) => Promise<NewLesson>} */
export const addLessonFile = (file) => {
  const type = /\.json$/i.test(file.name) ? "application/json" : YAML;
  return call("POST", "lessons", new Blob([file], { type }), { "Content-Type": type });
};
/** @type {(id: string) => Promise<Deleted>} */
export const deleteLesson = (id) => call("DELETE", `lessons/${encodeURIComponent(id)}`);
/** Where the file of a lesson is. @param {string} id */
export const lessonFile = (id) => addressOf(
  `lessons/${encodeURIComponent(id)}?${new URLSearchParams({ format: "yaml", ...language })}`);

// ---- rooms

/** @type {(body: { lesson: string | null, needs_approval: boolean }) => Promise<NewRoom>} */
export const openRoom = (body) => start("rooms", { ...body, ...language });

/** @param {string} code */
const pathOf = (code) => `rooms/${encodeURIComponent(code)}`;

/** @type {(code: string) => Promise<Classroom>} */
export const getRoom = (code) => call("GET", pathOf(code));
/** Where the events of a room are. @param {string} code */
export const eventsOf = (code) => addressOf(`${pathOf(code)}/events`);
/** Join; with the same key it is the same participant. @type {(code: string, key: string) => Promise<Joined>} */
export const joinRoom = (code, key) => start(`${pathOf(code)}/participants`, {}, key);
/** @type {(code: string) => Promise<null>} */
export const leaveRoom = (code) => call("DELETE", `${pathOf(code)}/me`);
/** @type {(code: string, card: number, value: unknown) => Promise<unknown>} */
export const predict = (code, card, value) => call("POST", `${pathOf(code)}/predictions`, { card, value });
/** Run what the card runs, once with the same key; a what-if is answered at once. */
/** @typedef {Record<string, unknown>} CardSettings */
/** @type {(code: string, card: number, settings: CardSettings, key: string) => Promise<Run | WhatIfAnswer>} */
export const startRun = (code, card, settings, key) => start(`${pathOf(code)}/runs`, { card, settings }, key);
/** The robots and the presses of a card that teaches. @type {(code: string) => Promise<TeachingState>} */
export const getTeaching = (code) => call("GET", `${pathOf(code)}/teaching`);
/** @type {(code: string) => Promise<TeachingState>} */
export const startTeaching = (code) => call("POST", `${pathOf(code)}/teaching`);
/** @type {(code: string) => Promise<TeachingState>} */
export const stopTeaching = (code) => call("DELETE", `${pathOf(code)}/teaching`);
/** Press + (1) or − (−1) at a moment of the picture [s]. */
/** @type {(code: string, body: { run_id: string, at_s: number, value: 1 | -1 }) => Promise<{ step: number }>} */
export const press = (code, body) => call("POST", `${pathOf(code)}/presses`, body);
/** The values that a training has learned. @type {(run_id: string) => Promise<QTable>} */
export const getTable = (run_id) => call("GET", `trainings/${run_id}/q-table?format=json`);
/** Time the race on a room's stage by a clock. @type {(code: string, clock: Clock) => Promise<unknown>} */
export const setStageClock = (code, clock) => call("PUT", roomAddressOf(code, "stage"), { clock });
/** Tell that an own run was watched to its end. @type {(code: string, id: string) => Promise<null>} */
export const noteWatched = (code, id) => call("PUT", `${pathOf(code)}/runs/${encodeURIComponent(id)}/watched`);
/** Results of a card; on a projector as the class may see them. */
/** @type {(code: string, card: number, isProjector: boolean) => Promise<Results>} */
export const getResults = (code, card, isProjector) =>
  call("GET", `${pathOf(code)}/results?card=${card}${isProjector ? "&projector=true" : ""}`);
/** Where the file of the results is. @param {string} code */
export const resultsFile = (code) => addressOf(`${pathOf(code)}/results?format=csv`);

/** @type {(code: string, card: number) => Promise<Classroom>} */
export const showCard = (code, card) => call("PUT", `${pathOf(code)}/card`, { card });
/** @type {(code: string, frozen: boolean) => Promise<Classroom>} */
export const freezeRoom = (code, frozen) => call("POST", `${pathOf(code)}/freeze`, { frozen });
/** @type {(code: string, card: number) => Promise<Classroom>} */
export const revealCard = (code, card) => call("POST", `${pathOf(code)}/reveal`, { card });
/** Delete a room that has ended. @type {(code: string, withRuns: boolean) => Promise<unknown>} */
export const deleteRoom = (code, withRuns) => call("DELETE", `${pathOf(code)}?runs=${withRuns}`);
/** @type {(code: string) => Promise<Classroom>} */
export const endRoom = (code) => call("POST", `${pathOf(code)}/end`);
/** @type {(code: string, run_id: string | null) => Promise<Classroom>} */
export const spotlightRun = (code, run_id) => call("PUT", `${pathOf(code)}/spotlight`, { run_id });
/** What others see of a participant. @typedef {{ is_name_hidden?: boolean, is_approved?: boolean }} PersonChanges */
/** @type {(code: string, seed: number, changes: PersonChanges) => Promise<Classroom>} */
export const changeParticipant = (code, seed, changes) =>
  call("PATCH", `${pathOf(code)}/participants/${seed}`, changes);
/** Take seat, name and answers of a participant, and stop the run that goes on. */
/** @type {(code: string, seed: number) => Promise<Classroom>} */
export const removeParticipant = (code, seed) => call("DELETE", `${pathOf(code)}/participants/${seed}`);
