// The gait of the run in view: a footfall diagram per lane, the body and the servos over time, and its figures.
import { useEffect, useMemo } from "preact/hooks";
import { count } from "../../js/format.js";
import {
  AFTER_S, analysis, BEFORE_S, canSeek, colorOf, cycleSentence, extentOf, FIGURES, followGait, isWhole,
  legsInOrder, legsInTheAir, lineOf, momentOf, part, problem, rangeInWords, seek, SERIES, subject, swingsOf,
} from "./gait.js";
import { percent, shareOf, ticks } from "../../js/scale.js";
import { agentOf, laneTitle } from "../../js/settings.js";
import { AsTable, Empty } from "../../js/components/charts.js";
import { html, Segments } from "../../js/components/elements.js";

/** @import { GaitAnalysis, GaitFigures, Run } from "../../js/types.js" */
/** @import { Range } from "../../js/chart.js" */
/** @import { Series } from "./gait.js" */
/** @import { ComponentChildren } from "preact" */

const INVITATION = "When a robot walks, its footfalls are drawn here: a bar where a foot is on the ground.";

export function Gait() {
  useEffect(followGait, []);
  const figures = analysis.value;
  const { run, part: shown } = subject.value ?? {};
  const lanes = useMemo(() => figures && run && lanesOf(figures, run), [figures, run?.config, colorOf(0)]);
  return html`
    <section class="gait-tab" aria-label="Gait analysis">
      <p class="dim">When each foot is on the ground, in robot time: without the time that decisions take</p>
      ${run && run.progress.done > 0 && html`<${Choices} shown=${shown} />`}
      <div role="alert">${problem.value && html`<p class="problem">${problem.value}</p>`}</div>
      ${lanes?.length
        ? html`<div><${Figures} lanes=${lanes} known=${figures} /></div>`
        : html`<${Empty} words=${figures ? "Nothing is recorded of this part of the walk." : INVITATION} />`}
    </section>
  `;
}

/** A lane that is drawn. @typedef {ReturnType<typeof lanesOf>[number]} ShownLane */
/** The lines of a strip. @typedef {NonNullable<ReturnType<typeof linesOf>>} Strip */
/** The time that is drawn, and the moment in it. @typedef {{ now: number | null, low: number, high: number }} View */

/**
 * The lanes of which something is known, with their names and colours.
 * @param {GaitAnalysis} analysed
 * @param {Run} run
 */
function lanesOf(analysed, run) {
  return analysed.lanes.flatMap((lane, number) => {
    const config = run.config.lanes?.[number] ?? lane;
    const { color, title } = agentOf(lane.agent);
    if (!lane.figures) return [];
    const look = run.kind === "race" ? { title: laneTitle(config), color: colorOf(number) ?? color } : { title, color };
    const { figures } = lane;
    return [{ ...lane, figures, ...look, number, legs: legsInOrder(run, figures.legs.length) }];
  });
}

/**
 * The moment of a lane that is shown, and the time that is drawn around it.
 * @param {ShownLane} lane
 * @param {boolean} isAround
 * @param {{ from: number, to: number }} window
 */
function viewOf(lane, isAround, { from, to }) {
  const now = momentOf(lane.number);
  if (!isAround) return { now, low: from, high: to };
  const middle = Math.min(now ?? lane.figures.to_s, lane.recorded_to_s);
  return { now, low: middle - BEFORE_S, high: middle + AFTER_S };
}

/**
 * Drawings that do not depend on the moment are kept: it changes several times a second.
 * @param {{ lanes: ShownLane[], known: GaitAnalysis }} props
 */
function Figures({ lanes, known }) {
  const isAround = !isWhole.value && known.part !== "evaluation";
  const from = Math.min(...lanes.map(({ figures }) => figures.from_s));
  const to = Math.max(...lanes.map(({ figures }) => figures.to_s));
  const views = lanes.map((lane) => viewOf(lane, isAround, { from, to }));
  const lines = useMemo(() => SERIES.map((series) => linesOf(lanes, series)), [lanes]);
  const words = useMemo(() => html`
    ${[...new Set(lanes.map(({ no_effort }) => no_effort))].map((why) => why && html`<p class="dim">${why}</p>`)}
    <${Numbers} lanes=${lanes} from=${from} to=${to} />
    <${AsTable} caption="Footfalls" columns=${() => ["Leg", "Duty factor", "In the air, s"]}
      rows=${() => rowsOf(lanes)} />
  `, [lanes]);
  return html`
    ${lanes.map((lane, n) => html`
      <${Footfalls} key=${lane.number} lane=${lane} view=${views[n]} step_s=${known.step_s} />
    `)}
    <${TimeAxis} isAround=${isAround} low=${from} high=${to} />
    ${SERIES.map((series, n) => lines[n] && html`
      <${Line} key=${series.values} series=${series} lines=${lines[n]} views=${views} isAround=${isAround} />
    `)}
    ${words}
  `;
}

/** @param {"practice" | "evaluation"} value */
const choosePart = (value) => {
  part.value = value;
};
/** @param {boolean} value */
const chooseExtent = (value) => {
  isWhole.value = value;
};

