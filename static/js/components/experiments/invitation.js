// Before the first experiment: why one would want it, and what it will look like.
import { html } from "../../html.js";
import { isOperator } from "../../selectors.js";
import { StripKey } from "./strip-key.js";

/** Drawn, not measured: dots that scatter, one that the paper printed, a line to reach. */
const ROWS = [
  [[8, 62, 66, 69, 70, 72, 73, 75, 76, 78, 80, 83], 50],
  [[30, 68, 72, 75, 78, 79, 80, 82, 84, 85, 87, 88], 66],
];

const Sketch = ({ points, published, y }) => html`
  <line class="rule" x1="0" x2="100%" y1=${y} y2=${y} />
  ${points.map((x, n) => html`<circle cx=${`${x}%`} cy=${y + [0, -7, 6][n % 3]} r="4" />`)}
  <svg x=${`${published}%`} y=${y} overflow="visible"><path d="M0-8 7 0 0 8-7 0z" /></svg>
`;

export const Invitation = () => html`
  <section class="panel invitation" aria-labelledby="invitation-title">
    <h2 id="invitation-title">One seed misleads</h2>
    <p>
      The paper shows one run of everything. The same robot, with other luck, may walk or march on the spot.
      So here everything is run thirty times, and every run is a dot; the published value stands among them.
    </p>
    <svg class="sketch-dots" width="100%" height="112" aria-hidden="true">
      <line class="reach" x1="93%" x2="93%" y1="0" y2="112" />
      ${ROWS.map(([points, published], n) => html`<${Sketch} points=${points} published=${published} y=${30 + 52 * n} />`)}
    </svg>
    <${StripKey} signs=${["seed", "greedy", "published"]} color="var(--q-learning)" />
    <p class="dim">
      ${isOperator.value
        ? "Choose an experiment and press the button. The report fills here while its trials end, and can be paused, left and taken up again."
        : "No experiment has been run here. As soon as one is, its report fills here."}
    </p>
  </section>
`;
