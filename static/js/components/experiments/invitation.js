// Shown before the first experiment: what an experiment is for, with a sketch of its dots.
import { agentOf } from "../../agents.js";
import { html } from "../../html.js";
import { isOperator } from "../../selectors.js";
import { served } from "../../store.js";
import { StripKey } from "./strip-key.js";

/** A sketch, not measured: positions of the seeds and of the published value, in percent. */
const ROWS = [
  [[8, 62, 66, 69, 70, 72, 73, 75, 76, 78, 80, 83], 50],
  [[30, 68, 72, 75, 78, 79, 80, 82, 84, 85, 87, 88], 66],
];
const SCATTER_PX = [0, -7, 6];

const OPERATOR_WORDS =
  "Choose an experiment and press the button. Its report fills here while trials end; it can be paused and resumed.";
const SPECTATOR_WORDS = "No experiment has been run here. The report of the first one will fill here.";

const Sketch = ({ points, published, y }) => html`
  <line class="rule" x1="0" x2="100%" y1=${y} y2=${y} />
  ${points.map((x, n) => html`<circle cx=${`${x}%`} cy=${y + SCATTER_PX[n % 3]} r="4" />`)}
  <svg x=${`${published}%`} y=${y} overflow="visible"><path d="M0-8 7 0 0 8-7 0z" /></svg>
`;

export function Invitation() {
  const { color } = agentOf(served().defaults.training.agent);
  return html`
    <section class="panel invitation" aria-labelledby="invitation-title">
      <h2 id="invitation-title">One seed misleads</h2>
      <p>
        The paper shows one run of everything. The same robot with other random numbers may walk, or march on the
        spot. Here everything is run thirty times and each run is a dot, with the published value among them.
      </p>
      <svg class="sketch-dots" width="100%" height="112" aria-hidden="true" style=${{ "--agent": color }}>
        <line class="reach" x1="93%" x2="93%" y1="0" y2="112" />
        ${ROWS.map(([points, published], n) => html`
          <${Sketch} points=${points} published=${published} y=${30 + 52 * n} />
        `)}
      </svg>
      <${StripKey} signs=${["seed", "greedy", "published"]} color=${color} />
      <p class="dim">${isOperator.value ? OPERATOR_WORDS : SPECTATOR_WORDS}</p>
    </section>
  `;
}
