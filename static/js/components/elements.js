// The `html` template tag, and the elements that all views share: icons, glyphs, bars, switches.
import { effect } from "@preact/signals";
import htm from "htm";
import { h } from "preact";
import { useEffect, useLayoutEffect, useRef, useState } from "preact/hooks";
import { listed, translation } from "../format.js";

/** @import { ReadonlySignal, Signal } from "@preact/signals" */
/** @import { Gait } from "../types.js" */
/** @import { ComponentChildren } from "preact" */

/** Texts between its tags, and attributes that people read, are looked up in the catalogue of the page's language. */
/** @type {ReturnType<typeof htm.bind<import("preact").VNode>>} */
export const html = translation ? translation.tagOf(h) : htm.bind(h);

const SUN = "M8 5.2a2.8 2.8 0 1 0 0 5.6 2.8 2.8 0 0 0 0-5.6";
const STRAIGHT_RAYS = "M8 1v1.6M8 13.4V15M1 8h1.6M13.4 8H15";
const SLANTED_RAYS = "M3.05 3.05l1.1 1.1M11.85 11.85l1.1 1.1M3.05 12.95l1.1-1.1M11.85 4.15l1.1-1.1";
const LINK_LEFT = "M6.6 9.4a2.6 2.6 0 0 0 3.7 0l2.4-2.4a2.6 2.6 0 0 0-3.7-3.7l-.9.9";
const LINK_RIGHT = "m1.3 2.4a2.6 2.6 0 0 0-3.7 0L3.3 9a2.6 2.6 0 0 0 3.7 3.7l.9-.9";

const PATHS = {
  play: "M5 3.2v9.6l8-4.8z",
  pause: "M4 3h3v10H4zM9 3h3v10H9z",
  stop: "M3.5 3.5h9v9h-9z",
  skip: "M3 3.2v9.6l6.5-4.8zM10.5 3h2.5v10h-2.5z",
  stepOn: "M3 3.2v9.6l4-4.8zM9 3h1.8v10H9zM12.2 3H14v10h-1.8z",
  stepBack: "M13 3.2v9.6l-4-4.8zM7 3H5.2v10H7zM3.8 3H2v10h1.8z",
  replay: "M3.2 8a4.8 4.8 0 1 0 1.6-3.6M3 2.4v3h3",
  link: `${LINK_LEFT}${LINK_RIGHT}`,
  light: `${SUN}${STRAIGHT_RAYS}${SLANTED_RAYS}`,
  dark: "M13.2 9.6A5.6 5.6 0 0 1 6.4 2.8a5.6 5.6 0 1 0 6.8 6.8z",
  auto: "M8 2.2a5.8 5.8 0 1 0 0 11.6A5.8 5.8 0 0 0 8 2.2M8 2.2v11.6M8 4.8h3.9M8 8h5.8M8 11.2h3.9",
  edit: "M3 13l.7-3L10.6 3.1l2.3 2.3L6 12.3zM9.3 4.4l2.3 2.3",
  import: "M8 2v7.5M4.8 6.5 8 9.7l3.2-3.2M2.5 11v2.5h11V11",
  present: "M2.5 3.5h11v7.5h-11zM8 11v2.5M5 13.5h6",
  flag: "M4 14V2.5h8.5L10.8 5.3l1.7 2.7H4",
  pin: "M6 2.5h4v4l2 2.5H4L6 6.5zM8 9v5",
  panel: "M2.5 3h11v10h-11zM9.5 3v10",
  columns: "M2.5 3h11v10h-11zM6.2 3v10M9.8 3v10",
  back: "M10 3 5 8l5 5",
  undo: "M5.5 3 2.5 6l3 3M2.5 6h6.5a4 4 0 0 1 0 8H6",
};
const OUTLINED = new Set([
  "link", "replay", "light", "dark", "auto", "flag", "edit", "import", "present", "pin", "panel", "columns",
  "back", "undo",
]);
const SIZE = 16;

/** An icon, drawn in the colour of the text beside it. @param {{ name: keyof typeof PATHS }} props */
export function Icon({ name }) {
  const style = OUTLINED.has(name) ? "icon outlined" : "icon";
  return html`
    <svg class=${style} viewBox=${`0 0 ${SIZE} ${SIZE}`} width=${SIZE} height=${SIZE} aria-hidden="true">
      <path d=${PATHS[name]} />
    </svg>
  `;
}

