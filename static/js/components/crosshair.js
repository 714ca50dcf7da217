// The crosshair of a chart: follows the pointer, a finger or the arrow keys, in all charts over the same axis. A click
// or Enter seeks; a drag, two fingers, + and − zoom; a double click or 0 shows all.
import { useRef, useState } from "preact/hooks";
import {
  crosshair, indexAfter, intervalAt, movedTo, nearestIndex, pinned, readIndex, valueAt, zoomBy, zoomFactorOf,
  zoomOf, zoomTo,
} from "../chart.js";
import { t } from "../format.js";
import { percent, shareOf } from "../scale.js";
import { html } from "./elements.js";
import { cssColour } from "./line-labels.js";

/** @import { Axis, Line, Mark, Range } from "../chart.js" */

/** From this share of the width on, the values stand on the left of the crosshair. */
const FLIP_SHARE = 0.5;
/** A mouse that moves further while its button is down selects a part. */
const DRAG_PX = 6;
/** A second click within it is a double click. */
const DOUBLE_CLICK_MS = 250;

/** A drawn line or a level, as it is read. @typedef {{ name?: string, color?: string, value: string }} ReadValue */
/** @typedef {{ name: string, lines: Line[], marks: Mark[], inset: Record<string, number> }} Drawn */
/** @typedef {{ x: { text: (x: number) => string }, y: { text: (y: number) => string } }} Texts */
/** @typedef {Axis & Drawn & Texts} CrosshairProps */
/** @typedef {PointerEvent & { currentTarget: HTMLElement }} OnChart */

/** Covers the plotting area of a chart whose frame is positioned. @param {CrosshairProps} props */
export function Crosshair(props) {
  const { name, inset, xs, now, part: [low, high] } = props;
  const [selection, setSelection] = useState(/** @type {Range | null} */ (null));
  const onPointer = usePointer(props, setSelection);
  const index = readIndex(props);
  const last = xs.length - 1;
  if (last < 0) return null;
  const shown = index ?? Math.max(0, Math.min(now, last));
  const { at, values, missing } = readingOf(props, xs[shown]);
  const words = `${at}: ${missing || values.map((value) => `${value.name} ${value.value}`).join(", ")}`;
  const style = Object.fromEntries(Object.entries(inset).map(([side, px]) => [side, `${px}px`]));
  const share = shareOf(xs[shown], low, high);
  /** @param {{ currentTarget: HTMLElement }} event */
  const onFocus = ({ currentTarget }) => {
    if (index === null && currentTarget.matches(":focus-visible")) crosshair.value = { axis: props.axis, x: xs[shown] };
  };
  return html`
    <div class=${`crosshair ${props.seek ? "seeks" : ""}`} style=${style} tabindex="0" role="slider"
      aria-label=${t("Values of {chart}", { chart: name })} aria-valuemin="0" aria-valuemax=${last}
      aria-valuenow=${shown} aria-valuetext=${words} ...${onPointer} onFocus=${onFocus}
      onKeyDown=${(/** @type {KeyboardEvent} */ event) => onKey(event, props, shown)}>
      ${selection && html`<${Selection} from=${Math.min(...selection)} to=${Math.max(...selection)} />`}
      ${index !== null && html`
        <i class="line" style=${{ left: percent(share) }}></i>
        <${Readout} at=${missing ? words : at} values=${values} share=${share} isHigh=${Boolean(missing)} />
      `}
    </div>
  `;
}

/** @param {{ from: number, to: number }} props */
const Selection = ({ from, to }) => html`
  <i class="selection" style=${{ left: percent(from), right: percent(1 - to) }}></i>
`;

/**
 * Why there are no values at a position; empty where there are.
 * @param {Axis["reach"]} reach
 * @param {number} position
 */
function missingAt(reach, position) {
  if (!reach || position <= reach.shown) return "";
  return position <= reach.computed ? t("not shown yet") : t("not computed yet");
}

/**
 * Readings at a position: of each line, and of each named level; or why there are none.
 * @param {CrosshairProps} props
 * @param {number} position
 */
function readingOf({ lines, marks, x, y, reach }, position) {
  const missing = missingAt(reach, position);
  if (missing) return { at: x.text(position), values: [], missing };
  /** @param {Line} line */
  const valueOf = (line) => {
    const value = valueAt(line, position);
    const interval = intervalAt(line, position);
    if (value === null) return "–";
    return interval ? `${y.text(value)} (${interval.map(y.text).join(" – ")})` : y.text(value);
  };
  return {
    at: x.text(position),
    missing,
    values: [
      ...lines.map((line) => ({ name: line.name, color: line.color, value: valueOf(line) })),
      ...marks.filter((mark) => mark.name).map((mark) => ({ ...mark, value: y.text(mark.y ?? NaN) })),
    ],
  };
}

/** @param {KeyboardEvent} event @param {CrosshairProps} props @param {number} shown */
function onKey(event, props, shown) {
  const { axis, xs, whole, part, seek } = props;
  const { key } = event;
  if (event.ctrlKey || event.altKey || event.metaKey) return;
  const next = indexAfter(key, shown, xs.length - 1);
  const factor = zoomFactorOf(key);
  if (next !== null) {
    crosshair.value = { axis, x: xs[next] };
    if (zoomOf(axis)) zoomTo(axis, movedTo(part, xs[next]), whole);
  } else if (factor !== null) zoomBy(props, factor);
  else if (key === "Enter" && seek) seek(xs[shown]);
  else if (key === "Escape") crosshair.value = null;
  else return;
  event.preventDefault();
  // Else the page's own keys act too.
  event.stopPropagation();
}

