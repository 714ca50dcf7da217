// What stands where the stage will be: the robots on the start line, drawn.
import { html } from "../html.js";

const ROBOTS = [[-150, "var(--q-learning)"], [0, "var(--greedy)"], [150, "var(--two-step)"]];
const LEGS = ["M-16 0-44-14-56 18", "M-10 6-34 0-42 34", "M-6 8-16 12-20 42"];

const Robot = ({ x, color }) => html`
  <g transform=${`translate(${x} 0)`} style=${{ color }}>
    <ellipse class="shadow" cx="0" cy="40" rx="62" ry="9" />
    ${LEGS.map((d) => html`<path class="limb" d=${d} /><path class="limb" d=${d} transform="scale(-1 1)" />`)}
    <path class="torso" d="M-24-6 -12-16 H12 L24-6 12 12 H-12z" />
  </g>
`;

const REFUSALS = {
  "full": "Many are watching already. The picture comes when there is room; numbers and charts go on.",
  "address full": "Many are watching from this network already. The picture comes when there is room; numbers and charts go on.",
  "place taken": "Someone else was given this place. The picture comes back when there is room; numbers and charts go on.",
};

/** Whether the viewer said that it has no place. */
export const isRefused = (status) => status in REFUSALS;

export const StagePlaceholder = ({ status }) => html`
  <div class="placeholder">
    <svg viewBox="-320 -130 640 260" aria-hidden="true">
      <path class="track" d="M-300 110-90-110M-100 110-30-110M100 110 30-110M300 110 90-110" />
      <path class="track" d="M-270 78H270M-212 18H212M-158-38H158M-118-80H118" />
      <path class="finish" d="M-118-80H118" /><path class="start" d="M-270 78H270" />
      <g transform="translate(0 38)">${ROBOTS.map(([x, color]) => html`<${Robot} x=${x} color=${color} />`)}</g>
    </svg>
    <p>${REFUSALS[status] ?? "The robots walk to the start line…"}</p>
  </div>
`;
