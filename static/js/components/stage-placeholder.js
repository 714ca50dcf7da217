// A drawing of the robots on the start line, shown until the stage has a picture.
import { agentOf } from "../agents.js";
import { form } from "../form.js";
import { html } from "../html.js";

const LANES_X = [-150, 0, 150];
const LEGS = ["M-16 0-44-14-56 18", "M-10 6-34 0-42 34", "M-6 8-16 12-20 42"];

const LOADING = "The robots walk to the start line…";
const LATER = "The picture comes when there is room; numbers and charts are live.";
/** Status of the frame that has no place → the reason. */
const REFUSALS = {
  "full": `Many are watching already. ${LATER}`,
  "address full": `Many are watching from this network already. ${LATER}`,
  "place taken": `Someone else was given this place. ${LATER}`,
};

/** Whether a status of the frame says that it has no place. */
export const isRefused = (status) => status in REFUSALS;

const Robot = ({ x, color }) => html`
  <g transform=${`translate(${x} 0)`} style=${{ color }}>
    <ellipse class="shadow" cx="0" cy="40" rx="62" ry="9" />
    ${LEGS.map((d) => html`<path class="limb" d=${d} /><path class="limb" d=${d} transform="scale(-1 1)" />`)}
    <path class="torso" d="M-24-6 -12-16 H12 L24-6 12 12 H-12z" />
  </g>
`;

export function StagePlaceholder({ status }) {
  const robots = form.value.lanes.slice(0, LANES_X.length);
  return html`
    <div class="placeholder">
      <svg viewBox="-320 -130 640 260" aria-hidden="true">
        <path class="track" d="M-300 110-90-110M-100 110-30-110M100 110 30-110M300 110 90-110" />
        <path class="track" d="M-270 78H270M-212 18H212M-158-38H158M-118-80H118" />
        <path class="finish" d="M-118-80H118" /><path class="start" d="M-270 78H270" />
        <g transform="translate(0 38)">
          ${robots.map((agent, lane) => html`<${Robot} x=${LANES_X[lane]} color=${agentOf(agent).color} />`)}
        </g>
      </svg>
      <p>${REFUSALS[status] ?? LOADING}</p>
    </div>
  `;
}
