// What stands over the picture of a robot that is read: the arrow forward, numbers of legs, possible feet, and a tag
// for each guess.
import { useEffect, useRef } from "preact/hooks";
import { html, Icon, Segments } from "../../../js/components/elements.js";
import { places } from "../../../js/page.js";
import {
  chooseForward, clickMode, draggedAngle, feetChosen, followInspecting, groupOf, hasRoomForTags, isMet, isTurning,
  layerPlaces, legFeet, nextGroup, pictureSize, possibleFeet, shownNote, tags, toggleFoot, toggleTurning, turnBy,
  wantedForward,
} from "../inspecting.js";
import { asDecision, directionInWords, offerInWords } from "../reading-choices.js";
import { decide, extent, isReading, reading } from "../reading.js";
import { arrowTips, nearestAngle, STEP_DEG } from "../sketch-geometry.js";
import { boxOf, columnsOf, lineEnd, TAG } from "../tags.js";

/** @import { LayerPlaces } from "../inspecting.js" */
/** @import { Tag } from "../tags.js" */

const COLORS = 6;
/** @type {Record<string, string>} */
const MODES = { groups: "Click a leg: its group changes.", feet: "Click a link: it is a foot, or no more." };

export function ReadingOverlay() {
  const overlay = useRef(/** @type {HTMLElement | null} */ (null));
  useEffect(followInspecting, []);
  useEffect(() => {
    const element = /** @type {HTMLElement} */ (overlay.current);
    const measure = () => {
      const { clientWidth: width, clientHeight: height } = element;
      const before = pictureSize.peek();
      if (width !== before.width || height !== before.height) pictureSize.value = { width, height };
    };
    measure();
    const watcher = new ResizeObserver(measure);
    watcher.observe(element);
    const stop = followMeeting(/** @type {HTMLElement} */ (element.parentElement));
    return () => {
      watcher.disconnect();
      stop();
    };
  }, []);
  const at = layerPlaces.value;
  return html`
    <div class="reading-overlay" ref=${overlay}>
      ${at && reading.value && html`
        <${Arrow} at=${at} />
        ${clickMode.value === "feet" ? html`<${Feet} at=${at} />` : html`<${Numbers} at=${at} />`}
        <${Tags} at=${at} />
      `}
      <${Controls} />
      ${isReading.value && html`
        <p class="reading-busy" role="status"><span class="spinner" aria-hidden="true"></span>Reading…</p>
      `}
    </div>
  `;
}

/** Tell whether a pointer or the focus is in the picture, until the function that is returned is called. */
/** @param {HTMLElement} picture */
function followMeeting(picture) {
  const listeners = /** @type {[string, boolean][]} */ (
    [["pointerenter", true], ["pointerleave", false], ["focusin", true], ["focusout", false]]);
  const all = listeners.map(([type, isIn]) => /** @type {const} */ ([type, () => (isMet.value = isIn)]));
  all.forEach(([type, listener]) => picture.addEventListener(type, listener));
  return () => all.forEach(([type, listener]) => picture.removeEventListener(type, listener));
}

/** @param {{ x: number, y: number } | null} place */
const styleAt = (place) => (place ? { left: `${place.x}px`, top: `${place.y}px` } : { display: "none" });

// ---- the arrow forward

/** Of the label at its tip. */
const LETTER_PX = 7;
/** Keys for the axes of the torso. @type {Record<string, number>} */
const AXIS_KEYS = { x: 0, X: 180, y: 90, Y: -90 };

