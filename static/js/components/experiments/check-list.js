// Several out of a few; the last one stays.
import { html } from "../../html.js";
import { say, values } from "../../experiments/form.js";
import { help } from "./experiment-help.js";

/** `choices`: [value, title]. */
export function CheckList({ field, label, choices }) {
  const chosen = values.value[field];
  const toggle = (event, name) => {
    const next = choices.map(([one]) => one).filter((one) => (one === name ? !chosen.includes(one) : chosen.includes(one)));
    if (next.length) say(field, next);
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
