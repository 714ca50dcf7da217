// The plan of a body from above, forward up: torso, legs with their feet at home, and foot grids. Its legs are moved by
// a pointer or by keys.
import { useRef } from "preact/hooks";
import {
  body, chooseLeg, chosenLeg, endChange, followerOf, impossibleAt, moveBy, moveTo, previewAnswer,
} from "../body-editor.js";
import { drawnLeg, extentOf, isBox, numbersOf, partsOf, sharedPart } from "../body.js";
import { metres } from "../../../js/format.js";
import { html } from "../../../js/components/elements.js";

/** @import { Body, Point } from "../body.js" */
/** @import { Preview } from "../../../js/types.js" */

/** From the middle of the drawing to its edge. */
const EDGE = 100;
/** Of a step by keys [m, °], and of a small one. */
const STEPS = { far: { place_m: 0.005, turn_deg: 5 }, near: { place_m: 0.001, turn_deg: 1 } };
/** @type {Record<string, [string, number]>} */
const KEYS = {
  ArrowRight: ["x_m", 1], ArrowLeft: ["x_m", -1], ArrowUp: ["y_m", 1], ArrowDown: ["y_m", -1],
  PageUp: ["yaw_deg", 1], PageDown: ["yaw_deg", -1],
};
const COLORS = 6;

/** A pointer that comes up closer than this to where it went down has moved nothing [px]. */
const SLACK_PX = 4;

/**
 * A leg that is dragged, where it was, where the pointer went down, and the leg that follows.
 * @typedef {object} Drag
 * @property {number} leg
 * @property {Record<string, number>} from
 * @property {number} x
 * @property {number} y
 * @property {number | null} mirror
 * @property {boolean} hasBegun
 */

export function BodyPlan() {
  const now = /** @type {Body} */ (body.value);
  const frame = useRef(/** @type {HTMLDivElement | null} */ (null));
  const drag = useRef(/** @type {Drag | null} */ (null));
  const extent = useRef(0);
  // While a leg is dragged the scale stays as it is.
  if (!drag.current || !extent.current) extent.current = extentOf(now);
  const half_m = extent.current;

  /** @type {(leg: number, event: PointerEvent & { currentTarget: Element }) => void} */
  const onDown = (leg, { button, pointerId, clientX, clientY, currentTarget }) => {
    if (button !== 0) return;
    currentTarget.setPointerCapture(pointerId);
    chooseLeg(leg);
    endChange();
    drag.current = { leg, from: partsOf(now, leg), x: clientX, y: clientY, mirror: followerOf(leg), hasBegun: false };
  };
  /** @param {PointerEvent} event */
  const onMove = ({ clientX, clientY }) => {
    if (!drag.current || !frame.current) return;
    const { leg, from, x, y, mirror } = drag.current;
    drag.current.hasBegun ||= Math.hypot(clientX - x, clientY - y) >= SLACK_PX;
    if (!drag.current.hasBegun) return;
    const metresPerPixel = (2 * half_m) / frame.current.getBoundingClientRect().width;
    moveTo(leg, {
      x_m: from.x_m + (clientX - x) * metresPerPixel, y_m: from.y_m - (clientY - y) * metresPerPixel,
    }, mirror);
  };
  const onUp = () => {
    drag.current = null;
    endChange();
  };

  return html`
    <div class="body-plan" ref=${frame} role="application" aria-label="Plan of the robot from above, forward up">
      <${Drawing} shown=${now} half_m=${half_m} preview=${previewAnswer.value?.preview ?? null} />
      ${numbersOf(now).map((leg) => html`
        <${Mount} key=${leg} shown=${now} leg=${leg} half_m=${half_m} onMove=${onMove} onUp=${onUp}
          onDown=${(/** @type {any} */ event) => onDown(leg, event)} />
      `)}
    </div>
  `;
}

/** The colour of a leg by its group; none while the groups are not known. @param {number} leg */
const styleOf = (leg) => {
  const group = previewAnswer.value?.preview.legs[leg - 1]?.group;
  return group === undefined ? "pair-none" : `pair-${(group % COLORS) + 1}`;
};

/** A leg in words. @type {(shown: Body, leg: number) => string} */
function inWords(shown, leg) {
  const { x_m, y_m, yaw_deg } = partsOf(shown, leg);
  const group = previewAnswer.value?.preview.legs[leg - 1]?.group;
  const ofGroup = group === undefined ? "" : ` of group ${group + 1}`;
  const place = `${Math.abs(x_m)} m ${x_m < 0 ? "left" : "right"}, ${Math.abs(y_m)} m ${y_m < 0 ? "behind" : "ahead"}`;
  const words = impossibleAt(leg);
  return `Leg ${leg}${ofGroup}: ${place}, points to ${yaw_deg}°${words && `. Impossible: ${words}`}`;
}