/** @param {{ at: LayerPlaces }} props */
function Arrow({ at }) {
  const isDragged = useRef(false);
  const corners = at.arrow;
  const isSeen = corners.every((place) => place !== null);
  /** @param {PointerEvent & { currentTarget: HTMLElement }} event */
  const onDown = ({ button, pointerId, currentTarget }) => {
    if (button !== 0) return;
    currentTarget.setPointerCapture(pointerId);
    isDragged.current = true;
    isTurning.value = false;
  };
  /** @param {PointerEvent & { currentTarget: HTMLElement }} event */
  const onMove = ({ clientX, clientY, currentTarget }) => {
    if (!isDragged.current) return;
    const box = /** @type {HTMLElement} */ (currentTarget.parentElement).getBoundingClientRect();
    const tips = arrowTips(extent.peek()).map(({ angle_deg }, n) => ({ angle_deg, place: at.tips[n] }));
    const angle = nearestAngle({ x: clientX - box.left, y: clientY - box.top }, tips);
    if (angle !== null && angle !== draggedAngle.peek()) draggedAngle.value = angle;
  };
  const onUp = () => {
    isDragged.current = false;
    const angle = draggedAngle.peek();
    if (angle === null) return;
    const wanted = wantedForward.peek();
    draggedAngle.value = null;
    if (angle !== 0) chooseForward(wanted);
  };
  /** @param {KeyboardEvent} event */
  const onKeyDown = (event) => {
    if (event.ctrlKey || event.altKey || event.metaKey) return;
    const step = { ArrowLeft: 1, ArrowUp: 1, ArrowRight: -1, ArrowDown: -1 }[event.key];
    const axis = AXIS_KEYS[event.key];
    if (!step && axis === undefined) return;
    event.preventDefault();
    event.stopPropagation();
    chooseForward(axis ?? wantedForward.peek() + Number(step) * STEP_DEG);
  };
  const words = directionInWords(wantedForward.value);
  const label = `Forward ${words}`;
  // It stays in the picture, whose edges the tip comes near to.
  const half = LETTER_PX * label.length / 2 + TAG.edge;
  const x = corners[0]?.x ?? 0;
  const shift = Math.max(half - x, 0) + Math.min(pictureSize.value.width - half - x, 0);
  return html`
    <svg class="reading-arrow" aria-hidden="true">
      ${isSeen && html`<polygon points=${corners.map((place) => `${place?.x},${place?.y}`).join(" ")} />`}
    </svg>
    <button class="arrow-handle" style=${styleAt(corners[0])} role="slider" aria-label="Forward"
      aria-valuemin="-180" aria-valuemax="180" aria-valuenow=${Math.round(wantedForward.value)}
      aria-valuetext=${`along ${words} of its torso`}
      title="Drag it, or use arrow keys; x, y, and with Shift −x, −y" onPointerDown=${onDown} onPointerMove=${onMove}
      onPointerUp=${onUp} onLostPointerCapture=${onUp} onKeyDown=${onKeyDown}>
      <span style=${{ marginLeft: `${shift}px` }}>${label}</span>
    </button>
  `;
}

// ---- legs and feet

/** @param {{ at: LayerPlaces }} props */
const Numbers = ({ at }) => html`
  <div class="reading-legs" role="group" aria-label="Legs">
    ${legFeet.value.map(({ leg }, n) => html`
      <button key=${leg} class=${`pair-${(groupOf(leg) % COLORS) + 1}`} style=${styleAt(at.numbers[n])}
        onClick=${() => nextGroup(leg)}
        aria-label=${`Leg ${leg}, group ${groupOf(leg) + 1}: move it to the next group`}>
        ${leg}
      </button>
    `)}
  </div>
`;

/** @param {{ at: LayerPlaces }} props */
const Feet = ({ at }) => html`
  <div class="reading-feet" role="group" aria-label="Possible feet">
    ${possibleFeet.value.map(({ name, leg }, n) => {
      const isChosen = feetChosen.value.includes(name);
      return html`
        <button key=${name} style=${styleAt(at.feet[n])} aria-pressed=${isChosen ? "true" : "false"} title=${name}
          aria-label=${`Foot ${name}`} onClick=${() => toggleFoot(name)}>
          ${isChosen ? leg || "✓" : ""}
        </button>
      `;
    })}
  </div>
`;

// ---- tags of guesses

/** The columns of tags, which stay while the robot turns: of the reading and the size for which they were chosen. */
const chosen = { key: /** @type {unknown[]} */ ([]), columns: /** @type {ReturnType<typeof columnsOf>} */ ([]) };

