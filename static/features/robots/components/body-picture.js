// The robot of the body's editor as it stands, on a turntable, as a robot from a file is seen. A pointer turns it, or
// keys.
import { useEffect, useRef, useState } from "preact/hooks";
import { bodyPlaces, bodyScene, showBodyIn, turned_deg } from "../body-scene.js";
import { html } from "../../../js/components/elements.js";
import { shownTheme } from "../../../js/page.js";

const KEY_TURN_DEG = 15;
const COLORS = 6;

export function BodyPicture() {
  const frame = useRef(/** @type {HTMLIFrameElement | null} */ (null));
  // The first address has it; later changes are sent to the frame, which must not load again.
  const [address] = useState(() => `viewer/?theme=${shownTheme.peek()}`);
  useEffect(() => showBodyIn(/** @type {HTMLIFrameElement} */ (frame.current)), []);
  /** @param {KeyboardEvent} event */
  const onKeyDown = (event) => {
    const sign = { ArrowLeft: -1, ArrowRight: 1 }[event.key];
    if (!sign || event.ctrlKey || event.altKey || event.metaKey) return;
    event.preventDefault();
    turned_deg.value += sign * KEY_TURN_DEG;
  };
  const places = bodyPlaces.value;
  const degrees = Math.round((((places?.azimuth_deg ?? 0) % 360) + 360) % 360);
  return html`
    <div class="body-picture" tabindex="0" role="slider" aria-label="Direction from which the robot is seen"
      aria-valuemin="0" aria-valuemax="360" aria-valuenow=${degrees}
      aria-valuetext=${`${degrees}°, anticlockwise from behind`} title="Drag, or arrow keys, to turn it"
      onKeyDown=${onKeyDown}>
      <iframe ref=${frame} src=${address} title="The body, in 3D" tabindex="-1"></iframe>
      ${places ? html`<${Marks} places=${places} />` : html`
        <p class="dim"><span class="spinner" aria-hidden="true"></span> Drawing the body…</p>
      `}
    </div>
  `;
}

/** @param {{ places: NonNullable<typeof bodyPlaces.value> }} props */
function Marks({ places: { arrow, numbers } }) {
  const { reading } = bodyScene.value ?? {};
  const groupOf = (/** @type {number} */ leg) => reading?.robot?.groups.findIndex((legs) => legs.includes(leg)) ?? 0;
  const isSeen = arrow.length > 0 && arrow.every((place) => place !== null);
  return html`
    <svg class="body-marks" aria-hidden="true">
      ${isSeen && html`<polygon points=${arrow.map((place) => `${place?.x},${place?.y}`).join(" ")} />`}
      ${reading?.feet.map(({ leg }, n) => numbers[n] && html`
        <g key=${leg} class=${`pair-${(groupOf(leg) % COLORS) + 1}`}
          transform=${`translate(${numbers[n].x} ${numbers[n].y})`}>
          <circle r="9" /><text dy="4">${leg}</text>
        </g>
      `)}
    </svg>
  `;
}
