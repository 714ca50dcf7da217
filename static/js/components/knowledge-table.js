// The learner's action values in its present state: one for each pair of legs and each place on the foot grid.
import { agentOf } from "../agents.js";
import { html } from "../html.js";
import { count, millimetres } from "../format.js";
import { shownRun } from "../selectors.js";
import { valueColours } from "../colormap.js";
import { options, scene } from "../store.js";
import { bestMove, placeName } from "../knowledge.js";
import { Empty } from "./empty.js";
import { HexapodGlyph } from "./hexapod-glyph.js";

const ABOUT = "Millimetres forward that it expects from moving a pair of legs to a place, and from what follows";
const INVITATION =
  "When a learner is on stage, its table is shown here: one value for each pair of legs and each place.";

export function Knowledge() {
  const known = scene.value?.knowledge;
  return html`
    <section class="panel knowledge" aria-labelledby="knowledge-title">
      <h2 id="knowledge-title">What the learner knows here</h2>
      <p class="dim">${ABOUT}</p>
      ${known
        ? html`<${Values} known=${known} /><p class="next-move"><${NextMove} known=${known} /></p>`
        : html`<${Empty} shape="cells" words=${INVITATION} />`}
    </section>
  `;
}

function Values({ known }) {
  const { pairs, cell_names } = known;
  const gait = options.value?.gaits.find(({ name }) => name === shownRun.value?.config?.gait);
  return html`
    <div class="scroller" tabindex="0" role="region" aria-label="Value of each move">
      <table class="values">
        <thead>
          <tr><td></td>${cell_names.map((_, cell) => html`<th scope="col">${placeName(known, cell)}</th>`)}</tr>
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

function Value({ known, pair, cell }) {
  const value = known.values_m[pair][cell];
  if (known.current[pair] === cell) return html`<td class="here">here</td>`;
  if (value === null || value === undefined) return html`<td></td>`;
  const best = bestMove(known);
  const isBest = best.pair === pair && best.cell === cell;
  const isNext = known.next?.pair === pair && known.next?.cell === cell;
  const visits = known.visits?.[pair]?.[cell] ?? null;
  return html`
    <td class=${isNext ? "next" : isBest ? "best" : ""} style=${valueColours(value, known.low, known.high)}
      title=${visits === null ? undefined : `tried ${count(visits, "time")}`}>
      ${millimetres(value)}${isNext && html`<span class="sr-only">, its next move</span>`}
    </td>
  `;
}

/** The learner's next move in words. */
function NextMove({ known }) {
  const { pairs, values_m, visits, lane, agent } = known;
  const best = bestMove(known);
  const { pair, cell } = known.next ?? best;
  if (pair < 0) return null;
  const value = values_m[pair][cell] ?? 0;
  const tried = visits?.[pair]?.[cell] ?? 0;
  const name = scene.value?.lanes?.[lane]?.name ?? agentOf(agent).title;
  const move = `${name} will move legs ${pairs[pair].join(" and ")} to ${placeName(known, cell, " mm")}`;
  const times = tried === 1 ? "once" : count(tried, "time");
  return html`
    <b>${move}${value < best.value ? " to explore" : ""}.</b> ${tried
      ? `It has tried that ${times} from here, and expects ${millimetres(value)} mm from it and what follows.`
      : "It has never tried that from here."}
  `;
}
