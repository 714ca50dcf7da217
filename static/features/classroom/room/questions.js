// The question of a card by its kind: a choice, a number, a point on a chart, a curve that is drawn.
import { signal } from "@preact/signals";
import { useRef, useState } from "preact/hooks";
import { html } from "../../../js/components/elements.js";
import { metres, whole } from "../../../js/format.js";
import { parseNumber } from "../../../js/parse.js";
import { agentOf, rangeOf } from "../../../js/settings.js";
import { setEntry } from "../../../js/store.js";
import { afterKey, drawn, HIGHEST_M, inWords, knotsOf, LOWEST_M, marksOf, placeOf, pointAt, stepsOf } from "./chart.js";

/** @import { Signal } from "@preact/signals" */
/** @import { Ask, LessonCard } from "../../../js/types.js" */

/** Card → what is chosen, typed or drawn, and not locked yet. @type {Signal<Record<string, any>>} */
const drafts = signal({});

const MOST = 1e9;

/** Limits of a number. @param {Ask} ask */
const limitsOf = ({ minimum, maximum }) => ({
  minimum: minimum ?? -MOST, maximum: maximum ?? MOST, excludes_minimum: false, excludes_maximum: false,
});

/**
 * What would be locked; undefined as long as that is no answer.
 * @param {LessonCard} card
 * @param {number} number
 */
export function draftOf(card, number) {
  const draft = drafts.value[`${number}`];
  if (draft === undefined || !card.ask) return undefined;
  if (card.ask.kind === "number") return parseNumber(draft, limitsOf(card.ask), false).value;
  if (card.ask.kind === "curve") {
    return knotsOf(stepsOf(card)).map((x, n) => [x, draft[n]]);
  }
  return draft;
}

/** An answer in words. @param {Ask} ask @param {any} value */
export function answerInWords({ kind, unit }, value) {
  if (kind === "number") return unit === "m" ? metres(value) : [value, unit].filter(Boolean).join("\u00a0");
  if (kind === "point") return inWords(value);
  if (kind === "curve") return `from ${metres(value[0][1])} to ${metres(value.at(-1)[1])}`;
  // The name of an agent stands for its win.
  return agentOf(String(value)).title;
}

/**
 * The control of a question; a chart shows the answer also once it is locked, beside what came of it.
 * @param {object} props
 * @param {LessonCard} props.card
 * @param {number} props.number
 * @param {any} props.locked the locked answer; undefined before
 * @param {number[][]} [props.actual] the learning curve of the own run
 */
export function Answer({ card, number, locked, actual = [] }) {
  const { ask } = /** @type {{ ask: Ask }} */ (card);
  const onValue = (/** @type {any} */ value) => setEntry(drafts, `${number}`, value);
  const draft = drafts.value[`${number}`];
  if (ask.kind === "choice") return html`<${Choice} ask=${ask} locked=${locked} draft=${draft} onValue=${onValue} />`;
  if (ask.kind === "number") {
    return locked === undefined
      ? html`<${NumberAnswer} ask=${ask} draft=${draft ?? ""} onValue=${onValue} />`
      : html`<p class="locked-answer">${answerInWords(ask, locked)}</p>`;
  }
  const props = { steps: stepsOf(card), locked, draft, onValue, actual };
  return ask.kind === "point" ? html`<${Point} ...${props} />` : html`<${Curve} ...${props} />`;
}

/** @param {{ ask: Ask, locked: any, draft: any, onValue: (value: string) => unknown }} props */
const Choice = ({ ask, locked, draft, onValue }) => html`
  <div class="choices" role="group" aria-label="Your prediction">
    ${(ask.choices ?? []).map((choice) => html`
      <button key=${choice} class="choice-chip" aria-pressed=${(locked ?? draft) === choice ? "true" : "false"}
        disabled=${locked !== undefined} onClick=${() => onValue(choice)}>${agentOf(choice).title}</button>
    `)}
  </div>
`;

