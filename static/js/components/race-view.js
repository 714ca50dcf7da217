// The race view: stage, controls, scoreboard and charts.
import { html } from "../html.js";
import { isNarrow } from "../page.js";
import { isOperator } from "../selectors.js";
import { Controls } from "./controls.js";
import { Knowledge } from "./knowledge-table.js";
import { LearningChart } from "./learning-chart.js";
import { RaceChart } from "./race-chart.js";
import { Scoreboard } from "./scoreboard.js";
import { Stage } from "./stage.js";
import { SharedChoices } from "./transport.js";
import { WhatIf } from "./what-if.js";

/** Hidden, not removed, while another view is open, so that the stage does not load again. */
export const RaceView = ({ isHidden }) => html`
  <div class="race-view" hidden=${isHidden}>
    <${Stage} />
    ${isNarrow.value && isOperator.value && html`<div class="shared-choices"><${SharedChoices} /></div>`}
    <div class="side">
      <${Controls} />
      <${WhatIf} />
      <${Scoreboard} />
    </div>
    <div class="below">
      <${LearningChart} />
      <${RaceChart} />
      <${Knowledge} />
    </div>
  </div>
`;