/** @param {LayerPlaces} at */
function columnsNow(at) {
  const key = [tags.value, pictureSize.value.width, pictureSize.value.height, places.value.of > 0];
  if (!key.every((value, n) => value === chosen.key[n])) {
    Object.assign(chosen, { key, columns: columnsOf(at.tags, pictureSize.value) });
  }
  return chosen.columns;
}

/** @param {{ at: LayerPlaces }} props */
function Tags({ at }) {
  if (!tags.value.length) return null;
  const columns = hasRoomForTags.value ? columnsNow(at) : [];
  const size = pictureSize.value;
  const lines = tags.value.flatMap((tag, n) => {
    const [column, place] = [columns[n], at.tags[n]];
    return column && place ? [{ index: tag.index, from: lineEnd(column, size), to: place }] : [];
  });
  return html`
    <svg class="reading-lines" aria-hidden="true">
      ${lines.map(({ index, from, to }) => html`
        <g key=${index}>
          <line x1=${from.x} y1=${from.y} x2=${to.x} y2=${to.y} /><circle cx=${to.x} cy=${to.y} r="3.5" />
        </g>
      `)}
    </svg>
    <ul class="reading-tags" aria-label="Guesses in the picture">
      ${tags.value.map((tag, n) => {
        const column = columns[n];
        // In a small picture there is room for those alone that offer something.
        if (hasRoomForTags.value ? !column : !tag.offer) return null;
        const { left, top } = column ? boxOf(column, size) : { left: at.tags[n]?.x ?? -99, top: at.tags[n]?.y ?? -99 };
        const style = { left: `${left}px`, top: `${top}px` };
        return html`<${TagOf} key=${tag.index} tag=${tag} isDot=${!column} style=${style} />`;
      })}
    </ul>
  `;
}

/** Show a guess in the list, with what corrects it. @param {Tag} tag */
function showGuess({ index, topic }) {
  isTurning.value = false;
  if (topic === "legs") clickMode.value = "feet";
  if (topic === "groups") clickMode.value = "groups";
  shownNote.value = index;
  requestAnimationFrame(() => {
    const note = document.getElementById(`reading-note-${index}`);
    note?.scrollIntoView({ block: "nearest" });
    note?.focus({ preventScroll: true });
  });
}

/** @param {{ tag: Tag, isDot: boolean, style: Record<string, string> }} props */
const TagOf = ({ tag, isDot, style }) => html`
  <li class=${isDot ? "dot" : ""}
    style=${isDot ? style : { ...style, width: `${TAG.width}px`, height: `${TAG.height}px` }}>
    <button aria-label=${isDot ? `${tag.title}: ${tag.text}` : undefined} title=${tag.text}
      onClick=${() => showGuess(tag)}>
      ${isDot ? html`<b>?</b>` : html`<b>${tag.title}</b> <span>${tag.text}</span>`}
    </button>
    ${!isDot && tag.offer && html`
      <button class="offer" title=${offerInWords(tag.offer)} 
        onClick=${() => tag.offer && decide(asDecision(tag.offer))}>
        ${offerInWords(tag.offer)}
      </button>
    `}
  </li>
`;

// ---- below the robot

const Controls = () => html`
  <div class="reading-controls">
    <div class="reading-turn" role="group" aria-label="Turn it">
      <button class="quiet square" aria-label="Turn it to the left" onClick=${() => turnBy(1)}>↺</button>
      <button class="quiet square" onClick=${toggleTurning}
        aria-label=${isTurning.value ? "Stop turning" : "Let it turn"}>
        <${Icon} name=${isTurning.value ? "pause" : "play"} />
      </button>
      <button class="quiet square" aria-label="Turn it to the right" onClick=${() => turnBy(-1)}>↻</button>
    </div>
    ${reading.value && html`
      <div class="reading-mode">
        <span class="roomy" id="click-mode">${MODES[clickMode.value]}</span>
        <${Segments} label="What a click changes" value=${clickMode.value}
          choices=${[["groups", "Groups"], ["feet", "Feet"]]}
          onValue=${(/** @type {"groups" | "feet"} */ mode) => (clickMode.value = mode)} />
      </div>
    `}
  </div>
`;
