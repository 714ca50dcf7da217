// The gait of the run in view: a footfall diagram per lane, the body and the servos over time, and its figures.
import { useEffect, useMemo } from "preact/hooks";
import { count } from "../format.js";
import {
  AFTER_S, analysis, BEFORE_S, canSeek, cycleSentence, extentOf, FIGURES, followGait, isWatched, isWhole, legsInOrder,
  legsInTheAir, lineOf, momentOf, part, rangeInWords, seek, SERIES, subject, swingsOf,
} from "../gait.js";
import { percent, shareOf, ticks } from "../scale.js";
import { agentOf, laneTitle } from "../settings.js";
import { AsTable, Empty } from "./charts.js";
import { html, Segments } from "./elements.js";

const INVITATION = "When a robot walks, its footfalls are drawn here: a bar where a foot is on the ground.";

/** @param {{ isNear: boolean }} props whether the panel can be seen */
export function Gait({ isNear }) {
  useEffect(() => {
    isWatched.value = isNear;
  }, [isNear]);
  useEffect(followGait, []);
  const known = analysis.value;
  const lanes = known && lanesOf(known, subject.value?.run);
  return html`
    <p class="dim">When each foot is on the ground, in robot time: without the time that decisions take</p>
    ${lanes?.length ? html`<${Figures} lanes=${lanes} known=${known} />` : html`<${Empty} words=${INVITATION} />`}
  `;
}

/** The lanes of which something is known, with their names and colours. */
function lanesOf(known, run) {
  return known.lanes.flatMap((lane, number) => {
    const config = run.config.lanes?.[number] ?? lane;
    const { color, title } = agentOf(lane.agent);
    if (!lane.figures) return [];
    return [{ ...lane, number, color, title: run.kind === "race" ? laneTitle(config) : title, run }];
  });
}

function Figures({ lanes, known }) {
  const isAround = !isWhole.value && known.part !== "evaluation";
  const to = Math.max(...lanes.map(({ figures }) => figures.to_s));
  const from = Math.min(...lanes.map(({ figures }) => figures.from_s));
  const drawn = lanes.map((lane) => {
    const now = momentOf(lane.number);
    const middle = Math.min(now ?? lane.figures.to_s, lane.recorded_to_s);
    const [low, high] = isAround ? [middle - BEFORE_S, middle + AFTER_S] : [from, to];
    return { ...lane, now, low, high };
  });
  const missing = [...new Set(lanes.map(({ no_effort }) => no_effort).filter(Boolean))];
  return html`
    <${Choices} known=${known} />
    ${drawn.map((lane) => html`<${Footfalls} key=${lane.number} lane=${lane} step_s=${known.step_s} />`)}
    <${TimeAxis} isAround=${isAround} low=${from} high=${to} />
    ${SERIES.map((series) => html`
      <${Line} key=${series.values} series=${series} lanes=${drawn} isAround=${isAround} />
    `)}
    ${missing.map((words) => html`<p class="dim">${words}</p>`)}
    <${Numbers} lanes=${lanes} from=${from} to=${to} />
    <${AsTable} caption="Footfalls" columns=${() => ["Leg", "Duty factor", "In the air, s"]}
      rows=${() => rowsOf(lanes)} />
  `;
}

const Choices = ({ known }) => html`
  <div class="walk-choices">
    ${known.part !== "race" && html`
      <${Segments} label="Part of the training" value=${known.part} onValue=${(value) => (part.value = value)}
        choices=${[["practice", "Practice"], ["evaluation", "Newest test"]]} />
    `}
    ${known.part !== "evaluation" && html`
      <${Segments} label="Time shown" value=${isWhole.value} onValue=${(value) => (isWhole.value = value)}
        choices=${[[false, "Around now"], [true, "Whole walk"]]} />
    `}
  </div>
`;

// ---- the footfall diagram of a lane

const BAR = 0.72;

/** The bars of a leg as one path: a unit high, in seconds. */
const barsOf = ({ stance }, row) =>
  stance.map(([from, to]) => `M${from} ${row + (1 - BAR) / 2}H${to}v${BAR}H${from}z`).join("");

function Footfalls({ lane, step_s }) {
  const { figures, title, color, run, now, low, high } = lane;
  const legs = useMemo(() => legsInOrder(run, figures.legs.length), [run.config, figures]);
  const paths = useMemo(() => legs.map(([leg], row) => barsOf(figures.legs[leg - 1], row)), [figures, legs]);
  return html`
    <div class="walk-lane" style=${{ "--agent": color }}>
      <p class="walk-title">
        <span class="swatch"></span><b>${title}</b>
        <span class="dim">${cycleSentence(figures, legs)}</span>
      </p>
      <div class="walk-row" style=${{ "--legs": legs.length }}>
        <ol class="leg-names" aria-hidden="true">
          ${legs.map(([leg, pair]) => html`<li><i class=${pair ? `pair-${pair}` : "pair-none"}></i>${leg}</li>`)}
        </ol>
        <${Timeline} lane=${lane} step_s=${step_s}>
          <svg viewBox=${`${low} 0 ${high - low} ${legs.length}`} preserveAspectRatio="none" aria-hidden="true">
            ${legs.map((_, row) => html`<path class="swing" d=${`M${low} ${row + 0.5}H${high}`} />`)}
            ${paths.map((d) => html`<path class="stance" d=${d} />`)}
          </svg>
          ${now !== null && html`<i class="now" style=${{ left: percent(shareOf(now, low, high)) }}></i>`}
        <//>
      </div>
    </div>
  `;
}

