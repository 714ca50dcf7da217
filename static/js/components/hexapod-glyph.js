// A hexapod from above, forward up. Legs that move together share a colour and are joined by a line.
import { html } from "../html.js";

const HIP = 7.5;
const FOOT = 24;

/** The point at a distance from the centre in the direction of a leg; azimuths turn anticlockwise. */
function at(azimuth_deg, radius) {
  const angle = (azimuth_deg * Math.PI) / 180;
  return [-radius * Math.sin(angle), -radius * Math.cos(angle)].map((c) => c.toFixed(1));
}

/** `only`: the pair to show in colour; without it, all are. */
export function HexapodGlyph({ gait, only = null }) {
  const pairs = gait.pairs.map((legs, number) => {
    const [from, to] = legs.map((leg) => at(gait.azimuths_deg[leg - 1], FOOT));
    const style = only === null || only === number ? `pair pair-${(number % 6) + 1}` : "pair pair-none";
    return html`
      <g class=${style}>
        <path class="thread" d=${`M${from} L${to}`} />
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

function Leg({ azimuth }) {
  const foot = at(azimuth, FOOT);
  return html`
    <path class="leg" d=${`M${at(azimuth, HIP)} L${foot}`} />
    <circle class="foot" cx=${foot[0]} cy=${foot[1]} r="3.2" />
  `;
}
