// A choice of several out of a few; at least one stays chosen.
import { html } from "../../html.js";
import { setField, values } from "../../experiments/form.js";
import { help } from "./experiment-help.js";

/** `choices`: [value, title]. */
export function CheckList({ field, label, choices }) {
  const chosen = /** @type {string[]} */ (values.value[field]);
  const toggle = (event, name) => {
    const isChosen = (one) => (one === name ? !chosen.includes(one) : chosen.includes(one));
    const next = choices.map(([one]) => one).filter(isChosen);
    if (next.length) setField(field, next);
    else event.target.checked = true;
  };
  return html`
    <fieldset class="field" onFocusIn=${help(field)} onPointerEnter=${help(field)}>
      <legend>${label}</legend>
      <div class="checks">
        ${choices.map(([name, title]) => html`
          <label class="check" key=${name}>
            <input type="checkbox" checked=${chosen.includes(name)} onChange=${(event) => toggle(event, name)} />
            ${title}
          </label>
        `)}
      </div>
    </fieldset>
  `;
}
