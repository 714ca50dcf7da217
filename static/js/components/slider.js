// A number to slide and to type.
import { html } from "../html.js";
import { NumberField } from "./number-field.js";
import { Description, showHelp } from "./setting-help.js";

/** `field` names it in the form, `about` the sentence of help where that is another. */
export function Slider({ field, about = field, label, symbol, unit, value, onValue, min, max, step, isDisabled }) {
  const share = ((Math.min(Math.max(value, min), max) - min) / (max - min)) * 100;
  const help = showHelp(about);
  return html`
    <div class="slider" onFocusIn=${help} onPointerEnter=${help}>
      <label for=${`slide-${field}`}>${label} ${symbol && html`<b>${symbol}</b>`}</label>
      <input type="range" id=${`slide-${field}`} min=${min} max=${max} step=${step}
        value=${Math.min(Math.max(value, min), max)} style=${{ "--share": `${share}%` }}
        disabled=${isDisabled} aria-describedby=${`help-${field}`}
        onInput=${({ target }) => onValue(Number(target.value))} />
      <${NumberField} field=${field} value=${value} onValue=${onValue} step=${step}
        label=${`${label}, as a number`} isDisabled=${isDisabled} />
      <span class="unit">${unit}</span>
      <${Description} field=${about} id=${field} />
    </div>
  `;
}
