// Figure 4: distance against practice, one chart per gait, with every seed.
import { useState } from "preact/hooks";
import {
  asMarks, distanceAxis, factorOf, inUnit, placeOf, placesOf, shown, stepsAxis, unit, UNIT_NAMES,
} from "../../experiments/distances.js";
import { count, percentage, sentence } from "../../format.js";
import { agentOf } from "../../settings.js";
import { gaitTitle } from "../../titles.js";
import { Chart } from "../charts.js";
import { html } from "../elements.js";
import { AgentKey, BestKnownWords, LevelKey, PlaceSwitch, PlaceWords, UnitSwitch } from "./report-tools.js";

export function FigureFour({ known }) {
  const curves = known.curves.filter(({ steps }) => steps.length > 0);
  const places = placesOf(curves);
  const [chosen, setChosen] = useState(null);
  if (!places.length) return null;
  const place = places.find(({ key }) => key === chosen) ?? places[0];
  const here = curves.filter((one) => placeOf(one) === place.key).map(toUnit);
  const charts = here.map((one) => ({ lines: [one], marks: asMarks(levelsOf(one)) }));
  const axes = { x: stepsAxis(here), y: distanceAxis(charts) };
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
          <${Gait} key=${gait} gait=${gait} curves=${here.filter((one) => one.gait === gait)} axes=${axes} />
        `)}
      </div>
      <${BestKnownWords} distances=${here.map(({ best_known_m }) => best_known_m)} />
    </section>
  `;
}

/** The lines of references of a curve's gait that are known, in the unit that is shown. */
const levelsOf = ({ greedy, best }) => [
  { name: agentOf("greedy").title, kind: "greedy", value: greedy },
  { name: "Best known", kind: "best-known", value: best },
].filter(({ value }) => value !== null);

/** One of each kind. */
const keyOf = (curves) => [...new Map(curves.flatMap(levelsOf).map((one) => [one.kind, one])).values()];

const lastOf = ({ ys }) => shown(ys.at(-1));
const titleOf = ({ agent }) => agentOf(agent).title;

function Gait({ gait, curves, axes }) {
  const levels = levelsOf(curves[0]);
  const ends = curves.map((one) => `${titleOf(one)} ${lastOf(one)} after ${count(one.xs.at(-1), "step")}`);
  const lines = levels.map(({ name, value }) => `; ${name.toLowerCase()} ${shown(value)}`);
  const label = `${gaitTitle(gait)}: ${ends.join(", ")}${lines.join("")}`;
  const walkers = curves.length === 1 ? walkersOf(curves[0]) : "";
  return html`
    <figure>
      <figcaption>
        <b>${gaitTitle(gait)}</b><span class="dim num">${curves.map(lastOf).join(" · ")}${walkers}</span>
      </figcaption>
      <${Chart} name=${gaitTitle(gait)} label=${label} lines=${curves} marks=${asMarks(levels)} xs=${curves[0].xs}
        ...${axes} />
    </figure>
  `;
}

const walkersOf = ({ walkers }) => (Number.isFinite(walkers.at(-1)) ? `, ${percentage(walkers.at(-1))} walk` : "");

/** A curve as a line of a chart, in the chosen unit. */
function toUnit(one) {
  const factor = factorOf(one) ?? 0;
  const all = (list) => list.map((value) => inUnit(value, factor));
  return {
    ...one,
    name: titleOf(one),
    color: agentOf(one.agent).color,
    xs: one.steps,
    ys: all(one.iqm_m),
    low: all(one.low_m),
    high: all(one.high_m),
    seeds: one.points_m.map(all),
    dots: true,
    greedy: inUnit(one.greedy_m, factor),
    best: inUnit(one.best_known_m, factor),
  };
}
