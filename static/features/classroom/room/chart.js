// The chart of questions on which one points or draws: distance against steps of practice.
import { useRef, useState } from "preact/hooks";
import { html } from "../../../js/components/elements.js";
import { count, fixed, metres, t, whole } from "../../../js/format.js";
import { shareOf, ticks } from "../../../js/scale.js";

/** @import { ControlProps } from "./questions.js" */

/** Distances that the chart shows [m]. */
export const [LOWEST_M, HIGHEST_M] = [-0.1, 0.8];
/** Points of a drawn curve. */
export const KNOTS = 9;
const STEP_M = 0.02;
const DEFAULT_STEPS = 500;

/** The steps of the practice that a card runs. @param {{ state?: any }} card */
export function stepsOf({ state }) {
  const steps = Number(state?.form?.steps);
  return steps > 0 ? steps : DEFAULT_STEPS;
}

/** A distance that the chart can show, to the centimetre. @param {number} value */
export const onChart = (value) =>
  Math.round(100 * Math.min(Math.max(value, LOWEST_M), HIGHEST_M)) / 100;

/**
 * The point of the chart at a share of its width and height, from its upper left corner.
 * @param {number} across @param {number} down @param {number} steps
 * @returns {[number, number]}
 */
export const pointAt = (across, down, steps) => [
  Math.round(Math.min(Math.max(across, 0), 1) * steps),
  onChart(HIGHEST_M - Math.min(Math.max(down, 0), 1) * (HIGHEST_M - LOWEST_M)),
];

/** Where a point lies, as shares of the width and the height. @param {number[]} point @param {number} steps */
export const placeOf = ([x, y], steps) => [shareOf(x, 0, steps), 1 - shareOf(y, LOWEST_M, HIGHEST_M)];

/** The steps at which a drawn curve has its points. @param {number} steps */
export const knotsOf = (steps) => Array.from({ length: KNOTS }, (_, n) => Math.round((n * steps) / (KNOTS - 1)));

/**
 * A curve after a stroke from one point to another: the points between them lie on the stroke; those that were not
 * drawn yet have the height of its end.
 * @param {number[] | null} heights of the points; null before the first stroke
 * @param {[number, number]} from
 * @param {[number, number]} to
 * @param {number} steps
 */
export function drawn(heights, from, to, steps) {
  const before = heights ?? knotsOf(steps).map(() => to[1]);
  const [first, last] = from[0] <= to[0] ? [from, to] : [to, from];
  const half = steps / (KNOTS - 1) / 2;
  return knotsOf(steps).map((x, n) => {
    if (x < first[0] - half || x > last[0] + half) return before[n];
    const share = last[0] > first[0] ? Math.min(Math.max((x - first[0]) / (last[0] - first[0]), 0), 1) : 1;
    return onChart(first[1] + share * (last[1] - first[1]));
  });
}

/**
 * A curve after a key, and the number of the point that is chosen.
 * @param {string} key
 * @param {number[] | null} heights
 * @param {number} chosen
 * @returns {{ heights: number[] | null, chosen: number } | null} null for any other key
 */
export function afterKey(key, heights, chosen) {
  const moves = /** @type {Record<string, number>} */ ({ ArrowLeft: -1, ArrowRight: 1 });
  if (key in moves) return { heights, chosen: Math.min(Math.max(chosen + moves[key], 0), KNOTS - 1) };
  const changes = /** @type {Record<string, number>} */ (
    { ArrowUp: STEP_M, ArrowDown: -STEP_M, PageUp: 5 * STEP_M, PageDown: -5 * STEP_M });
  if (!(key in changes)) return null;
  const before = heights ?? Array.from({ length: KNOTS }, () => 0);
  return { heights: before.map((y, n) => (n === chosen ? onChart(y + changes[key]) : y)), chosen };
}

/** The marks of both axes. @param {number} steps */
export const marksOf = (steps) => ({
  xs: ticks(steps, 4), ys: ticks(HIGHEST_M, 4, 0),
});

/** A point in words. @param {number[]} point */
export const inWords = ([x, y]) => t("{distance} after {steps} {steps|step|steps}", { distance: metres(y), steps: x });

// ---- how it is drawn

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
      <text class="mark-text" x=${LEFT - 6} y=${placed([0, y], steps)[1] + 4} text-anchor="end">${fixed(y, 1)}</text>
    `)}
    ${xs.map((x) => html`
      <text class="mark-text" x=${placed([x, 0], steps)[0]} y=${HEIGHT - 6}
        text-anchor=${x === xs.at(-1) ? "end" : "middle"}>${x === xs.at(-1) ? count(x, "step") : whole(x)}</text>
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

/** @param {ControlProps} props */
export function Point({ card, locked, draft, onValue, actual }) {
  const steps = stepsOf(card);
  const shown = locked ?? draft;
  const isOpen = locked === undefined;
  const at = shown && placed(shown, steps);
  const [x, y] = shown ?? [Math.round(steps / 2), 0];
  const take = (/** @type {any} */ event) => isOpen && (event.type === "pointerdown" || event.buttons) &&
    onValue(pointOf(event, steps));
  return html`
    <svg class=${`draw-chart ${isOpen ? "open" : ""}`} viewBox=${`0 0 ${WIDTH} ${HEIGHT}`} role="img"
      aria-label=${shown ? t("Your point: {point}", { point: inWords(shown) }) : t("No point yet")}
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
    <p class="dim">${shown ? t("Your point: {point}", { point: inWords(shown) }) : t("Tap where you expect it.")}</p>
  `;
}

/** @param {ControlProps} props */
export function Curve({ card, locked, draft, onValue, actual }) {
  const steps = stepsOf(card);
  const isOpen = locked === undefined;
  /** @type {number[] | null} */
  const heights = locked?.map((/** @type {number[]} */ [, y]) => y) ?? draft ?? null;
  const [chosen, pen] = usePen(heights, steps, onValue);
  const closed = { role: "img", "aria-label": heights ? t("Your curve, drawn") : t("Your curve, not drawn") };
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
      ${isOpen && !points ? t("Draw with a finger from left to right, or with the arrow keys.")
        : t("Your curve")}
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
    "aria-label": t("Your curve: left and right choose a step, up and down its distance"),
    "aria-valuemin": LOWEST_M, "aria-valuemax": HIGHEST_M, "aria-valuenow": here[1], "aria-valuetext": inWords(here),
  }];
}
