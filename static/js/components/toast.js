// A message that disappears by itself.
import { toastMessage } from "../actions.js";
import { html } from "../html.js";

export const Toast = () => html`
  <div class="toast" role="status">${toastMessage.value && html`<p>${toastMessage.value}</p>`}</div>
`;
