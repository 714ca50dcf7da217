// The robot of the body's editor as it stands, in space: torso and links over their shadow. It is turned by a pointer
// or by keys.
import { signal } from "@preact/signals";
import { useRef } from "preact/hooks";
import { previewAnswer } from "../body-editor.js";
import { html } from "../../../js/components/elements.js";

/** @import { Preview } from "../../../js/types.js" */

/** Right, forward, up [m]. @typedef {number[]} Place */

const WIDTH = 200;
const HEIGHT = 110;
const KEY_TURN_DEG = 15;
const TURN_DEG_PER_PX = 0.6;
/** How steeply it is looked down upon. */
const DOWN_DEG = 28;
/** How much of the picture is filled. */
const FILLED = 0.92;
const ROUND_CORNERS = 24;
const COLORS = 6;

/** From where it is seen, anticlockwise from behind. */
const turn_deg = signal(-30);

/** A place as it is seen: to the right, down, and how near. @param {Place} place */
function seen([x, y, z]) {
  const [turn, down] = [turn_deg.value, DOWN_DEG].map((degrees) => (degrees * Math.PI) / 180);
  const [right, away] = [x * Math.cos(turn) + y * Math.sin(turn), y * Math.cos(turn) - x * Math.sin(turn)];
  return [right, -away * Math.sin(down) - z * Math.cos(down), -away * Math.cos(down) + z * Math.sin(down)];
}

/** The corners of the torso from above, in the robot frame. @param {Preview} preview @returns {number[][]} */
function outline({ built, forward_deg }) {
  const { torso_length_m: long, torso_width_m: wide, torso_radius_m: radius } = built;
  const corners = long && wide
    ? [[1, 1], [-1, 1], [-1, -1], [1, -1]].map(([x, y]) => [(x * wide) / 2, (y * long) / 2])
    : Array.from({ length: ROUND_CORNERS }, (_, n) => (2 * Math.PI * n) / ROUND_CORNERS)
      .map((angle) => [Number(radius) * Math.cos(angle), Number(radius) * Math.sin(angle)]);
  const turn = ((90 - forward_deg) * Math.PI) / 180;
  return corners.map(([x, y]) => [
    x * Math.cos(turn) - y * Math.sin(turn), x * Math.sin(turn) + y * Math.cos(turn),
  ]);
}

export function BodyPicture() {
  const preview = previewAnswer.value?.preview;
  const from = useRef(/** @type {{ x: number, turn: number } | null} */ (null));
  if (!preview) return null;
  /** @param {PointerEvent & { currentTarget: Element }} event */
  const onDown = ({ button, clientX, pointerId, currentTarget }) => {
    if (button !== 0) return;
    currentTarget.setPointerCapture(pointerId);
    from.current = { x: clientX, turn: turn_deg.peek() };
  };
  /** @param {PointerEvent} event */
  const onMove = ({ clientX }) => {
    if (from.current) turn_deg.value = from.current.turn + TURN_DEG_PER_PX * (clientX - from.current.x);
  };
  const onUp = () => (from.current = null);
  /** @param {KeyboardEvent} event */
  const onKeyDown = (event) => {
    const sign = { ArrowLeft: -1, ArrowRight: 1 }[event.key];
    if (!sign || event.ctrlKey || event.altKey || event.metaKey) return;
    event.preventDefault();
    turn_deg.value += sign * KEY_TURN_DEG;
  };
  const degrees = ((turn_deg.value % 360) + 360) % 360;
  return html`
    <div class="body-picture" tabindex="0" role="slider" aria-label="Direction from which the robot is seen"
      aria-valuemin="0" aria-valuemax="360" aria-valuenow=${Math.round(degrees)}
      aria-valuetext=${`${Math.round(degrees)}°, anticlockwise from behind`} title="Drag, or arrow keys, to turn it"
      onPointerDown=${onDown} onPointerMove=${onMove} onPointerUp=${onUp} onLostPointerCapture=${onUp}
      onKeyDown=${onKeyDown}>
      <${Robot} preview=${preview} />
    </div>
  `;
}

/** @param {{ preview: Preview }} props */
function Robot({ preview }) {
  const { built, legs } = preview;
  const [half, ground_m] = [Number(built.torso_half_height_m), -Number(built.body_height_m)];
  const corners = outline(preview);
  const isBox = Boolean(built.torso_length_m);
  const standing = legs.filter(({ links_m }) => links_m !== null);
  const reach_m = Math.max(...corners.flat().map(Math.abs), ...standing.flatMap(({ links_m }) =>
    (links_m ?? []).map(([x, y]) => Math.hypot(x, y))));
  const top_m = Math.max(half, ...standing.flatMap(({ links_m }) => (links_m ?? []).map(([, , z]) => z)));
  const middle = seen([0, 0, (ground_m + top_m) / 2])[1];
  // It has room from wherever it is seen.
  const down = (DOWN_DEG * Math.PI) / 180;
  const high_m = 2 * reach_m * Math.sin(down) + (top_m - ground_m) * Math.cos(down);
  const scale = Math.min(WIDTH / (2 * reach_m), HEIGHT / high_m) * FILLED;
  /** @param {Place} place */
  const at = (place) => {
    const [x, y] = seen(place);
    return `${(scale * x).toFixed(1)} ${(scale * (y - middle)).toFixed(1)}`;
  };
  const area = (/** @type {Place[]} */ places) => `M${places.map(at).join("L")}Z`;
  const line = (/** @type {Place[]} */ places) => `M${places.map(at).join("L")}`;
  const level = (/** @type {number} */ z) => corners.map(([x, y]) => [x, y, z]);
  const sides = corners.map((corner, n) => [corner, corners[(n + 1) % corners.length]]).map(([a, b]) => ({
    near: seen([(a[0] + b[0]) / 2, (a[1] + b[1]) / 2, 0])[2],
    path: area([[...a, half], [...b, half], [...b, -half], [...a, -half]]),
  })).filter(({ near }) => near > seen([0, 0, 0])[2]);
  const torso = { near: seen([0, 0, 0])[2], drawn: html`
    <g key="torso" class=${`torso ${isBox ? "" : "round"}`}>
      ${sides.map(({ path }, n) => html`<path key=${n} class="side" d=${path} />`)}<path d=${area(level(half))} />
    </g>
  ` };
  const links = standing.map(({ leg, group, links_m }) => {
    const places = /** @type {Place[]} */ (links_m);
    return { near: seen(places[places.length - 1])[2], drawn: html`
      <g key=${leg} class=${`pair-${(group % COLORS) + 1}`}>
        <path class="limb" d=${line(places)} />
        ${places.slice(0, -1).map((place, n) => html`
          <circle key=${n} class="joint" r="2" transform=${`translate(${at(place)})`} />
        `)}
        <circle class="foot" r="3" transform=${`translate(${at(places[places.length - 1])})`} />
      </g>
    ` };
  });
  const onGround = (/** @type {Place[]} */ places) => places.map(([x, y]) => [x, y, ground_m]);
  return html`
    <svg viewBox=${`${-WIDTH / 2} ${-HEIGHT / 2} ${WIDTH} ${HEIGHT}`} aria-hidden="true">
      <g class="shadow">
        <path class="filled" d=${area(level(ground_m))} />
        ${standing.map(({ leg, links_m }) => html`<path key=${leg} d=${line(onGround(links_m ?? []))} />`)}
      </g>
      ${[torso, ...links].toSorted((a, b) => a.near - b.near).map(({ drawn }) => drawn)}
    </svg>
  `;
}
