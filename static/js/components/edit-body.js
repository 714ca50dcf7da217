// The buttons that open the editor of the robot's body and the list of stored robots, which are loaded then.
import { bodyIsOpen, form, isReadOnly, robotsAreOpen } from "../form.js";
import { robotTitle } from "../titles.js";
import { html } from "./elements.js";

/** `isNamed`: with the name of the robot, without the list. @param {{ isNamed?: boolean }} props */
export const EditBody = ({ isNamed = true }) => html`
  <div class="edit-body">
    ${isNamed && html`<span class="dim">Robot</span><b>${robotTitle(form.value.robot)}</b>`}
    <button class="secondary compact" aria-haspopup="dialog" disabled=${isReadOnly.value}
      onClick=${() => (bodyIsOpen.value = true)}>Edit the body…</button>
    ${!isNamed && html`
      <button class="secondary compact" aria-haspopup="dialog"
        onClick=${() => (robotsAreOpen.value = true)}>Your robots…</button>
    `}
  </div>
`;
