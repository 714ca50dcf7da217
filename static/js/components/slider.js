// A number as a slider and a text field.
import { html } from "../html.js";
import { settingOf } from "../limits.js";
import { shareOf } from "../scale.js";
import { NumberField } from "./number-field.js";
import { Description, showHelp } from "./setting-help.js";

/** `min` and `max` are the slider's ends; the text field accepts what the server does. Labels are the setting's. */
export function Slider({ field, label, unit, value, onValue, min, max, step }) {
  const { title, symbol, unit: ownUnit } = settingOf(field);
  const name = label ?? title;
  const reached = Math.min(Math.max(value, min), max);
  const help = showHelp(field);
  return html`
    <div class="slider" onFocusIn=${help} onPointerEnter=${help}>
      <label for=${`slide-${field}`}>${name} ${symbol && html`<b>${symbol}</b>`}</label>
      <input type="range" id=${`slide-${field}`} min=${min} max=${max} step=${step}
        value=${reached} style=${{ "--share": `${100 * shareOf(value, min, max)}%` }}
        aria-describedby=${`help-${field}`}
        onInput=${({ target }) => onValue(Number(target.value))} />
      <${NumberField} field=${field} value=${value} onValue=${onValue} step=${step}
        label=${`${name}, as a number`} />
      <span class="unit">${unit ?? ownUnit}</span>
      <${Description} field=${field} />
    </div>
  `;
}
