// A run on the room's stage: one robot that the teacher shows, or the robots of the class that race together.
import { html } from "../../../../js/components/elements.js";
import { metres } from "../../../../js/format.js";

/** @import { Act, Facts } from "./index.js" */

/** Whose robot it is, and how far it came once its picture is there. @param {Facts} facts */
function Caption({ classroom, results, isOnItsWay }) {
  const entry = results?.entries.find(({ run }) => run?.id === classroom.spotlight);
  const distance_m = isOnItsWay ? null : entry?.run?.distance_m ?? null;
  return html`
    <p class="run-caption">
      <b>${entry?.name ?? "One of you"}</b>
      ${distance_m !== null && html`<span class="num">${metres(distance_m)}</span>`}
    </p>
  `;
}

/** @type {Act} */
export const RUN = { name: "run", isOn: ({ classroom }) => classroom.spotlight !== null, Show: Caption };