/**
 * The number of a leg at its coxa joint, to be moved.
 * @param {object} props
 * @param {Body} props.shown
 * @param {number} props.leg
 * @param {number} props.half_m
 * @param {(event: PointerEvent) => void} props.onDown
 * @param {(event: PointerEvent) => void} props.onMove
 * @param {() => void} props.onUp
 */
function Mount({ shown, leg, half_m, onDown, onMove, onUp }) {
  const { mount: [x, y] } = drawnLeg(shown, leg);
  /** @param {KeyboardEvent} event */
  const onKeyDown = (event) => {
    const [field, sign] = KEYS[event.key] ?? [];
    if (!field || !sign || event.ctrlKey || event.altKey || event.metaKey) return;
    event.preventDefault();
    const { place_m, turn_deg } = event.shiftKey ? STEPS.near : STEPS.far;
    moveBy(leg, { [field]: sign * (field === "yaw_deg" ? turn_deg : place_m) });
  };
  const isChosen = chosenLeg.value === leg;
  return html`
    <button class=${`mount ${styleOf(leg)} ${impossibleAt(leg) ? "impossible" : ""}`}
      style=${{ left: `${50 + (50 * x) / half_m}%`, top: `${50 - (50 * y) / half_m}%` }}
      aria-pressed=${isChosen ? "true" : "false"} aria-label=${inWords(shown, leg)}
      onFocus=${() => chooseLeg(leg)} onClick=${() => chooseLeg(leg)} onKeyDown=${onKeyDown}
      onPointerDown=${onDown} onPointerMove=${onMove} onPointerUp=${onUp} onLostPointerCapture=${onUp}>
      ${leg}
    </button>
  `;
}

/** @param {{ shown: Body, half_m: number, preview: Preview | null }} props */
function Drawing({ shown, half_m, preview }) {
  const scale = EDGE / half_m;
  /** @param {Point} point */
  const at = ([right, ahead]) => `${(scale * right).toFixed(1)} ${(-scale * ahead).toFixed(1)}`;
  // The gait's forward direction as it is now, clockwise from up.
  const forward = preview ? shown.up_deg - preview.forward_deg : 0;
  return html`
    <svg viewBox=${`${-EDGE} ${-EDGE} ${2 * EDGE} ${2 * EDGE}`} aria-hidden="true">
      <${Torso} shown=${shown} scale=${scale} />
      <path class="forward" d="M0 -9 5 2 H-5z" transform=${`rotate(${forward})`} />
      ${numbersOf(shown).map((leg) => {
        const { mount, coxa, foot } = drawnLeg(shown, leg);
        return html`
          <g key=${leg} class=${`${styleOf(leg)} ${leg === chosenLeg.value ? "chosen" : ""}`}>
            ${preview && html`<${Grid} at=${at(foot)} cells=${preview.cells_m} scale=${scale} forward=${forward} />`}
            <path class="leg" d=${`M${at(mount)}L${at(foot)}`} />
            <path class="coxa" d=${`M${at(mount)}L${at(coxa)}`} />
            <circle class="foot" r="3" transform=${`translate(${at(foot)})`} />
          </g>
        `;
      })}
      <${Ruler} scale=${scale} />
    </svg>
  `;
}

/** @param {{ shown: Body, scale: number }} props */
function Torso({ shown, scale }) {
  const size = (/** @type {string} */ field) => scale * (sharedPart(shown, field) ?? 0);
  if (!isBox(shown)) return html`<circle class="torso" r=${size("torso_radius_m")} />`;
  const [width, length] = [size("torso_width_m"), size("torso_length_m")];
  return html`
    <rect class="torso" x=${-width / 2} y=${-length / 2} width=${width} height=${length} rx="4"
      transform=${`rotate(${shown.up_deg - 90})`} />
  `;
}

/**
 * The cells to which a foot may go.
 * @param {{ at: string, cells: number[][], scale: number, forward: number }} props
 */
function Grid({ at, cells, scale, forward }) {
  const half = scale * Math.max(...cells.flat().map(Math.abs));
  return html`
    <g class="grid" transform=${`translate(${at}) rotate(${forward})`}>
      <rect x=${-half} y=${-half} width=${2 * half} height=${2 * half} />
      ${cells.map(([right, ahead]) => html`<circle r="1.2" cx=${scale * right} cy=${-scale * ahead} />`)}
    </g>
  `;
}

const RULER_M = 0.1;

/** How long a tenth of a metre is. @param {{ scale: number }} props */
const Ruler = ({ scale }) => html`
  <g class="ruler" transform=${`translate(${-EDGE + 6} ${EDGE - 6})`}>
    <path d=${`M0 -3V0H${scale * RULER_M}V-3`} /><text x=${scale * RULER_M + 3}>${metres(RULER_M)}</text>
  </g>
`;