const HIP = 7.5;
const FOOT = 24;

/**
 * The point at a distance from the centre in the direction of a leg; azimuths turn anticlockwise.
 * @param {number} azimuth_deg
 * @param {number} radius
 */
export function pointAt(azimuth_deg, radius) {
  const angle = (azimuth_deg * Math.PI) / 180;
  return [-radius * Math.sin(angle), -radius * Math.cos(angle)].map((c) => c.toFixed(1));
}

/**
 * A hexapod from above, forward up. Legs that move together share a colour and are joined by a line.
 * `only`: the pair to show in colour; without it, all are.
 * @param {{ gait: Gait, only?: number | null }} props
 */
export function HexapodGlyph({ gait, only = null }) {
  const pairs = gait.pairs.map((legs, number) => {
    const feet = legs.map((leg) => pointAt(gait.azimuths_deg[leg - 1], FOOT));
    const style = only === null || only === number ? `pair pair-${(number % 6) + 1}` : "pair pair-none";
    return html`
      <g class=${style}>
        <path class="thread" d=${`M${feet.join(" L")}z`} />
        ${legs.map((leg) => html`<${Leg} azimuth=${gait.azimuths_deg[leg - 1]} />`)}
      </g>
    `;
  });
  return html`
    <svg class="glyph" viewBox="-29 -29 58 58" aria-hidden="true">
      ${pairs}
      <circle class="body" r="9" />
      <path class="forward" d="M0 -5.2 3.6 1.2 H-3.6z" />
    </svg>
  `;
}

/** @param {{ azimuth: number }} props */
function Leg({ azimuth }) {
  const foot = pointAt(azimuth, FOOT);
  return html`
    <path class="leg" d=${`M${pointAt(azimuth, HIP)} L${foot}`} />
    <circle class="foot" cx=${foot[0]} cy=${foot[1]} r="3.2" />
  `;
}

/** Why a field's text is not valid, beside the field. @param {{ id: string, children: ComponentChildren }} props */
export const Mistake = ({ id, children }) =>
  children && html`<span class="mistake" role="alert" id=${id}>${children}</span>`;

/**
 * Note on the parts of a link that the form does not know, until dismissed. `parts`: signal of texts.
 * @param {{ parts: Signal<string[]> }} props
 */
export const UnknownParts = ({ parts }) =>
  parts.value.length > 0 && html`
    <div class="notice" role="status">
      <p>The link also says ${listed(parts.value)}, which is no setting here and has no effect.</p>
      <button class="link" onClick=${() => (parts.value = [])}>Dismiss</button>
    </div>
  `;

/** Estimated duration of a start, if that is long. `words`: signal. @param {{ words: ReadonlySignal<string> }} props */
export const EstimateNote = ({ words }) => html`<p class="estimate dim" role="status">${words}</p>`;

/**
 * A dialog over the page, opened and closed by a signal; Escape and a click beside it close it too.
 * @param {object} props
 * @param {Signal<boolean>} props.isOpen
 * @param {string} props.id
 * @param {string} props.labelledBy
 * @param {string} [props.style] class
 * @param {ComponentChildren} props.children
 */
export function Dialog({ isOpen, id, labelledBy, style = "", children }) {
  const dialog = useRef(/** @type {HTMLDialogElement | null} */ (null));
  // An effect of the signal itself, at once: those of hooks wait for the next picture, and a key may
  // open the dialog again before that.
  useEffect(() => effect(() => {
    if (!isOpen.value) dialog.current?.close();
    else if (!dialog.current?.open) dialog.current?.showModal();
  }), []);
  // A pointer that went down inside, as on a slider, may come up beside it.
  const wentDown = useRef(/** @type {EventTarget | null} */ (null));
  const close = () => (isOpen.value = false);
  const onClose = () => !dialog.current?.open && close();
  /** @param {MouseEvent} event */
  const onBackdrop = ({ target }) => target === dialog.current && wentDown.current === target && close();
  return html`
    <dialog class=${`dialog ${style}`} id=${id} ref=${dialog} onClose=${onClose} onClick=${onBackdrop}
      onPointerDown=${(/** @type {PointerEvent} */ { target }) => (wentDown.current = target)}
      aria-labelledby=${labelledBy}>
      <div class="dialog-body">${children}</div>
    </dialog>
  `;
}