/** @param {{ ask: Ask, draft: string, onValue: (text: string) => unknown }} props */
function NumberAnswer({ ask, draft, onValue }) {
  const limits = limitsOf(ask);
  const { mistake } = draft.trim() ? parseNumber(draft, limits, false) : { mistake: undefined };
  const isLimited = ask.minimum !== null && ask.minimum !== undefined;
  const range = isLimited ? `${rangeOf(limits)}${ask.unit ? ` ${ask.unit}` : ""}` : "";
  return html`
    <div class="number-answer">
      <label for="answer">Your prediction</label>
      <span>
        <input id="answer" type="text" inputmode="decimal" autocomplete="off" value=${draft}
          aria-invalid=${mistake ? "true" : undefined} aria-describedby="answer-range"
          onInput=${(/** @type {any} */ { target }) => onValue(target.value)} />
        ${ask.unit && html`<b>${ask.unit}</b>`}
      </span>
      <p id="answer-range" class=${mistake ? "bad" : "dim"} role=${mistake ? "alert" : undefined}>
        ${mistake ?? range.replaceAll("-", "\u2212")}
      </p>
    </div>
  `;
}

// ---- charts: distance against steps of practice

/** Size of the drawing; the picture is scaled to the width that there is. */
const [WIDTH, HEIGHT, LEFT, BOTTOM] = [340, 200, 44, 26];

/** @param {number[]} point @param {number} steps */
const placed = (point, steps) => {
  const [across, down] = placeOf(point, steps);
  return [LEFT + across * (WIDTH - LEFT - 8), 8 + down * (HEIGHT - BOTTOM - 8)];
};

/** @param {number[][]} points @param {number} steps */
export const lineOf = (points, steps) => points.map((point) => placed(point, steps).join(" ")).join(" L");

/** The axes with their numbers. @param {{ steps: number }} props */
export function Axes({ steps }) {
  const { xs, ys } = marksOf(steps);
  return html`
    ${ys.map((y) => html`
      <line class="grid" x1=${LEFT} x2=${WIDTH - 8} y1=${placed([0, y], steps)[1]} y2=${placed([0, y], steps)[1]} />
      <text class="mark-text" x=${LEFT - 6} y=${placed([0, y], steps)[1] + 4} text-anchor="end">${y.toFixed(1)}</text>
    `)}
    ${xs.map((x) => html`
      <text class="mark-text" x=${placed([x, 0], steps)[0]} y=${HEIGHT - 6}
        text-anchor=${x === xs.at(-1) ? "end" : "middle"}>${x === xs.at(-1) ? `${whole(x)} steps` : whole(x)}</text>
    `)}
    <text class="mark-text" x=${LEFT + 4} y="16">distance in m</text>
  `;
}

/** @param {PointerEvent} event @param {number} steps */
function pointOf({ currentTarget, clientX, clientY }, steps) {
  const box = /** @type {Element} */ (currentTarget).getBoundingClientRect();
  const x = ((clientX - box.left) / box.width) * WIDTH;
  const y = ((clientY - box.top) / box.height) * HEIGHT;
  return pointAt((x - LEFT) / (WIDTH - LEFT - 8), (y - 8) / (HEIGHT - BOTTOM - 8), steps);
}

/**
 * @typedef {object} ChartProps
 * @property {number} steps
 * @property {any} locked
 * @property {any} draft
 * @property {(value: any) => unknown} onValue
 * @property {number[][]} actual
 */

