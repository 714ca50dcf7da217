// Figure 4: distance against practice, one chart per gait, with every seed.
import { useState } from "preact/hooks";
import {
  asMarks, distanceAxis, factorOf, inUnit, placeOf, placesOf, shown, stepsAxis, unit, UNIT_NAMES,
} from "../distances.js";
import { count, percentage, sentence } from "../../../js/format.js";
import { agentOf } from "../../../js/settings.js";
import { gaitTitle } from "../../../js/titles.js";
import { Chart } from "../../../js/components/charts.js";
import { html } from "../../../js/components/elements.js";
import { AgentKey, BestKnownWords, LevelKey, PlaceSwitch, PlaceWords, UnitSwitch } from "./report-tools.js";

/** @import { Line } from "../../../js/chart.js" */
/** @import { CurveOfSetting, Summary } from "../../../js/types.js" */

/** @param {{ known: Summary }} props */
export function FigureFour({ known }) {
  const curves = known.curves.filter(({ steps }) => steps.length > 0);
  const places = placesOf(curves);
  const [chosen, setChosen] = useState(/** @type {string | null} */ (null));
  if (!places.length) return null;
  const place = places.find(({ key }) => key === chosen) ?? places[0];
  const here = curves.filter((one) => placeOf(one) === place.key).map(toUnit);
  const charts = here.map((one) => ({ lines: [one], marks: asMarks(levelsOf(one)) }));
  const axes = { x: stepsAxis(here, known.config), y: distanceAxis(charts) };
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
        ${here.some(isInOneGo) && " Dotted: as many steps in one go, in which ε falls once and not in each block."}
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

/** References of a curve's gait. @typedef {{ greedy: number | null, best: number | null }} Levels */
/**
 * A curve in the unit that is shown, with its references.
 * @typedef {Line & Pick<CurveOfSetting, "agent" | "blocks" | "gait" | "walkers" | "best_known_m"> & Levels} ShownCurve
 */

/**
 * The lines of references of a curve's gait that are known, in the unit that is shown.
 * @param {Levels} one
 */
const levelsOf = ({ greedy, best }) => [
  { name: agentOf("greedy").title, kind: "greedy", value: greedy },
  { name: "Best known", kind: "best-known", value: best },
].flatMap(({ value, ...level }) => (value === null ? [] : [{ ...level, value }]));

/** One of each kind. @param {ShownCurve[]} curves */
const keyOf = (curves) => [...new Map(curves.flatMap(levelsOf).map((one) => [one.kind, one])).values()];

/** @param {ShownCurve} one */
const lastOf = ({ ys }) => shown(ys.at(-1));
/** Whether it practised all its steps in one go. @param {{ blocks: number }} one */
const isInOneGo = ({ blocks }) => blocks === 1;
/** @param {{ agent: string, blocks: number }} one */
const titleOf = (one) => `${agentOf(one.agent).title}${isInOneGo(one) ? ", in one go" : ""}`;
/** Dashes of a practice in one go [px]. */
const DOTTED = [2, 3];

/** @param {{ gait: string, curves: ShownCurve[], axes: Pick<Parameters<typeof Chart>[0], "x" | "y"> }} props */
function Gait({ gait, curves, axes }) {
  const levels = levelsOf(curves[0]);
  const ends = curves.map((one) => `${one.name} ${lastOf(one)} after ${count(one.xs.at(-1) ?? 0, "step")}`);
  const lines = levels.map(({ name, value }) => `; ${name.toLowerCase()} ${shown(value)}`);
  const label = `${gaitTitle(gait)}: ${ends.join(", ")}${lines.join("")}`;
  const inBlocks = curves.filter((one) => !isInOneGo(one));
  const walkers = inBlocks.length === 1 ? walkersOf(inBlocks[0]) : "";
  return html`
    <figure>
      <figcaption>
        <b>${gaitTitle(gait)}</b><span class="dim num">${inBlocks.map(lastOf).join(" · ")}${walkers}${
          curves.filter(isInOneGo).map((one) => ` · ${lastOf(one)} in one go`)}</span>
      </figcaption>
      <${Chart} name=${gaitTitle(gait)} label=${label} lines=${curves} marks=${asMarks(levels)} xs=${curves[0].xs}
        ...${axes} />
    </figure>
  `;
}

/** @param {{ walkers: (number | null)[] }} one */
const walkersOf = ({ walkers }) => {
  const last = walkers.at(-1) ?? null;
  return last === null ? "" : `, ${percentage(last)} walk`;
};

/** A curve as a line of a chart, in the chosen unit. @type {(one: CurveOfSetting) => ShownCurve} */
function toUnit(one) {
  const factor = factorOf(one) ?? 0;
  /** @param {(number | null)[]} list */
  const all = (list) => list.map((value) => inUnit(value, factor));
  return {
    ...one,
    name: titleOf(one),
    color: agentOf(one.agent).color,
    xs: one.steps,
    ys: all(one.iqm_m),
    low: all(one.low_m),
    high: all(one.high_m),
    // Those of the blocks are enough to see how far seeds lie apart.
    seeds: isInOneGo(one) ? [] : one.points_m.map(all),
    dots: !isInOneGo(one),
    dash: isInOneGo(one) ? DOTTED : [],
    greedy: inUnit(one.greedy_m, factor),
    best: inUnit(one.best_known_m, factor),
  };
}
