// A number to type. It takes effect as soon as it is valid; until then the reason is shown.
import { useEffect, useState } from "preact/hooks";
import { refusedFields } from "../actions.js";
import { mistakes, setMistake } from "../form.js";
import { html } from "../html.js";
import { mistakeIn, settingOf } from "../limits.js";

const SHOWN_DIGITS = 8;
const shownAs = (value) => (value === null ? "" : String(Number(value.toPrecision(SHOWN_DIGITS))));

/** `setting` is the field's declaration; `label` is for screen readers where no <label> names the field. */
export function NumberField({ field, setting = settingOf(field), value, onValue, step = 1, label }) {
  const [draft, setDraft] = useState(null);
  const mistake = mistakes.value[field];
  const isRefused = refusedFields("start").includes(field);
  // A field that is taken away must not hold the start back.
  useEffect(() => () => setMistake(field, null), [field]);

  const onInput = ({ target }) => {
    const isNone = target.value.trim() === "";
    const typed = isNone ? NaN : Number(target.value);
    const isLeftOut = isNone && setting.default === null;
    const found = isLeftOut ? null : mistakeIn(typed, setting, setting.is_whole);
    setDraft(target.value);
    setMistake(field, found);
    if (!found) onValue(isLeftOut ? null : typed);
  };
  const onBlur = () => {
    setDraft(null);
    setMistake(field, null);
  };
  return html`
    <span class="number">
      <input type="number" inputmode="decimal" id=${`field-${field}`} value=${draft ?? shownAs(value)}
        step=${step} aria-label=${label}
        aria-invalid=${mistake || isRefused ? "true" : undefined}
        aria-describedby=${mistake ? `mistake-${field}` : `help-${field}`}
        onInput=${onInput} onBlur=${onBlur} />
      ${mistake && html`<span class="mistake" role="alert" id=${`mistake-${field}`}>${mistake}</span>`}
    </span>
  `;
}