const KEYS = { ArrowLeft: -1, ArrowDown: -1, ArrowRight: 1, ArrowUp: 1, PageDown: -10, PageUp: 10 };

/** What is drawn over time; a click, or an arrow key for a step, seeks where that is allowed. */
function Timeline({ lane, step_s, children }) {
  const { number, title, figures, now, low, high, recorded_to_s } = lane;
  const words = wordsAt(figures, now ?? figures.to_s, step_s);
  const label = `Footfalls of ${title}`;
  if (!canSeek.value || now === null) {
    return html`<div class="walk-plot" role="img" aria-label=${`${label}: ${words}`}>${children}</div>`;
  }
  const onClick = ({ clientX, currentTarget }) => {
    const { left, width } = currentTarget.getBoundingClientRect();
    if (width > 0) seek(number, Math.min(low + ((high - low) * (clientX - left)) / width, recorded_to_s));
  };
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

function wordsAt(figures, time, step_s) {
  const air = legsInTheAir(figures, time);
  const step = Math.max(1, Math.ceil(time / step_s - 1e-6));
  const feet = air.length ? `in the air: ${count(air.length, "leg")}, ${air.join(", ")}` : "all feet on the ground";
  return `${time.toFixed(1)} s of robot time, step ${step}, ${feet}`;
}

function TimeAxis({ isAround, low, high }) {
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

function Line({ series, lanes, isAround }) {
  const lines = lanes.flatMap((lane) => {
    const line = lineOf(lane.figures, series);
    return line ? [{ ...lane, ...line }] : [];
  });
  if (!lines.length) return null;
  const { low, high } = extentOf(lines.map(({ values }) => values), series);
  const { name, unit, decimals = 1 } = series;
  // Around the present moment all lanes have theirs at one place.
  const cursors = lines.filter(({ now }) => now !== null).slice(0, isAround ? 1 : lines.length);
  const words = lines.map(({ title, values }) => {
    const own = extentOf([values], { least: 0 });
    return `${title} ${rangeInWords([own.low, own.high], decimals, unit)}`;
  });
  return html`
    <div class="walk-row">
      <p class="walk-name">
        ${name}<br /><span class="dim">${rangeInWords([low, high], decimals, unit)}</span>
      </p>
      <div class="walk-plot line" role="img" aria-label=${`${name}: ${words.join(", ")}`}>
        ${lines.map((line) => html`
          <svg key=${line.number} viewBox=${`${line.low} ${-high} ${line.high - line.low} ${high - low}`}
            preserveAspectRatio="none" style=${{ "--agent": line.color }} aria-hidden="true">
            <${Path} times=${line.times} values=${line.values} figures=${line.figures} />
          </svg>
        `)}
        ${cursors.map((line) => html`
          <i key=${line.number} class=${isAround ? "now" : "now own"}
            style=${{ left: percent(shareOf(line.now, line.low, line.high)), "--agent": line.color }}></i>
        `)}
      </div>
    </div>
  `;
}

function Path({ times, values, figures }) {
  const d = useMemo(() => `M${times.map((time, n) => `${time} ${(-values[n]).toFixed(4)}`).join("L")}`, [figures]);
  return html`<path class="curve" d=${d} />`;
}

// ---- the figures, and the footfalls as a table

const Numbers = ({ lanes, from, to }) => html`
  <div class="scroller walk-figures" tabindex="0" role="region" aria-label="Figures of the gait">
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
  <details class="as-table narrow-only">
    <summary>What the figures mean</summary>
    <dl class="walk-help">${FIGURES.map(([name, help]) => html`<dt>${name}</dt><dd>${help}</dd>`)}</dl>
  </details>
`;

const MOST_SWINGS = 40;

function rowsOf(lanes) {
  return lanes.flatMap(({ title, figures }) => figures.legs.map(({ leg, stance, duty_factor }) => {
    const swings = swingsOf(stance, figures);
    const shown = swings.slice(0, MOST_SWINGS).map(([a, b]) => `${a.toFixed(2)}–${b.toFixed(2)}`).join(", ");
    const more = swings.length > MOST_SWINGS ? ` and ${swings.length - MOST_SWINGS} more` : "";
    return [`${title}, leg ${leg}`, duty_factor.toFixed(2), shown ? `${shown}${more}` : "never"];
  }));
}
