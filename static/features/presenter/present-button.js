// The button of the header that presents the page.
import { html, Icon } from "../../js/components/elements.js";
import { present } from "./presenting.js";

export const PresentButton = () => html`
  <button class="quiet roomy" onClick=${present} title="Full screen and large type, for a class">
    <${Icon} name="present" />Present
  </button>
`;