/** @param {{ shown: GaitAnalysis["part"] }} props */
const Choices = ({ shown }) => html`
  <div class="walk-choices">
    ${shown !== "race" && html`
      <${Segments} label="Part of the training" value=${shown} onValue=${choosePart}
        choices=${[["practice", "Practice"], ["evaluation", "Newest test"]]} />
    `}
    ${shown !== "evaluation" && html`
      <${Segments} label="Time shown" value=${isWhole.value} onValue=${chooseExtent}
        choices=${[[false, "Around now"], [true, "Whole walk"]]} />
    `}
  </div>
`;

// ---- the footfall diagram of a lane

const BAR = 0.72;

/**
 * The bars of a leg as one path: a unit high, in seconds.
 * @param {{ stance: Range[] }} range
 * @param {number} row
 */
const barsOf = ({ stance }, row) =>
  stance.map(([from, to]) => `M${from} ${row + (1 - BAR) / 2}H${to}v${BAR}H${from}z`).join("");

/** @param {{ lane: ShownLane, view: View, step_s: number }} props */
function Footfalls({ lane, view, step_s }) {
  const { figures, title, color, legs } = lane;
  const { now, low, high } = view;
  const bars = useMemo(() => legs.map(([leg], row) => html`
    <path class="stance" d=${barsOf(figures.legs[leg - 1], row)} />
  `), [lane]);
  const head = useMemo(() => html`
    <p class="walk-title">
      <span class="swatch"></span><b>${title}</b><span class="dim">${cycleSentence(figures, legs)}</span>
    </p>
  `, [lane]);
  const names = useMemo(() => html`
    <ol class="leg-names" aria-hidden="true">
      ${legs.map(([leg, pair]) => html`<li><i class=${pair ? `pair-${pair}` : "pair-none"}></i>${leg}</li>`)}
    </ol>
  `, [lane]);
  return html`
    <div class="walk-lane" style=${{ "--agent": color }}>
      ${head}
      <div class="walk-row" style=${{ "--legs": legs.length }}>
        ${names}
        <${Timeline} lane=${lane} view=${view} step_s=${step_s}>
          <svg viewBox=${`${low} 0 ${high - low} ${legs.length}`} preserveAspectRatio="none" aria-hidden="true">
            ${legs.map((_, row) => html`<path class="swing" d=${`M${low} ${row + 0.5}H${high}`} />`)}
            ${bars}
          </svg>
          ${now !== null && html`<i class="now" style=${{ left: percent(shareOf(now, low, high)) }}></i>`}
        <//>
      </div>
    </div>
  `;
}

/** @type {Record<string, number>} */
const KEYS = { ArrowLeft: -1, ArrowDown: -1, ArrowRight: 1, ArrowUp: 1, PageDown: -10, PageUp: 10 };

/**
 * Frame of the drawings over time; a click, or an arrow key for a step, seeks where that is allowed.
 * @param {{ lane: ShownLane, view: View, step_s: number, children: ComponentChildren }} props
 */
function Timeline({ lane, view, step_s, children }) {
  const { number, title, figures, recorded_to_s } = lane;
  const { now, low, high } = view;
  const words = wordsAt(figures, now ?? figures.to_s, step_s);
  const label = `Footfalls of ${title}`;
  if (!canSeek.value || now === null) {
    return html`<div class="walk-plot" role="img" aria-label=${`${label}: ${words}`}>${children}</div>`;
  }
  /** @param {MouseEvent & { currentTarget: HTMLElement }} event */
  const onClick = ({ clientX, currentTarget }) => {
    const { left, width } = currentTarget.getBoundingClientRect();
    if (width > 0) seek(number, Math.min(low + ((high - low) * (clientX - left)) / width, recorded_to_s));
  };
  /** @param {KeyboardEvent} event */
  const onKeyDown = (event) => {
    const steps = KEYS[event.key];
    if (!steps || event.ctrlKey || event.altKey || event.metaKey) return;
    event.preventDefault();
    seek(number, Math.min(now + steps * step_s, recorded_to_s));
  };
  return html`
    <div class="walk-plot seeks" role="slider" tabindex="0" aria-label=${label} aria-valuemin="0"
      aria-valuemax=${recorded_to_s} aria-valuenow=${now} aria-valuetext=${words} onClick=${onClick}
      onKeyDown=${onKeyDown}>${children}</div>
  `;
}

/** @param {GaitFigures} figures @param {number} time @param {number} step_s */
function wordsAt(figures, time, step_s) {
  const air = legsInTheAir(figures, time);
  const step = Math.max(1, Math.ceil(time / step_s - 1e-6));
  const feet = air.length ? `in the air: ${count(air.length, "leg")}, ${air.join(", ")}` : "all feet on the ground";
  return `${time.toFixed(1)} s of robot time, step ${step}, ${feet}`;
}

