// A small picture of what came of a run: a training's curve below greedy's line, a race's lanes up to the finish.
import { pointsOf } from "../../run-thumbnails.js";
import { greedyOf } from "../../run-words.js";
import { isActive, isWalk } from "../../selectors.js";
import { agentOf } from "../../settings.js";
import { html } from "../elements.js";

/** @import { AnyRun } from "../../runs.js" */
/** @import { Run } from "../../types.js" */

const [WIDTH, HEIGHT] = [92, 34];
const [LEFT, RIGHT, TOP, BOTTOM] = [6, 86, 5, 30];
/** Of a curve without greedy's line [m]. */
const MIN_TOP_M = 0.1;
/** Where a race's finish line is [m], as in the paper. */
const FINISH_M = 0.45;
const BAR_PX = 6;

/** @param {{ run: AnyRun }} props */
export const Thumbnail = ({ run }) => html`
  <svg class="thumbnail" viewBox=${`0 0 ${WIDTH} ${HEIGHT}`} width=${WIDTH} height=${HEIGHT} aria-hidden="true">
    ${!("damaged" in run) && run.kind === "training" && html`<${Curve} run=${run} />`}
    ${!("damaged" in run) && run.kind === "race" && html`<${Lanes} run=${run} />`}
    ${!("damaged" in run) && (isActive(run) || !isWalk(run)) && html`<${Progress} run=${run} />`}
  </svg>
`;

/** @param {{ run: Run }} props */
function Curve({ run }) {
  const points = pointsOf(run.id);
  const greedy = greedyOf(run);
  const distances = points.map(([, distance_m]) => distance_m);
  const [least, most] = [Math.min(0, ...distances), Math.max(greedy ?? MIN_TOP_M, MIN_TOP_M, ...distances)];
  const x = (/** @type {number} */ step) => LEFT + ((RIGHT - LEFT) * step) / run.config.steps;
  const y = (/** @type {number} */ distance) => BOTTOM - ((BOTTOM - TOP) * (distance - least)) / (most - least);
  const path = [[0, 0], ...points].map(([step, distance]) => `${x(step).toFixed(1)} ${y(distance).toFixed(1)}`);
  return html`
    ${greedy && html`<path class="greedy" d=${`M${LEFT} ${y(greedy).toFixed(1)}H${RIGHT}`} />`}
    ${points.length > 0 && html`
      <path class="curve" style=${{ "--agent": agentOf(run.config.agent).color }} d=${`M${path.join("L")}`} />
    `}
  `;
}

/** @param {{ run: Run }} props */
function Lanes({ run }) {
  const lanes = run.result?.lanes ?? [];
  const distances = lanes.map(({ clocks }) => clocks.paper.finished_distance_m ?? 0);
  const most = Math.max(FINISH_M / 0.9, ...distances);
  const pitch = Math.min(8, (BOTTOM - TOP + 2) / Math.max(1, lanes.length));
  const top = (HEIGHT - pitch * lanes.length + 1) / 2;
  const x = (/** @type {number} */ distance) => ((RIGHT - LEFT) * distance) / most;
  return html`
    ${distances.map((distance, lane) => html`
      <rect x=${LEFT} y=${top + pitch * lane} width=${Math.max(1, x(distance))} height=${Math.min(BAR_PX, pitch - 1)}
        rx="1.5" style=${{ fill: agentOf(lanes[lane].agent).color }} />
    `)}
    <path class="finish" d=${`M${LEFT + x(FINISH_M)} 3V${HEIGHT - 3}`} />
  `;
}

/** @param {{ run: Run }} props */
function Progress({ run: { progress: { done, total } } }) {
  const share = total ? done / total : 0;
  return html`
    <rect class="whole" x=${LEFT} y=${HEIGHT - 4} width=${RIGHT - LEFT} height="2" rx="1" />
    <rect class="done" x=${LEFT} y=${HEIGHT - 4} width=${share * (RIGHT - LEFT)} height="2" rx="1" />
  `;
}
