// A run on the room's stage: one robot that the teacher shows, or the robots of the class that race together.
import { html } from "../../../../js/components/elements.js";
import { count, metres } from "../../../../js/format.js";
import { racersOf, UNKNOWN } from "../lane-names.js";

/** @import { CardResults } from "../../../../js/types.js" */
/** @import { Act, Facts } from "./index.js" */

/** @param {Facts} facts */
const Caption = (facts) => (isClassRace(facts) ? html`<${Racers} ...${facts} />` : html`<${Walker} ...${facts} />`);

/** @param {Facts} facts */
const isClassRace = ({ classroom, results }) => results?.race?.run_id === classroom.spotlight;

/** Whose robot it is, and how far it came once its picture is there. @param {Facts} facts */
function Walker({ classroom, results, isOnItsWay, clock }) {
  const entry = results?.entries.find(({ run }) => run?.id === classroom.spotlight);
  const distance_m = isOnItsWay ? null : entry?.run?.distance_m ?? null;
  return html`
    <p class="run-caption">
      <b>${entry ? entry.name ?? UNKNOWN : "\u00a0"}</b>${clock && html`<span class="dim">${clock}</span>`}
      ${distance_m !== null && html`<span class="num">${metres(distance_m)}</span>`}
    </p>
  `;
}

/** Among whom they are the best, the median and the last: those on one walk. @param {CardResults | null} results */
export function racedAmong(results) {
  const of = results?.race?.of ?? 0;
  const finished = results?.finished ?? 0;
  return finished > of ? `of the ${of} of ${finished} robots that walk alike` : `of ${count(of, "robot")}`;
}

/** Who races: the best, the median and the last of the class, each in the colour of its lane. @param {Facts} facts */
const Racers = ({ results, colors, clock }) => html`
  <ul class="racers">
    ${racersOf(results).map(({ place, name }, n) => html`
      <li key=${place}><i style=${{ background: colors[n] ?? "transparent" }}></i>${place}: <b>${name}</b></li>
    `)}
    <li class="dim">${[racedAmong(results), clock].filter(Boolean).join(" · ")}</li>
  </ul>
`;

/** What is revealed of the card follows the class's race; a robot that the teacher shows stays. @type {Act} */
export const RUN = {
  name: "run",
  isOn: (facts) => facts.classroom.spotlight !== null && (facts.isOnItsWay || !isClassRace(facts)),
  Show: Caption,
};
