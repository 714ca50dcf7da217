// Figure 4: distance against practice, one chart per gait, with every seed.
import { useState } from "preact/hooks";
import { factorOf, inUnit, placeOf, placesOf, shown, unit, UNIT_NAMES } from "../../experiments/distances.js";
import { count, percentage, sentence } from "../../format.js";
import { largest } from "../../scale.js";
import { agentOf } from "../../settings.js";
import { gaitTitle } from "../../titles.js";
import { html } from "../elements.js";
import { BandChart, CurveTable } from "./band-chart.js";
import { AgentKey, BestKnownWords, LevelKey, PlaceSwitch, PlaceWords, UnitSwitch } from "./report-tools.js";

const HEADROOM = 1.06;

export function FigureFour({ known }) {
  const curves = known.curves.filter(({ steps }) => steps.length > 0);
  const places = placesOf(curves);
  const [chosen, setChosen] = useState(null);
  if (!places.length) return null;
  const place = places.find(({ key }) => key === chosen) ?? places[0];
  const here = curves.filter((one) => placeOf(one) === place.key).map(toUnit);
  const ends = here.flatMap(({ greedy, best, points }) => [greedy ?? 0, best ?? 0, ...points.flat()]);
  const high = HEADROOM * largest(ends, 1e-9);
  const gaits = [...new Set(here.map(({ gait }) => gait))];
  const agents = [...new Set(here.map(({ agent }) => agent))];
  return html`
    <section class="panel figure-four" aria-labelledby="figure-four">
      <div class="report-tools">
        <h2 id="figure-four">Figure 4, with every seed</h2>
        <${PlaceSwitch} places=${places} value=${place.key} onValue=${setChosen} />
        <${UnitSwitch} />
      </div>
      <${PlaceWords} place=${place} />
      <p class="dim">
        ${sentence(UNIT_NAMES[unit.value])}, against steps of practice.
        Line: interquartile mean; band: its 95 % interval; thin: each seed.
      </p>
      <${AgentKey} agents=${agents}><${LevelKey} levels=${keyOf(here)} /><//>
      <div class="gait-panels">
        ${gaits.map((gait) => html`
          <${Gait} key=${gait} gait=${gait} curves=${here.filter((one) => one.gait === gait)} high=${high} />
        `)}
      </div>
      <${BestKnownWords} distances=${here.map(({ best_known_m }) => best_known_m)} />
    </section>
  `;
}

/** The lines of references of a curve's gait that are known, in the unit that is shown. */
const levelsOf = ({ greedy, best }) => [
  { name: agentOf("greedy").title, kind: "greedy", color: agentOf("greedy").color, value: greedy },
  { name: "Best known", kind: "best-known", value: best },
].filter(({ value }) => value !== null);

/** One of each kind. */
const keyOf = (curves) => [...new Map(curves.flatMap(levelsOf).map((one) => [one.kind, one])).values()];

const lastOf = ({ iqm }) => shown(iqm.at(-1));
const titleOf = ({ agent }) => agentOf(agent).title;

function Gait({ gait, curves, high }) {
  const levels = levelsOf(curves[0]);
  const ends = curves.map((one) => `${titleOf(one)} ${lastOf(one)} after ${count(one.steps.at(-1), "step")}`);
  const lines = levels.map(({ name, value }) => `; ${name.toLowerCase()} ${shown(value)}`);
  const label = `${gaitTitle(gait)}: ${ends.join(", ")}${lines.join("")}`;
  const walkers = curves.length === 1 ? walkersOf(curves[0]) : "";
  return html`
    <figure>
      <figcaption>
        <b>${gaitTitle(gait)}</b><span class="dim num">${curves.map(lastOf).join(" · ")}${walkers}</span>
      </figcaption>
      <${BandChart} label=${label} curves=${curves} levels=${levels} high=${high} />
      <${CurveTable} label=${label} curves=${curves} levels=${levels} alone="Typical" />
    </figure>
  `;
}

const walkersOf = ({ walkers }) => (Number.isFinite(walkers.at(-1)) ? `, ${percentage(walkers.at(-1))} walk` : "");

/** A curve with its distances in the chosen unit. */
function toUnit(one) {
  const factor = factorOf(one) ?? 0;
  const all = (list) => list.map((value) => inUnit(value, factor));
  return {
    ...one,
    name: titleOf(one),
    iqm: all(one.iqm_m),
    low: all(one.low_m),
    high: all(one.high_m),
    points: one.points_m.map(all),
    greedy: inUnit(one.greedy_m, factor),
    best: inUnit(one.best_known_m, factor),
  };
}
