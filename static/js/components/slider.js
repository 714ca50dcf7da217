// A number as a slider and a text field.
import { html } from "../html.js";
import { settingOf } from "../limits.js";
import { shareOf } from "../scale.js";
import { NumberField } from "./number-field.js";
import { Description, showHelp } from "./setting-help.js";

/**
 * `setting` is the field's declaration, of which `title` and `unit` replace the words. `min` and `max` are the
 * slider's ends; the text field accepts what the server does.
 */
export function Slider({ field, setting = settingOf(field), title, unit, value, onValue, min, max, step }) {
  const { symbol, help } = setting;
  const name = title ?? setting.title;
  const reached = Math.min(Math.max(value ?? min, min), max);
  const show = showHelp(field, help);
  return html`
    <div class="slider" onFocusIn=${show} onPointerEnter=${show}>
      <label for=${`slide-${field}`} title=${name}>${name} ${symbol && html`<b>${symbol}</b>`}</label>
      <input type="range" id=${`slide-${field}`} min=${min} max=${max} step=${step}
        value=${reached} style=${{ "--share": `${100 * shareOf(reached, min, max)}%` }}
        aria-describedby=${`help-${field}`}
        onInput=${({ target }) => onValue(Number(target.value))} />
      <${NumberField} field=${field} setting=${setting} value=${value} onValue=${onValue} step=${step}
        label=${`${name}, as a number`} />
      <span class="unit">${unit ?? setting.unit}</span>
      <${Description} field=${field} words=${help} />
    </div>
  `;
}