/** @param {{ isAround: boolean, low: number, high: number }} props */
function TimeAxis({ isAround, low, high }) {
  /** @type {[number, string][]} */
  const marks = isAround
    ? [-3, -2, -1, 0, 1].map((s) => [s, s === 0 ? "now" : `${s < 0 ? "\u2212" : "+"}${Math.abs(s)}\u00a0s`])
    : ticks(high - low, 8).map((s) => [low + s, `${Number((low + s).toFixed(2))}\u00a0s`]);
  const [from, to] = isAround ? [-BEFORE_S, AFTER_S] : [low, high];
  return html`
    <div class="walk-row walk-axis dim" aria-hidden="true">
      <span></span>
      <div>
        ${marks.map(([at, text]) => html`<span style=${{ left: percent(shareOf(at, from, to)) }}>${text}</span>`)}
      </div>
    </div>
  `;
}

// ---- the body and the servos over time, all lanes in one strip

/**
 * The lines of a strip with their values in words; null where nothing of it was recorded.
 * @param {ShownLane[]} lanes
 * @param {Series} series
 */
function linesOf(lanes, series) {
  const { unit, decimals = 1 } = series;
  const lines = lanes.flatMap(({ figures, title, color }, index) => {
    const line = lineOf(figures, series);
    if (!line) return [];
    const { low, high } = extentOf([line.values], { least: 0 });
    const d = `M${line.times.map((time, n) => `${time} ${(-line.values[n]).toFixed(4)}`).join("L")}`;
    const words = `${title} ${rangeInWords([low, high], decimals, unit)}`;
    return [{ index, color, words, values: line.values, path: html`<path class="curve" d=${d} />` }];
  });
  if (!lines.length) return null;
  const { low, high } = extentOf(lines.map(({ values }) => values), series);
  return { lines, low, high, range: rangeInWords([low, high], decimals, unit) };
}

/** @param {{ series: Series, lines: Strip, views: View[], isAround: boolean }} props */
function Line({ series: { name }, lines: { lines, low, high, range }, views, isAround }) {
  const shown = lines.map((line) => ({ ...line, view: views[line.index] }));
  // Around the present moment all lanes have theirs at one place.
  const cursors = shown.filter(({ view }) => view.now !== null).slice(0, isAround ? 1 : shown.length);
  return html`
    <div class="walk-row">
      <p class="walk-name">${name} <span class="dim">${range}</span></p>
      <div class="walk-plot line" role="img" aria-label=${`${name}: ${lines.map(({ words }) => words).join(", ")}`}>
        ${shown.map(({ index, color, view, path }) => html`
          <svg key=${index} viewBox=${`${view.low} ${-high} ${view.high - view.low} ${high - low}`}
            preserveAspectRatio="none" style=${{ "--agent": color }} aria-hidden="true">${path}</svg>
        `)}
        ${cursors.map(({ index, color, view }) => html`
          <i key=${index} class=${isAround ? "now" : "now own"}
            style=${{ left: percent(shareOf(view.now ?? NaN, view.low, view.high)), "--agent": color }}></i>
        `)}
      </div>
    </div>
  `;
}

// ---- the figures, and the footfalls as a table

/** With more lanes there is no room beside the figures for what they mean. */
const MAX_EXPLAINED = 3;

/** @param {{ lanes: ShownLane[], from: number, to: number }} props */
const Numbers = ({ lanes, from, to }) => html`
  <div class=${`scroller walk-figures ${lanes.length > MAX_EXPLAINED ? "many" : ""}`}
    tabindex="0" role="region" aria-label="Figures of the gait">
    <table>
      <caption class="dim">From ${from.toFixed(1)} to ${to.toFixed(1)} s of robot time</caption>
      <thead>
        <tr>
          <td></td>
          ${lanes.map(({ title, color }) => html`
            <th scope="col" style=${{ "--agent": color }}><span class="swatch"></span> ${title}</th>
          `)}
          <td class="meaning"></td>
        </tr>
      </thead>
      <tbody>
        ${FIGURES.map(([name, help, words]) => html`
          <tr>
            <th scope="row">${name}</th>
            ${lanes.map(({ figures }) => html`<td class="num">${words(figures) ?? "–"}</td>`)}
            <td class="meaning dim" aria-hidden="true">${help}</td>
          </tr>
        `)}
      </tbody>
    </table>
  </div>
  <details class=${`as-table ${lanes.length > MAX_EXPLAINED ? "" : "narrow-only"}`}>
    <summary>Definitions of the figures</summary>
    <dl class="walk-help">${FIGURES.map(([name, help]) => html`<dt>${name}</dt><dd>${help}</dd>`)}</dl>
  </details>
`;

const MAX_SWINGS = 40;

/** @param {ShownLane[]} lanes */
function rowsOf(lanes) {
  return lanes.flatMap(({ title, figures }) => figures.legs.map(({ leg, stance, duty_factor }) => {
    const swings = swingsOf(stance, figures);
    const shown = swings.slice(0, MAX_SWINGS).map(([a, b]) => `${a.toFixed(2)}–${b.toFixed(2)}`).join(", ");
    const more = swings.length > MAX_SWINGS ? ` and ${swings.length - MAX_SWINGS} more` : "";
    return [`${title}, leg ${leg}`, duty_factor.toFixed(2), shown ? `${shown}${more}` : "never"];
  }));
}
