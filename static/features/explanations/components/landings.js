// The table of a learner that values landings: a row a landing, the best first.
import { inMillimetres, whole } from "../../../js/format.js";
import { landingOf, MAX_LANDINGS, pairsOfLanding, rankedLandings } from "../landings.js";
import { valueColours } from "../../../js/scale.js";
import { colourScale, legsInWords, valueRange } from "../steps.js";
import { html } from "../../../js/components/elements.js";

/** @import { Explanation, StateTable } from "../../../js/types.js" */
/** @import { Landing } from "../landings.js" */

/**
 * @param {object} props
 * @param {StateTable} props.shown of a learner with landings
 * @param {Explanation | null} props.seen the step that is looked at
 */
export function Landings({ shown, seen }) {
  const landings = rankedLandings(shown);
  const came = shown.landings?.visits.filter((visits) => visits > 0).length ?? 0;
  const landed = seen ? landingOf(seen, shown) : null;
  const range = colourScale(valueRange(shown));
  return html`
    <div class="landings">
      <p>
        One value for each landing: where the feet stand when a step ends.
        <b> ${whole(came)} of ${whole(shown.states)} came so far.</b>
        <span class="dim"> A table of states and moves would store each ${pairsOfLanding(shown)} times.</span>
      </p>
      <div class="heat-scroll" tabindex="0" role="region" aria-label="Table of landings, the best first">
        <table class="landing-table">
          <thead>
            <tr>
              ${shown.pairs.map((legs) => html`<th scope="col">${legsInWords(legs)}</th>`)}
              <th scope="col" class="number">Value</th>
              <th scope="col" class="number">Times</th>
            </tr>
          </thead>
          <tbody>
            ${landings.map((landing) => html`
              <${Row} key=${landing.index} landing=${landing} range=${range} names=${shown.cell_names}
                isLanded=${landing.index === landed} />
            `)}
          </tbody>
        </table>
      </div>
      ${shown.states > MAX_LANDINGS && html`
        <p class="dim">The best ${whole(MAX_LANDINGS)} of ${whole(shown.states)} landings; the file has all.</p>
      `}
    </div>
  `;
}

/**
 * @param {object} props
 * @param {Landing} props.landing
 * @param {{ low: number, high: number }} props.range
 * @param {string[]} props.names of the cells
 * @param {boolean} props.isLanded whether the step that is looked at ended there
 */
const Row = ({ landing: { cells, value, visits }, range, names, isLanded }) => html`
  <tr class=${isLanded ? "is-landed" : ""} aria-current=${isLanded ? "step" : undefined}>
    ${cells.map((cell) => html`<td>${names[cell]}</td>`)}
    ${visits > 0
      ? html`<td class="number"><span class="landing-value" style=${valueColours(value, range.low, range.high)}>
          ${inMillimetres(value)}</span></td>`
      : html`<td class="number dim">–</td>`}
    <td class="number ${visits > 0 ? "" : "dim"}">${visits > 0 ? whole(visits) : "never"}</td>
  </tr>
`;
