// Figure 4: distance against practice, one panel a gait, all seeds behind their middle.
import { useState } from "preact/hooks";
import { count, sentence } from "../../format.js";
import { html } from "../../html.js";
import { agentOf } from "../../selectors.js";
import { placeOf, placesOf } from "../../experiments/places.js";
import { gaitTitle } from "../../experiments/titles.js";
import { factorOf, inUnit, shown, unit, UNIT_NAMES } from "../../experiments/units.js";
import { largest } from "../../scale.js";
import { AsTable } from "../as-table.js";
import { BandChart } from "./band-chart.js";
import { PlaceSwitch, PlaceWords } from "./place-switch.js";
import { UnitSwitch } from "./unit-switch.js";

export function FigureFour({ known }) {
  const curves = known.curves.filter(({ steps }) => steps.length > 0);
  const places = placesOf(curves);
  const [wish, setWish] = useState(null);
  if (!places.length) return null;
  const place = places.find(({ key }) => key === wish) ?? places[0];
  const here = curves.filter((one) => placeOf(one) === place.key).map(inTheUnit);
  const high = 1.06 * largest(here.flatMap(({ greedy, points }) => [greedy ?? 0, ...points.flat()]), 1e-9);
  const gaits = [...new Set(here.map(({ gait }) => gait))];
  const agents = [...new Set(here.map(({ agent }) => agent))];
  return html`
    <section class="panel figure-four" aria-labelledby="figure-four">
      <div class="report-tools">
        <h2 id="figure-four">Figure 4, with every seed</h2>
        <${PlaceSwitch} places=${places} value=${place.key} onValue=${setWish} />
        <${UnitSwitch} />
      </div>
      <${PlaceWords} place=${place} />
      <p class="dim">${sentence(UNIT_NAMES[unit.value])}, after so much practice. Line: interquartile mean; band: its 95 % interval; thin: each seed.</p>
      ${agents.length > 1 && html`<p class="strip-key">${agents.map((name) => html`<span style=${{ "--agent": agentOf(name).color }}><i class="swatch"></i>${agentOf(name).title}</span>`)}</p>`}
      <div class="gait-panels">
        ${gaits.map((gait) => html`<${Gait} key=${gait} gait=${gait} curves=${here.filter((one) => one.gait === gait)} high=${high} />`)}
      </div>
    </section>
  `;
}

function Gait({ gait, curves, high }) {
  const last = (one) => one.iqm.at(-1);
  const ends = curves.map((one) => `${agentOf(one.agent).title} ${shown(last(one))} after ${count(one.steps.at(-1), "step")}`).join(", ");
  const greedy = curves[0].greedy;
  const label = `${gaitTitle(gait)}: ${ends}${greedy === null ? "" : `; greedy ${shown(greedy)}`}`;
  const titles = curves.length > 1 ? curves.map((one) => agentOf(one.agent).title) : ["Typical"];
  return html`
    <figure>
      <figcaption><b>${gaitTitle(gait)}</b><span class="dim num">${curves.map((one) => shown(last(one))).join(" · ")}${curves.length === 1 && walkersOf(curves[0])}</span></figcaption>
      <${BandChart} label=${label} curves=${curves} greedy=${greedy} high=${high} />
      <${AsTable} caption=${label} columns=${["Steps", ...titles.flatMap((title) => [title, "95 %"])]}
        rows=${curves[0].steps.map((n, at) => [n, ...curves.flatMap((one) => [shown(one.iqm[at]), one.low[at] === null ? "–" : `${shown(one.low[at])} – ${shown(one.high[at])}`])])} />
    </figure>
  `;
}

const walkersOf = ({ walkers }) => (Number.isFinite(walkers.at(-1)) ? `, ${Math.round(100 * walkers.at(-1))} % walk` : "");

/** A curve with all its distances in the chosen unit. */
function inTheUnit(one) {
  const factor = factorOf(one) ?? 0;
  const all = (list) => list.map((value) => inUnit(value, factor));
  return {
    ...one, iqm: all(one.iqm_m), low: all(one.low_m), high: all(one.high_m), points: one.points_m.map(all),
    greedy: inUnit(one.greedy_m, factor),
  };
}
