// The buttons beside the form's robot that open the editor of its body and the list of stored robots.
import { form, isReadOnly } from "../../../js/form.js";
import { storedRobot } from "../../../js/robots.js";
import { served } from "../../../js/store.js";
import { html } from "../../../js/components/elements.js";
import { editBody, showRobots } from "../dialogs.js";

/** Whether the robot is from a file, whose legs are no numbers of the form. */
const isFromFile = () => storedRobot(form.value.robot, served().robots)?.body === null;

export const EditBody = () => html`
  <button class="secondary compact" aria-haspopup="dialog" disabled=${isReadOnly.value || isFromFile()}
    title=${isFromFile() ? "Its file says how it is built; correct that in Your robots." : undefined}
    onClick=${editBody}>Edit the body…</button>
  <button class="secondary compact" aria-haspopup="dialog" onClick=${showRobots}>Your robots…</button>
`;
