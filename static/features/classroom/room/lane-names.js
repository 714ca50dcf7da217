// What the robots in the picture are called where their agents' names tell nothing: pupils, and who taught.
import { computed, signal } from "@preact/signals";
import { t } from "../../../js/format.js";
import { scene } from "../../../js/store.js";
import { results as resultsByCard, room } from "./room.js";
import { teaching } from "./teaching.js";

/** @import { CardResults } from "../../../js/types.js" */

/** A robot of the class whose pupil is not known. */
export const UNKNOWN = t("One of you");

/** The places of a class race with the names of who has them, by lane. @param {CardResults | null} results */
export function racersOf(results) {
  const { seeds = [] } = results?.race ?? {};
  const places = seeds.length === 1 ? [t("The only one")] : seeds.length === 2 ? [t("Best"), t("Last")]
    : [t("Best"), t("Median"), t("Last")];
  return seeds.map((seed, n) => ({
    place: places[n], name: results?.entries.find((entry) => entry.seed === seed)?.name ?? UNKNOWN,
  }));
}

/** Who teaches a robot, in words. @type {Record<string, string>} */
const TEACHERS = { reward: t("the reward"), simulated: t("a simulated person") };

/** Who teaches the robot beside that of the class. @param {{ rival?: string } | null | undefined} teach */
export const rivalTeacher = (teach) => TEACHERS[teach?.rival ?? "reward"];

/** The name of the only robot in the frame beside that of the class; empty elsewhere. */
export const nameBeside = signal("");

/** The names by lane, as a text with a line for each; empty where the agents' names stay. */
export const laneNames = computed(() => {
  if (nameBeside.value) return nameBeside.value;
  const run_id = scene.value?.run_id ?? null;
  if (run_id === null) return "";
  // The race of the card before stays on the stage until something else is shown.
  const raced = Object.values(resultsByCard.value).find(({ race }) => race?.run_id === run_id);
  if (raced) return racersOf(raced).map(({ name }) => name).join("\n");
  const now = teaching.value;
  if (run_id === now?.race_id) {
    const by = rivalTeacher(room.value?.shown.teach);
    return `${t("Taught by you")}\n${t("Taught by {teacher}", { teacher: by })}`;
  }
  return run_id === now?.taught?.run_id ? t("Taught by you") : "";
});
