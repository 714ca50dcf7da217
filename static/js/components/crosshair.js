// The values of a chart at a crosshair, which follows the pointer, a finger, or the arrow keys.
import { useState } from "preact/hooks";
import { percent, shareOf } from "../scale.js";
import { html } from "./elements.js";

/** A line's value at the crosshair. @typedef {{ name: string, color?: string, value: string }} ReadValue */

const PAGE_KEY_STEP = 10;
/** From this share of the width on, the values stand on the left of the crosshair. */
const FLIP_SHARE = 0.5;

/** @type {Record<string, (at: number, last: number) => number>} */
const KEYS = {
  ArrowLeft: (at) => at - 1,
  ArrowRight: (at) => at + 1,
  ArrowDown: (at) => at - 1,
  ArrowUp: (at) => at + 1,
  PageDown: (at) => at - PAGE_KEY_STEP,
  PageUp: (at) => at + PAGE_KEY_STEP,
  Home: () => 0,
  End: (_, last) => last,
};

/**
 * The index of the nearest of ascending positions.
 * @param {number[]} xs
 * @param {number} x
 */
export const nearestIndex = (xs, x) =>
  xs.reduce((best, one, n) => (Math.abs(one - x) < Math.abs(xs[best] - x) ? n : best), 0);

/**
 * Covers the plotting area of a chart whose frame is positioned.
 * @param {object} props
 * @param {string} props.label
 * @param {number[]} props.xs where there are values, ascending
 * @param {number} props.low where the axis begins
 * @param {number} props.high where it ends
 * @param {{ left: number, right: number, top: number, bottom: number }} props.inset of the area in the frame [px]
 * @param {(index: number) => { at: string, values: ReadValue[] }} props.read
 */
export function Crosshair({ label, xs, low, high, inset, read }) {
  const [chosen, setChosen] = useState(/** @type {number | null} */ (null));
  const last = xs.length - 1;
  if (last < 0) return null;
  const index = Math.min(chosen ?? last, last);
  const { at, values } = read(index);

  const onPointer = ({ clientX, currentTarget }) => {
    const { left, width } = currentTarget.getBoundingClientRect();
    if (width > 0) setChosen(nearestIndex(xs, low + ((high - low) * (clientX - left)) / width));
  };
  const onLeave = ({ pointerType, currentTarget }) => {
    // A finger that is lifted leaves the values until something else is touched.
    if (pointerType === "mouse" && document.activeElement !== currentTarget) setChosen(null);
  };
  const onKeyDown = (event) => {
    if (event.key === "Escape") setChosen(null);
    const move = KEYS[event.key];
    if (!move || event.ctrlKey || event.altKey || event.metaKey) return;
    event.preventDefault();
    setChosen(Math.max(0, Math.min(move(index, last), last)));
  };

  const share = shareOf(xs[index], low, high);
  const style = Object.fromEntries(Object.entries(inset).map(([side, px]) => [side, `${px}px`]));
  const words = `${at}: ${values.map(({ name, value }) => `${name} ${value}`).join(", ")}`;
  return html`
    <div class="crosshair" style=${style} tabindex="0" role="slider" aria-label=${label}
      aria-valuemin="0" aria-valuemax=${last} aria-valuenow=${index} aria-valuetext=${words}
      onPointerMove=${onPointer} onPointerDown=${onPointer} onPointerLeave=${onLeave} onKeyDown=${onKeyDown}
      onFocus=${() => setChosen((now) => now ?? last)} onBlur=${() => setChosen(null)}>
      ${chosen !== null && html`
        <i style=${{ left: percent(share) }}></i>
        <${Readout} at=${at} values=${values} share=${share} />
      `}
    </div>
  `;
}

function Readout({ at, values, share }) {
  // Beside the crosshair, on the side with more room and no wider than that.
  const side = share < FLIP_SHARE
    ? { left: percent(share), maxWidth: percent(1 - share) }
    : { right: percent(1 - share), maxWidth: percent(share) };
  return html`
    <div class="readout num" style=${side} aria-hidden="true">
      <p class="dim">${at}</p>
      ${values.map(({ name, color, value }) => html`
        <p>${color && html`<span class="swatch" style=${{ "--agent": color }}></span>`}${name} <b>${value}</b></p>
      `)}
    </div>
  `;
}
