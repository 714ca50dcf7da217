// The button that opens the editor of the robot's body, which is loaded then.
import { bodyIsOpen, form, isReadOnly } from "../form.js";
import { robotTitle } from "../titles.js";
import { html } from "./elements.js";

/** `isNamed`: with the name of the robot. @param {{ isNamed?: boolean }} props */
export const EditBody = ({ isNamed = true }) => html`
  <div class="edit-body">
    ${isNamed && html`<span class="dim">Robot</span><b>${robotTitle(form.value.robot)}</b>`}
    <button class="secondary compact" aria-haspopup="dialog" disabled=${isReadOnly.value}
      onClick=${() => (bodyIsOpen.value = true)}>Edit the body…</button>
  </div>
`;
