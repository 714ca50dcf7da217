// A passing remark.
import { remark } from "../actions.js";
import { html } from "../html.js";

export const Toast = () => html`
  <div class="toast" role="status">${remark.value && html`<p>${remark.value.text}</p>`}</div>
`;
