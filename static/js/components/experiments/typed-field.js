// Text fields of the experiment form: a whole number, or values with commas. A mistake disables the start.
import { useState } from "preact/hooks";
import { refusedFields } from "../../actions.js";
import { html } from "../../html.js";
import { limitsOf, mistakeIn, parseValues } from "../../limits.js";
import { shortTitle } from "../../settings.js";
import { helpFor } from "../setting-help.js";
import { help } from "./experiment-help.js";
import { defaults, mistakes, setField, setMistake, values } from "../../experiments/form.js";

/** @import { SettingValue } from "../../types.js" */

function TypedField({ field, label, text, parse, inputmode, placeholder = undefined }) {
  const [draft, setDraft] = useState(null);
  const mistake = mistakes.value[field];
  const isRefused = refusedFields("experiment").includes(field);
  const onInput = ({ target }) => {
    setDraft(target.value);
    const parsed = parse(target.value);
    setMistake(field, parsed.mistake ?? null);
    if (!parsed.mistake) setField(field, parsed.value);
  };
  const onBlur = () => {
    setDraft(null);
    setMistake(field, null);
  };
  return html`
    <div class="field" onFocusIn=${help(field)} onPointerEnter=${help(field)}>
      <label for=${`experiment-${field}`}>${label}</label>
      <span class="number">
        <input type="text" inputmode=${inputmode} id=${`experiment-${field}`} value=${draft ?? text}
          placeholder=${placeholder}
          aria-invalid=${mistake || isRefused ? "true" : undefined}
          aria-describedby=${mistake ? `wrong-${field}` : `about-${field}`} onInput=${onInput} onBlur=${onBlur} />
        ${mistake && html`<span class="mistake" role="alert" id=${`wrong-${field}`}>${mistake}</span>`}
      </span>
      <span class="sr-only" id=${`about-${field}`}>${helpFor(field)}</span>
    </div>
  `;
}

/** One whole number. */
export function CountField({ field, label }) {
  const parse = (typed) => {
    const value = /^\d+$/.test(typed.trim()) ? Number(typed) : NaN;
    const mistake = mistakeIn(value, limitsOf(field), true);
    return mistake ? { mistake } : { value };
  };
  const text = String(values.value[field]);
  return html`<${TypedField} field=${field} label=${label} text=${text} parse=${parse} inputmode="numeric" />`;
}

const joined = (list) => /** @type {SettingValue[]} */ (list).join(", ");

/** One value of a setting, or several with commas between; none where each agent has its own default. */
export function ValuesField({ field, setting }) {
  const standard = defaults.value[field];
  const isOwn = joined(standard) === "";
  const parse = (typed) => (isOwn && typed.trim() === "" ? { value: standard } : parseValues(typed, setting));
  return html`
    <${TypedField} field=${field} label=${shortTitle(setting)} text=${joined(values.value[field])} parse=${parse}
      inputmode=${setting.is_number ? "decimal" : "text"} placeholder=${isOwn ? "by default" : undefined} />
  `;
}
