// The buttons that open the editor of the robot's body and the list of stored robots, which are loaded then.
import { form, isReadOnly } from "../form.js";
import { bodyIsOpen, robotsAreOpen } from "../page.js";
import { storedRobot } from "../robots.js";
import { served } from "../store.js";
import { robotTitle } from "../titles.js";
import { html } from "./elements.js";

/** Whether the robot is from a file, whose legs are no numbers of the form. */
const isFromFile = () => storedRobot(form.value.robot, served().robots)?.body === null;

/** `isNamed`: with the name of the robot. @param {{ isNamed?: boolean }} props */
export const EditBody = ({ isNamed = true }) => html`
  <div class="edit-body">
    ${isNamed && html`<span class="dim">Robot</span><b>${robotTitle(form.value.robot)}</b>`}
    <button class="secondary compact" aria-haspopup="dialog" disabled=${isReadOnly.value || isFromFile()}
      title=${isFromFile() ? "Its file says how it is built; correct that in Your robots." : undefined}
      onClick=${() => (bodyIsOpen.value = true)}>Edit the body…</button>
    <button class="secondary compact" aria-haspopup="dialog"
      onClick=${() => (robotsAreOpen.value = true)}>Your robots…</button>
  </div>
`;
