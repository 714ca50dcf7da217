// Files that the page hands to the browser's downloads.
import { getFilm, getReplay } from "./api.js";

/** @import { Run } from "./types.js" */

const KEPT_MS = 60_000;
/** A film that the server renders at once has at most 900 pictures, 30 a second. */
const FILM_S = 29;

/** @type {(content: Blob, name: string) => void} */
export function saveFile(content, name) {
  const link = document.createElement("a");
  link.href = URL.createObjectURL(content);
  link.download = name;
  link.click();
  setTimeout(() => URL.revokeObjectURL(link.href), KEPT_MS);
}

/** The playback speed at which all that is recorded fits into a film. @param {[number, number][]} recorded_s [s] */
export function filmSpeed(recorded_s) {
  const length_s = recorded_s.reduce((sum, [begin, end]) => sum + end - begin, 0);
  return Math.max(1, Math.ceil((10 * length_s) / FILM_S) / 10);
}

/** Have a film of a run rendered, and save it. @param {Run} run */
export async function saveFilm(run) {
  const { recorded_s } = await getReplay(run.id, "paper", null);
  saveFile(await getFilm(run.id, filmSpeed(recorded_s)), `${run.kind}-${run.id}.mp4`);
}
