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
import { drawn } from "../printing.js";
import { AgentKey, BestKnownWords, LevelKey, PlaceSwitch, PlaceTitle, PlaceWords, UnitSwitch } from "./report-tools.js";

/** @import { Line } from "../../../js/chart.js" */
/** @import { CurveOfSetting, Place, Summary } from "../../../js/types.js" */

/** @param {{ summary: Summary }} props */
export function FigureFour({ summary }) {
  const curves = summary.curves.filter(({ steps }) => steps.length > 0);
  const places = placesOf(curves);
  const [chosen, setChosen] = useState(/** @type {string | null} */ (null));
  if (!places.length) return null;
  const place = places.find(({ key }) => key === chosen) ?? places[0];
  const agents = [...new Set(curves.map(({ agent }) => agent))];
  return html`
    <section class="panel figure-four" aria-labelledby="figure-four">
      <div class="report-tools">
        <h2 id="figure-four">Figure 4, with every seed</h2>
        <${PlaceSwitch} places=${places} value=${place.key} onValue=${setChosen} />
        <${UnitSwitch} />
      </div>
      <p class="dim">
        ${sentence(UNIT_NAMES[unit.value])}, against steps of practice.
        Line: interquartile mean; band: its 95 % interval; thin: each seed.
        ${curves.some(isInOneGo) && " Dotted: as many steps in one go, in which ε falls once and not in each block."}
      </p>
      <${AgentKey} agents=${agents}><${LevelKey} levels=${keyOf(curves.map(toUnit))} /><//>
      ${drawn(places, place).map((each) => html`
        <${InPlace} key=${each.key} summary=${summary} curves=${curves} place=${each} places=${places} />
      `)}
      <${BestKnownWords} distances=${curves.map(({ best_known_m }) => best_known_m)} />
    </section>
  `;
}

/** @param {{ summary: Summary, curves: CurveOfSetting[], place: Place, places: Place[] }} props */
function InPlace({ summary, curves, place, places }) {
  const here = curves.filter((curve) => placeOf(curve) === place.key).map(toUnit);
  const charts = here.map((curve) => ({ lines: [curve], marks: asMarks(levelsOf(curve)) }));
  const axes = { x: stepsAxis(here, summary.config), y: distanceAxis(charts) };
  const gaits = [...new Set(here.map(({ gait }) => gait))];
  return html`
    <${PlaceTitle} place=${place} places=${places} />
    <${PlaceWords} place=${place} />
    <div class="gait-panels">
      ${gaits.map((gait) => html`
        <${Gait} key=${gait} gait=${gait} curves=${here.filter((curve) => curve.gait === gait)} axes=${axes} />
      `)}
    </div>
  `;
}

/** References of a curve's gait. @typedef {{ greedy: number | null, best: number | null }} Levels */
/**
 * A curve in the unit that is shown, with its references.
 * @typedef {Line & Pick<CurveOfSetting, "agent" | "blocks" | "gait" | "walkers" | "best_known_m"> & Levels} ShownCurve
 */

/**
 * The lines of references of a curve's gait that are known, in the unit that is shown.
 * @param {Levels} levels
 */
const levelsOf = ({ greedy, best }) => [
  { name: agentOf("greedy").title, kind: "greedy", value: greedy },
  { name: "Best known", kind: "best-known", value: best },
].flatMap(({ value, ...level }) => (value === null ? [] : [{ ...level, value }]));

/** One of each kind. @param {ShownCurve[]} curves */
const keyOf = (curves) => [...new Map(curves.flatMap(levelsOf).map((level) => [level.kind, level])).values()];

/** @param {ShownCurve} curve */
const lastOf = ({ ys }) => shown(ys.at(-1));
/** Whether it practised all its steps in one go. @param {{ blocks: number }} curve */
const isInOneGo = ({ blocks }) => blocks === 1;
/** @param {{ agent: string, blocks: number }} curve */
const titleOf = (curve) => `${agentOf(curve.agent).title}${isInOneGo(curve) ? ", in one go" : ""}`;
/** Dashes of a practice in one go [px]. */
const DOTTED = [2, 3];

/** @param {{ gait: string, curves: ShownCurve[], axes: Pick<Parameters<typeof Chart>[0], "x" | "y"> }} props */
function Gait({ gait, curves, axes }) {
  const levels = levelsOf(curves[0]);
  const ends = curves.map((curve) => `${curve.name} ${lastOf(curve)} after ${count(curve.xs.at(-1) ?? 0, "step")}`);
  const lines = levels.map(({ name, value }) => `; ${name.toLowerCase()} ${shown(value)}`);
  const label = `${gaitTitle(gait)}: ${ends.join(", ")}${lines.join("")}`;
  const inBlocks = curves.filter((curve) => !isInOneGo(curve));
  const walkers = inBlocks.length === 1 ? walkersOf(inBlocks[0]) : "";
  return html`
    <figure>
      <figcaption>
        <b>${gaitTitle(gait)}</b><span class="dim num">${inBlocks.map(lastOf).join(" · ")}${walkers}${
          curves.filter(isInOneGo).map((curve) => ` · ${lastOf(curve)} in one go`)}</span>
      </figcaption>
      <${Chart} name=${gaitTitle(gait)} label=${label} lines=${curves} marks=${asMarks(levels)} xs=${curves[0].xs}
        ...${axes} />
    </figure>
  `;
}

/** @param {{ walkers: (number | null)[] }} curve */
const walkersOf = ({ walkers }) => {
  const last = walkers.at(-1) ?? null;
  return last === null ? "" : `, ${percentage(last)} walk`;
};

/** A curve as a line of a chart, in the chosen unit. @type {(curve: CurveOfSetting) => ShownCurve} */
function toUnit(curve) {
  const factor = factorOf(curve) ?? 0;
  /** @param {(number | null)[]} list */
  const all = (list) => list.map((value) => inUnit(value, factor));
  return {
    ...curve,
    name: titleOf(curve),
    color: agentOf(curve.agent).color,
    xs: curve.steps,
    ys: all(curve.iqm_m),
    low: all(curve.low_m),
    high: all(curve.high_m),
    // Those of the blocks are enough to see how far seeds lie apart.
    seeds: isInOneGo(curve) ? [] : curve.points_m.map(all),
    dots: !isInOneGo(curve),
    dash: isInOneGo(curve) ? DOTTED : [],
    greedy: inUnit(curve.greedy_m, factor),
    best: inUnit(curve.best_known_m, factor),
  };
}
