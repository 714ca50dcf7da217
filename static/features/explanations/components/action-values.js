// The action values of the learner in view in its present state: one for each group of legs and each place.
import { bestMove, cellName } from "../../../js/training.js";
import { count, inMillimetres, tenths, whole } from "../../../js/format.js";
import { valueColours } from "../../../js/scale.js";
import { shownRun } from "../../../js/on-stage.js";
import { options, scene } from "../../../js/store.js";
import { isAtLeast } from "../../../js/workspace.js";
import { HexapodGlyph, html } from "../../../js/components/elements.js";

/** @import { ActionValues as Known } from "../../../js/types.js" */

const ABOUT = "Millimetres forward that it expects from moving a group of legs to a place, and from what follows";

/** Of the lane whose foot grid is in the picture. @param {{ lane: number }} props */
export function ActionValues({ lane }) {
  const values = valuesOf(lane);
  return values && html`
    <section class="panel action-values" aria-labelledby="action-values-title">
      <h3 id="action-values-title" title=${ABOUT}>Values in this state [mm]</h3>
      <${Values} known=${values} />
      ${values.visits && isAtLeast("study") && html`<${ValuesKey} />`}
    </section>
  `;
}

/** The values in the picture, if they are of a lane. @param {number} lane */
export function valuesOf(lane) {
  const values = scene.value?.action_values;
  return values?.lane === lane ? values : null;
}

/** @param {{ known: Known }} props */
function Values({ known }) {
  const { pairs, cell_names } = known;
  const gait = options.value?.gaits.find(({ name }) => name === shownRun.value?.config?.gait);
  return html`
    <div class="scroller" tabindex="0" role="region" aria-label="Value of each move">
      <table class="values">
        <thead>
          <tr><td></td>${cell_names.map((_, cell) => html`<th scope="col">${cellName(known, cell)}</th>`)}</tr>
        </thead>
        <tbody>
          ${pairs.map((legs, pair) => html`
            <tr>
              <th scope="row">
                ${gait && html`<${HexapodGlyph} gait=${gait} only=${pair} />`}
                <span>Legs ${legs.join(" + ")}</span>
              </th>
              ${cell_names.map((_, cell) => html`<${Value} known=${known} pair=${pair} cell=${cell} />`)}
            </tr>
          `)}
        </tbody>
      </table>
    </div>
  `;
}

/** @param {{ known: Known, pair: number, cell: number }} props */
function Value({ known, pair, cell }) {
  const value = known.values_m[pair][cell];
  if (known.current[pair] === cell) return html`<td class="here">here</td>`;
  if (value === null || value === undefined) return html`<td></td>`;
  const best = bestMove(known);
  const isBest = best.pair === pair && best.cell === cell;
  const isNext = known.next?.pair === pair && known.next?.cell === cell;
  const visits = known.visits?.[pair]?.[cell] ?? null;
  const mark = isNext ? "next" : isBest ? "best" : "";
  const nextMove = isNext && html`<span class="sr-only">, its next move</span>`;
  // A move without a try has the table's first value, which is no estimate.
  if (visits === 0) return html`<td class=${`untried ${mark}`}>never${nextMove}</td>`;
  return html`
    <td class=${mark} style=${valueColours(value, known.low, known.high)}>
      ${tenths(value)}${visits !== null && html`
        <small aria-hidden="true">${whole(visits)}×</small><span class="sr-only">, tried ${count(visits, "time")}</span>
      `}${nextMove}
    </td>
  `;
}

const EXAMPLE_M = 0.012;

const ValuesKey = () => html`
  <p class="values-key dim">
    <span><i class="untried" aria-hidden="true"></i>never tried</span>
    <span><b>${tenths(EXAMPLE_M)}</b> <small>5×</small> worth ${inMillimetres(EXAMPLE_M)}, tried 5 times</span>
  </p>
`;
