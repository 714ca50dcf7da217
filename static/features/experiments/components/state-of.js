// The state of an experiment, with how far it is.
import { stateInWords } from "../words.js";
import { html } from "../../../js/components/elements.js";

/** @import { Run } from "../../../js/types.js" */

/** While it runs its share says so; by ear it is said. @param {{ run: Run }} props */
export const StateOf = ({ run }) => html`
  <span class=${`state ${run.state}`}>
    <span class="dot" aria-hidden="true"></span>
    <span>${run.state === "running" && html`<span class="sr-only">running, </span>`}${stateInWords(run)}</span>
  </span>
`;
