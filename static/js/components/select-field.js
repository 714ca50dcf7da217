// A choice out of a list, with its label and help.
import { form, setField } from "../form.js";
import { html } from "../html.js";
import { Description, showHelp } from "./setting-help.js";

/** `choices`: [value, title]; `onValue` replaces setting the form's field. */
export function SelectField({ field, label, choices, onValue = (value) => setField(field, value) }) {
  const help = showHelp(field);
  const value = String(form.value[field]);
  const onChange = ({ target }) => onValue(choices.find(([one]) => String(one) === target.value)[0]);
  return html`
    <div class="field" onFocusIn=${help} onPointerEnter=${help}>
      <label for=${`field-${field}`}>${label}</label>
      <select id=${`field-${field}`} aria-describedby=${`help-${field}`} onChange=${onChange}>
        ${choices.map(([one, title]) => html`
          <option value=${String(one)} selected=${String(one) === value}>${title}</option>
        `)}
      </select>
      <${Description} field=${field} />
    </div>
  `;
}