/**
 * Where a pointer is: its share of the width, the width, and the position on the axis.
 * @param {OnChart} event
 * @param {Range} other
 */
function placeOf({ clientX, currentTarget }, [low, high]) {
  const { left, width } = currentTarget.getBoundingClientRect();
  const share = width > 0 ? Math.max(0, Math.min((clientX - left) / width, 1)) : 0;
  return { share, width, x: low + (high - low) * share };
}

/**
 * Handlers of a mouse, which reads, selects and seeks, and of fingers: one reads, and seeks ahead; two zoom.
 * @param {CrosshairProps} props
 * @param {(selection: Range | null) => void} setSelection
 */
function usePointer(props, setSelection) {
  const mouse = useMouse(props, setSelection);
  const finger = useFingers(props);
  const { axis, xs, part } = props;
  /** @param {OnChart} event */
  const read = (event) => {
    const { x } = placeOf(event, part);
    const inView = xs.filter((position) => position >= part[0] && position <= part[1]);
    const isOfMouse = event.pointerType === "mouse";
    if (inView.length) crosshair.value = { axis, x: inView[nearestIndex(inView, x)], isOfMouse };
  };
  /** @param {PointerEvent} event */
  const handlersOf = ({ pointerType }) => (pointerType === "touch" ? finger : mouse);
  return {
    /** @param {OnChart} event */
    onPointerDown(event) {
      read(event);
      handlersOf(event).down(event);
    },
    /** @param {OnChart} event */
    onPointerMove(event) {
      if (!handlersOf(event).move(event)) read(event);
    },
    onPointerUp: (/** @type {OnChart} */ event) => handlersOf(event).up(event),
    onPointerCancel: (/** @type {OnChart} */ event) => handlersOf(event).cancel(event),
    onPointerLeave() {
      // A reading by keys or a finger stays until something else has the focus.
      if (crosshair.peek()?.isOfMouse) crosshair.value = null;
    },
    onDblClick: mouse.double,
  };
}

/** @param {Axis} axis @param {(selection: Range | null) => void} setSelection */
function useMouse({ axis, whole, part, seek }, setSelection) {
  const press = useRef(/** @type {{ x: number, share: number, isDrag: boolean } | null} */ (null));
  const timer = useRef(/** @type {ReturnType<typeof setTimeout> | undefined} */ (undefined));
  /** @param {number} x */
  const click = (x) => {
    clearTimeout(timer.current);
    // Of what is zoomed, a double click shows all and does not seek.
    if (seek) timer.current = setTimeout(() => seek(x), zoomOf(axis) ? DOUBLE_CLICK_MS : 0);
  };
  const cancel = () => {
    press.current = null;
    setSelection(null);
  };
  return {
    cancel,
    /** @param {OnChart} event */
    down(event) {
      if (event.button !== 0) return;
      event.currentTarget.setPointerCapture(event.pointerId);
      press.current = { ...placeOf(event, part), isDrag: false };
    },
    /** @param {OnChart} event */
    move(event) {
      const from = press.current;
      if (!from) return false;
      const { share, width } = placeOf(event, part);
      from.isDrag ||= Math.abs(share - from.share) * width > DRAG_PX;
      if (from.isDrag) setSelection([from.share, share]);
      return false;
    },
    /** @param {OnChart} event */
    up(event) {
      const from = press.current;
      cancel();
      if (!from) return;
      const { x } = placeOf(event, part);
      if (from.isDrag) zoomTo(axis, [from.x, x], whole);
      else click(x);
    },
    double() {
      clearTimeout(timer.current);
      zoomTo(axis, null, whole);
    },
  };
}

/** @param {Axis} axis */
function useFingers({ axis, whole, part, seek, reach }) {
  const fingers = useRef(/** @type {Map<number, { x: number, share: number }>} */ (new Map()));
  const hasZoomed = useRef(false);
  /** @param {PointerEvent} event */
  const lift = ({ pointerId }) => fingers.current.delete(pointerId);
  return {
    /** Where nothing is to be read yet but can be shown, a finger seeks. @param {OnChart} event */
    up(event) {
      lift(event);
      const { x } = placeOf(event, part);
      if (hasZoomed.current || !seek || !reach || x <= reach.shown || x > reach.computed) return;
      crosshair.value = null;
      seek(x);
    },
    cancel: lift,
    /** @param {OnChart} event */
    down(event) {
      if (!fingers.current.size) hasZoomed.current = false;
      fingers.current.set(event.pointerId, placeOf(event, part));
    },
    /** Whether two fingers zoom, which reads nothing. @param {OnChart} event */
    move(event) {
      const moved = fingers.current.get(event.pointerId);
      if (moved) moved.share = placeOf(event, part).share;
      const [first, other] = [...fingers.current.values()];
      if (!other) return false;
      hasZoomed.current = true;
      zoomTo(axis, pinned([first.x, other.x], [first.share, other.share]), whole);
      return true;
    },
  };
}

/** @param {{ at: string, values: ReadValue[], share: number, isHigh: boolean }} props */
function Readout({ at, values, share, isHigh }) {
  // Beside the crosshair, on the side with more room and no wider than that.
  const side = share < FLIP_SHARE
    ? { left: percent(share), maxWidth: percent(1 - share) }
    : { right: percent(1 - share), maxWidth: percent(share) };
  return html`
    <div class=${`readout num ${isHigh ? "high" : ""}`} style=${side} aria-hidden="true">
      <p class="dim">${at}</p>
      ${values.map(({ name, color, value }) => html`
        <p>
          ${color && html`<span class="swatch" style=${{ "--agent": cssColour(color) }}></span>`}${name} <b>${value}</b>
        </p>
      `)}
    </div>
  `;
}
