// The tables of all learners of a race side by side, each as a map of its values.
import { useEffect } from "preact/hooks";
import { percentage, whole } from "../../../js/format.js";
import { valueColours } from "../../../js/scale.js";
import { agentOf } from "../../../js/settings.js";
import { colourScale } from "../steps.js";
import { followLaneTables, laneTables, mapOf, trainedLanes } from "../tables.js";
import { html } from "../../../js/components/elements.js";
import { Trouble, Waiting } from "./navigator.js";

/** @import { LaneTable, TableMap } from "../tables.js" */

/** Size of a value in the map [px], and of a landing, of which there is one in a row. */
const [WIDTH, WIDTH_OF_LANDING, HEIGHT] = [8, 40, 3];

export function SideBySide() {
  useEffect(followLaneTables, []);
  if (trainedLanes.value.length < 2) return null;
  const { answer, error, again } = laneTables.value;
  if (answer && answer.length < 2) return null;
  return html`
    <section class="side-by-side" aria-labelledby="side-by-side">
      <h3 id="side-by-side">Tables side by side</h3>
      <${Trouble} error=${error} again=${again} />
      ${!answer && !error && html`<${Waiting} />`}
      ${answer && html`
        <div class="maps" style=${{ "--tables": String(answer.length) }}>
          ${mapsOf(answer).map(({ lane, map }) => html`
            <${TableMapFigure} key=${lane.training_id} lane=${lane} map=${map} />
          `)}
        </div>
        <p class="dim fine">
          A row for each state, and a column for each move from there; of landings one value in a row.
          Dark is low, light is high, and grey was never tried.
        </p>
      `}
    </section>
  `;
}

/** All maps have one scale of colours: a value has the same in each. @param {LaneTable[]} lanes */
function mapsOf(lanes) {
  const maps = lanes.map((lane) => mapOf(lane.table));
  const scale = colourScale({
    low: Math.min(...maps.map(({ low }) => low)), high: Math.max(...maps.map(({ high }) => high)),
  });
  return lanes.map((lane, n) => ({ lane, map: { ...maps[n], ...scale } }));
}

/** @param {{ lane: LaneTable, map: TableMap }} props */
function TableMapFigure({ lane, map }) {
  const { title, color } = agentOf(lane.agent);
  const share = percentage(map.tried / map.all);
  const words = `${whole(map.tried)} of ${whole(map.all)} ${map.kind} tried`;
  const side = map.rows[0].length > 1 ? WIDTH : WIDTH_OF_LANDING;
  const [width, height] = [side * map.rows[0].length, HEIGHT * map.rows.length];
  return html`
    <figure style=${{ "--agent": color }}>
      <figcaption><span class="swatch" aria-hidden="true"></span><b>${title}</b><br />
        <span class="num">${words}</span> <span class="dim num">(${share})</span></figcaption>
      <svg role="img" aria-label=${`Table of ${title}: ${words}`} viewBox=${`0 0 ${width} ${height}`}
        width=${width} height=${height}>
        ${map.rows.flatMap((row, at) => row.map((value, column) => map.legal[at][column] && html`
          <rect x=${side * column} y=${HEIGHT * at} width=${side - 1} height=${HEIGHT - 0.5}
            fill=${fillOf(value, map)} />
        `))}
      </svg>
    </figure>
  `;
}

/** @param {number | null} value @param {TableMap} map */
const fillOf = (value, { low, high }) =>
  (value === null ? "var(--line)" : valueColours(value, low, high).background);
