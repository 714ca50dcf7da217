// A choice out of a few, with its label and its sentence.
import { form, set } from "../form.js";
import { html } from "../html.js";
import { Description, showHelp } from "./setting-help.js";

/** `choices`: [value, title]; `onValue` instead of the form where the choice is not the form's. */
export function SelectField({ field, label, choices, onValue = (value) => set(field, value), value = form.value[field] }) {
  const help = showHelp(field);
  const onChange = ({ target }) => onValue(choices.find(([one]) => String(one) === target.value)[0]);
  return html`
    <div class="field" onFocusIn=${help} onPointerEnter=${help}>
      <label for=${`field-${field}`}>${label}</label>
      <select id=${`field-${field}`} aria-describedby=${`help-${field}`} onChange=${onChange}>
        ${choices.map(([one, title]) => html`
          <option value=${String(one)} selected=${String(one) === String(value)}>${title}</option>
        `)}
      </select>
      <${Description} field=${field} />
    </div>
  `;
}
