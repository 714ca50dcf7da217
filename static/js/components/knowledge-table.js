// What the learner expects, in the state it is in, of moving each pair of legs to each place.
import { html } from "../html.js";
import { count, millimetres } from "../format.js";
import { agentOf, shownRun } from "../selectors.js";
import { valueColours } from "../colormap.js";
import { options, scene } from "../store.js";
import { Empty } from "./empty.js";
import { HexapodGlyph } from "./hexapod-glyph.js";

export function Knowledge() {
  const known = scene.value?.knowledge;
  return html`
    <section class="panel knowledge" aria-labelledby="knowledge-title">
      <h2 id="knowledge-title">What the learner knows here</h2>
      <p class="dim">Millimetres forward that it expects, with all that follows, from moving a pair of legs to a place</p>
      ${known
        ? html`<${Values} known=${known} /><p class="say">${plan(known)}</p>`
        : html`<${Empty} shape="cells" words="When a learner is on stage, its table stands here: one value for each pair of legs and each place they could go." />`}
    </section>
  `;
}

function Values({ known }) {
  const { pairs, cell_names } = known;
  const gait = options.value?.gaits?.find(({ name }) => name === shownRun.value?.config?.gait);
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
  const { pair: bestPair, cell: bestCell } = best(known);
  const isBest = bestPair === pair && bestCell === cell;
  const isNext = known.next?.pair === pair && known.next?.cell === cell;
  const visits = known.visits?.[pair]?.[cell];
  return html`
    <td class=${isNext ? "next" : isBest ? "best" : ""} style=${valueColours(value, known.low, known.high)}
      title=${visits === undefined || visits === null ? undefined : `tried ${count(visits, "time")}`}>
      ${millimetres(value)}${isNext && html`<span class="sr-only">, its next move</span>`}
    </td>
  `;
}

/** "front left", or on finer grids "20 left, 10 front". */
function placeName({ cell_names, cells_m }, cell, unit = "") {
  if (cell === 0 || cell_names.length <= 5) return cell_names[cell];
  const [x, y] = cells_m[cell].map((metres) => Math.round(1000 * metres));
  const parts = [x && `${Math.abs(x)}${unit} ${x < 0 ? "left" : "right"}`, y && `${Math.abs(y)}${unit} ${y > 0 ? "front" : "back"}`];
  return parts.filter(Boolean).join(", ");
}

function best({ values_m }) {
  let found = { pair: -1, cell: -1, value: -Infinity };
  values_m.forEach((row, pair) =>
    row.forEach((value, cell) => {
      if (value !== null && value > found.value) found = { pair, cell, value };
    }),
  );
  return found;
}

/** Its next move, in words. */
function plan(known) {
  const { pairs, values_m, visits, lane, agent } = known;
  const top = best(known);
  const { pair, cell } = known.next ?? top;
  if (pair < 0) return "";
  const value = values_m[pair][cell] ?? 0;
  const tried = visits?.[pair]?.[cell] ?? 0;
  const name = scene.value.lanes?.[lane]?.name ?? agentOf(agent).title;
  const move = `${name} will move legs ${pairs[pair].join(" and ")} to ${placeName(known, cell, " mm")}`;
  const why = value < top.value ? " to explore" : "";
  const past = tried
    ? `It has tried that ${tried === 1 ? "once" : `${count(tried, "time")}`} from here, and expects ${millimetres(value)} mm from it and what follows.`
    : "It has never tried that from here.";
  return html`<b>${move}${why}.</b> ${past}`;
}