/** Focus a field, in whatever is folded around it. @param {string} id */
export function goToField(id) {
  const field = document.getElementById(id);
  for (let around = field?.closest("details"); around; around = around.parentElement?.closest("details")) {
    around.open = true;
  }
  field?.focus();
}

/**
 * `share` is done; `shown`, if it is told, is the part of the whole that the picture has shown.
 * @param {{ label: string, share: number, shown?: number | null }} props
 */
export const ProgressBar = ({ label, share, shown = null }) => html`
  <div class="bar" role="progressbar" aria-label=${label} aria-valuemin="0" aria-valuemax="100"
    aria-valuenow=${Math.round(100 * share)}>
    <i class=${shown === null ? "" : "computed"} style=${{ width: `${100 * share}%` }}></i>
    ${shown !== null && html`<i style=${{ width: `${100 * shown}%` }}></i>`}
  </div>
`;

/**
 * A choice of one out of a few, side by side. `choices`: [value, title].
 * @template Value
 * @param {{ label: string, choices: [Value, string][], value: Value, onValue: (value: Value) => unknown }} props
 */
export const Segments = ({ label, choices, value, onValue }) => html`
  <div class="segments" role="group" aria-label=${label}>
    ${choices.map(([choice, title]) => html`
      <button key=${choice} aria-pressed=${choice === value ? "true" : "false"} onClick=${() => onValue(choice)}>
        ${title}
      </button>
    `)}
  </div>
`;

/** The width of an element as [ref, px], 0 until it is measured. @returns {[{ current: any }, number]} */
export function useWidth() {
  /** @type {{ current: any }} */
  const host = useRef(null);
  const [width, setWidth] = useState(0);
  useLayoutEffect(() => {
    const measure = () => {
      const { width: now } = host.current.getBoundingClientRect();
      // While it is hidden it has none.
      if (now > 0) setWidth(Math.round(now));
    };
    measure();
    const watcher = new ResizeObserver(measure);
    watcher.observe(host.current);
    return () => watcher.disconnect();
  }, []);
  return [host, width];
}

// ---- a drawn hexapod, forward up, each leg of which is a button

/** Distances from the middle, of 50. */
const PICKER = { hip: 13, knee: 24, foot: 37 };

/**
 * @param {object} props
 * @param {number[]} props.azimuths of the legs from forward [°]
 * @param {Map<number, string>} props.states what happened to legs, by their numbers
 * @param {(leg: number) => void} props.onLeg
 * @param {boolean} [props.isDisabled]
 * @param {string} [props.describedBy]
 * @param {(leg: number) => string} props.verbOf what a press does to a leg: "Repair"
 */
export function LegPicker({ azimuths, states, onLeg, isDisabled = false, describedBy, verbOf }) {
  const legs = azimuths.map((azimuth, n) => ({ azimuth, leg: n + 1, state: states.get(n + 1) }));
  return html`
    <div class="leg-picker" role="group" aria-label="Legs, seen from above"
      aria-describedby=${describedBy}>
      <svg viewBox="-50 -50 100 100" aria-hidden="true">
        ${legs.map(({ azimuth, leg, state }) => html`
          <path key=${leg} class=${`drawn-leg ${classOf(state)}`}
            d=${`M${[PICKER.hip, PICKER.knee, PICKER.foot].map((radius) => pointAt(azimuth, radius)).join(" L")}`} />
        `)}
        <circle class="body" r=${PICKER.hip} /><path class="forward" d="M0-8 6 2H-6z" />
      </svg>
      ${legs.map(({ azimuth, leg, state }) => {
        const [x, y] = pointAt(azimuth, PICKER.foot).map((coordinate) => `${50 + Number(coordinate)}%`);
        return html`
          <button key=${leg} type="button" style=${{ left: x, top: y }} aria-pressed=${state ? "true" : "false"}
            aria-disabled=${isDisabled ? "true" : undefined} title=${`${verbOf(leg)} leg ${leg}`}
            aria-label=${`Leg ${leg}${state ? `, ${state}` : ""}`} onClick=${() => !isDisabled && onLeg(leg)}>
            ${leg}
          </button>
        `;
      })}
    </div>
  `;
}

/** A leg is drawn by the last thing that happened to it. @param {string | undefined} state */
export const classOf = (state) => (state ? state.split(" ").at(-1) : "");