/** @param {ChartProps} props */
function Point({ steps, locked, draft, onValue, actual }) {
  const shown = locked ?? draft;
  const isOpen = locked === undefined;
  const at = shown && placed(shown, steps);
  const [x, y] = shown ?? [Math.round(steps / 2), 0];
  const take = (/** @type {any} */ event) => isOpen && (event.type === "pointerdown" || event.buttons) &&
    onValue(pointOf(event, steps));
  return html`
    <svg class=${`draw-chart ${isOpen ? "open" : ""}`} viewBox=${`0 0 ${WIDTH} ${HEIGHT}`} role="img"
      aria-label=${shown ? `Your point: ${inWords(shown)}` : "No point yet"}
      onPointerDown=${take} onPointerMove=${take}>
      <${Axes} steps=${steps} />
      ${actual.length > 1 && html`<path class="actual" d=${`M${lineOf(actual, steps)}`} />`}
      ${at && html`<circle class="own-point" cx=${at[0]} cy=${at[1]} r="8" />`}
    </svg>
    ${isOpen && html`
      <div class="point-sliders">
        <label>Steps of practice
          <input type="range" min="0" max=${steps} step=${Math.max(1, Math.round(steps / 50))} value=${x}
            onInput=${(/** @type {any} */ { target }) => onValue([Number(target.value), y])} /></label>
        <label>Distance in metres
          <input type="range" min=${LOWEST_M} max=${HIGHEST_M} step="0.01" value=${y}
            onInput=${(/** @type {any} */ { target }) => onValue([x, Number(target.value)])} /></label>
      </div>
    `}
    <p class="dim">${shown ? `Your point: ${inWords(shown)}` : "Tap where you expect it."}</p>
  `;
}

/** @param {ChartProps} props */
function Curve({ steps, locked, draft, onValue, actual }) {
  const isOpen = locked === undefined;
  /** @type {number[] | null} */
  const heights = locked?.map((/** @type {number[]} */ [, y]) => y) ?? draft ?? null;
  const [chosen, pen] = usePen(heights, steps, onValue);
  const closed = { role: "img", "aria-label": `Your curve, ${heights ? "drawn" : "not drawn"}` };
  const points = heights && knotsOf(steps).map((x, n) => [x, heights[n]]);
  return html`
    <svg class=${`draw-chart ${isOpen ? "open" : ""}`} viewBox=${`0 0 ${WIDTH} ${HEIGHT}`} ...${isOpen ? pen : closed}>
      <${Axes} steps=${steps} />
      ${actual.length > 1 && html`<path class="actual" d=${`M${lineOf(actual, steps)}`} />`}
      ${points && html`<path class="own-curve" d=${`M${lineOf(points, steps)}`} />`}
      ${isOpen && points?.map((point, n) => html`
        <circle class=${`knot ${n === chosen ? "chosen" : ""}`} cx=${placed(point, steps)[0]}
          cy=${placed(point, steps)[1]} r="4" />
      `)}
    </svg>
    <p class="dim">
      ${isOpen && !points ? "Draw with a finger from left to right, or with the arrow keys." : "Your curve"}
      ${actual.length > 1 && html` · <span class="actual-key">your robot</span>`}
    </p>
  `;
}

/**
 * Draw a curve by a pointer, or by keys as a slider: the number of the chosen point, and the attributes of the chart.
 * @param {number[] | null} heights
 * @param {number} steps
 * @param {(heights: number[]) => unknown} onValue
 * @returns {[number, object]}
 */
function usePen(heights, steps, onValue) {
  const last = useRef(/** @type {[number, number] | null} */ (null));
  const [chosen, setChosen] = useState(0);
  const stroke = (/** @type {any} */ event) => {
    if (event.type === "pointerdown") event.currentTarget.setPointerCapture(event.pointerId);
    else if (!last.current) return;
    const to = pointOf(event, steps);
    onValue(drawn(heights, last.current ?? to, to, steps));
    last.current = to;
  };
  /** @param {KeyboardEvent} event */
  const onKeyDown = (event) => {
    const after = afterKey(event.key, heights, chosen);
    if (!after) return;
    event.preventDefault();
    setChosen(after.chosen);
    if (after.heights) onValue(after.heights);
  };
  const lift = () => (last.current = null);
  const here = [knotsOf(steps)[chosen], heights?.[chosen] ?? 0];
  return [chosen, {
    role: "slider", tabindex: 0, onKeyDown,
    onPointerDown: stroke, onPointerMove: stroke, onPointerUp: lift, onPointerCancel: lift,
    "aria-label": "Your curve: left and right choose a step, up and down its distance",
    "aria-valuemin": LOWEST_M, "aria-valuemax": HIGHEST_M, "aria-valuenow": here[1], "aria-valuetext": inWords(here),
  }];
}
