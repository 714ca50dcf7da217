// Figure 4: distance against practice, one chart per gait, with every seed.
import { useLayoutEffect, useRef, useState } from "preact/hooks";
import { factorOf, inUnit, placeOf, placesOf, shown, unit, UNIT_NAMES } from "../../experiments/distances.js";
import { count, percentage, sentence, whole } from "../../format.js";
import { largest, thinned, ticks } from "../../scale.js";
import { agentOf } from "../../settings.js";
import { gaitTitle } from "../../titles.js";
import { AsTable, Crosshair } from "../charts.js";
import { html } from "../elements.js";
import { PlaceSwitch, PlaceWords, UnitSwitch } from "./report-tools.js";

const HEADROOM = 1.06;

export function FigureFour({ known }) {
  const curves = known.curves.filter(({ steps }) => steps.length > 0);
  const places = placesOf(curves);
  const [chosen, setChosen] = useState(null);
  if (!places.length) return null;
  const place = places.find(({ key }) => key === chosen) ?? places[0];
  const here = curves.filter((one) => placeOf(one) === place.key).map(toUnit);
  const high = HEADROOM * largest(here.flatMap(({ greedy, points }) => [greedy ?? 0, ...points.flat()]), 1e-9);
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
      ${agents.length > 1 && html`<${AgentKey} agents=${agents} />`}
      <div class="gait-panels">
        ${gaits.map((gait) => html`
          <${Gait} key=${gait} gait=${gait} curves=${here.filter((one) => one.gait === gait)} high=${high} />
        `)}
      </div>
    </section>
  `;
}

const AgentKey = ({ agents }) => html`
  <p class="strip-key">
    ${agents.map(agentOf).map(({ color, title }) => html`
      <span style=${{ "--agent": color }}><i class="swatch"></i>${title}</span>
    `)}
  </p>
`;

const lastOf = ({ iqm }) => shown(iqm.at(-1));
const titleOf = ({ agent }) => agentOf(agent).title;

function Gait({ gait, curves, high }) {
  const [{ greedy }] = curves;
  const ends = curves.map((one) => `${titleOf(one)} ${lastOf(one)} after ${count(one.steps.at(-1), "step")}`);
  const label = `${gaitTitle(gait)}: ${ends.join(", ")}${greedy === null ? "" : `; greedy ${shown(greedy)}`}`;
  const titles = curves.length > 1 ? curves.map(titleOf) : ["Typical"];
  const walkers = curves.length === 1 ? walkersOf(curves[0]) : "";
  return html`
    <figure>
      <figcaption>
        <b>${gaitTitle(gait)}</b><span class="dim num">${curves.map(lastOf).join(" · ")}${walkers}</span>
      </figcaption>
      <${BandChart} label=${label} curves=${curves} greedy=${greedy} high=${high} />
      <${AsTable} caption=${label} columns=${["Steps", ...titles.flatMap((title) => [title, "95 %"])]}
        rows=${rowsOf(curves)} />
    </figure>
  `;
}

const rowsOf = (curves) =>
  curves[0].steps.map((steps, block) => [
    whole(steps),
    ...curves.flatMap((one) => [shown(one.iqm[block]), intervalOf(one, block)]),
  ]);

const intervalOf = ({ low, high }, block) =>
  low[block] === null ? "–" : `${shown(low[block])} – ${shown(high[block])}`;

const walkersOf = ({ walkers }) => (Number.isFinite(walkers.at(-1)) ? `, ${percentage(walkers.at(-1))} walk` : "");

/** A curve with its distances in the chosen unit. */
function toUnit(one) {
  const factor = factorOf(one) ?? 0;
  const all = (list) => list.map((value) => inUnit(value, factor));
  return {
    ...one,
    iqm: all(one.iqm_m),
    low: all(one.low_m),
    high: all(one.high_m),
    points: one.points_m.map(all),
    greedy: inUnit(one.greedy_m, factor),
  };
}

const HEIGHT = 208;
/** More lines behind the band cannot be told apart. */
const MOST_SEEDS = 200;
const ROOM = { left: 52, right: 10, top: 20, bottom: 34 };
/** Narrower charts have fewer ticks. */
const WIDE_PX = 300;

/** `curves`: [{agent, steps, iqm, low, high, points}], numbers in the unit that is shown. */
function BandChart({ label, curves, greedy, high }) {
  const [host, width] = useWidth();
  return html`
    <div class="band-chart" ref=${host}>
      ${width > 0 && html`
        <${Chart} label=${label} curves=${curves} greedy=${greedy} high=${high} width=${width} />
        <${Values} label=${label} curves=${curves} greedy=${greedy} />
      `}
    </div>
  `;
}

/** Typical distances with their intervals at the crosshair. */
function Values({ label, curves, greedy }) {
  const xs = [...new Set(curves.flatMap(({ steps }) => steps))].sort((a, b) => a - b);
  const read = (index) => ({
    at: count(xs[index], "step"),
    values: [
      ...curves.map((one) => ({
        name: titleOf(one), color: agentOf(one.agent).color, value: typicalAt(one, one.steps.indexOf(xs[index])),
      })),
      ...(greedy === null ? [] : [{ name: "Greedy", color: agentOf("greedy").color, value: shown(greedy) }]),
    ],
  });
  return html`
    <${Crosshair} label=${`Values of ${label.split(":")[0]}`} xs=${xs} low=${0} high=${Math.max(...xs)} inset=${ROOM}
      read=${read} />
  `;
}

const typicalAt = (one, block) => {
  if (block < 0) return "–";
  return one.low[block] === null ? shown(one.iqm[block]) : `${shown(one.iqm[block])} (${intervalOf(one, block)})`;
};

function Chart({ label, curves, greedy, high, width }) {
  const longest = Math.max(...curves.flatMap(({ steps }) => steps));
  const bottom = HEIGHT - ROOM.bottom;
  const right = width - ROOM.right;
  const x = (steps) => ROOM.left + ((right - ROOM.left) * steps) / longest;
  const y = (value) => bottom - ((bottom - ROOM.top) * Math.max(value, 0)) / high;
  return html`
    <svg width=${width} height=${HEIGHT} role="img" aria-label=${label}>
      ${ticks(high, 4).map((value) => html`
        <line class="rule" x1=${ROOM.left} x2=${right} y1=${y(value)} y2=${y(value)} />
        <text x=${ROOM.left - 6} y=${y(value) + 4} text-anchor="end">${shown(value)}</text>
      `)}
      ${ticks(longest, width > WIDE_PX ? 4 : 2).map((steps) => html`
        <text x=${x(steps)} y=${bottom + 16} text-anchor=${steps === longest ? "end" : "middle"}>${whole(steps)}</text>
      `)}
      <text x=${right} y=${HEIGHT - 3} text-anchor="end">steps of practice</text>
      ${curves.map((one) => html`<${Curve} key=${one.agent} one=${one} x=${x} y=${y} />`)}
      ${greedy !== null && html`
        <line class="mark greedy" x1=${ROOM.left} x2=${right} y1=${y(greedy)} y2=${y(greedy)} />
        <text class="on-line" x=${ROOM.left + 4} y=${y(greedy) - 5}>greedy</text>
      `}
    </svg>
  `;
}

function Curve({ one: { agent, steps, iqm, low, high, points }, x, y }) {
  const pointsAt = (values) => values.map((value, n) => `${x(steps[n]).toFixed(1)} ${y(value).toFixed(1)}`);
  const path = (values) => `M${pointsAt(values).join("L")}`;
  const seeds = points[0].map((_, seed) => points.map((block) => block[seed]));
  const hasBand = low.every((value) => value !== null);
  return html`
    <g style=${{ "--agent": agentOf(agent).color }}>
      ${thinned(seeds, MOST_SEEDS).map((values) => html`<path class="seed-line" d=${path(values)} />`)}
      ${hasBand && html`<path class="band" d=${`${path(low)}L${pointsAt(high).reverse().join("L")}Z`} />`}
      <path class="typical-line" d=${path(iqm)} />
      ${iqm.map((value, n) => html`<circle class="typical-dot" cx=${x(steps[n])} cy=${y(value)} r="3" />`)}
    </g>
  `;
}

/** [ref, width in px], 0 until it is measured. @returns {[{ current: any }, number]} */
function useWidth() {
  /** @type {{ current: any }} */
  const host = useRef(null);
  const [width, setWidth] = useState(0);
  useLayoutEffect(() => {
    const watcher = new ResizeObserver(([{ contentRect }]) => setWidth(Math.round(contentRect.width)));
    watcher.observe(host.current);
    return () => watcher.disconnect();
  }, []);
  return [host, width];
}
