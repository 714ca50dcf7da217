// Fields of the form of experiments: text fields that keep what is typed, their mistakes and their help.
import { useState } from "preact/hooks";
import { refusedFields } from "../../../js/actions.js";
import { agentSettings, defaults, enter, parse, values, wrong } from "../form.js";
import { settingOf } from "../../../js/settings.js";
import { html, Mistake } from "../../../js/components/elements.js";
import { helpFor } from "../../../js/components/fields.js";

/** @import { ExperimentValue, SettingOption, SettingValue } from "../../../js/types.js" */

/** The declaration of a field that is a setting, of the chosen agents first. @param {string} field */
export const settingBy = (field) => agentSettings.value[field] ?? settingOf(field);

/** The attributes of a field's control: its id, whether it is marked, and what describes it. @param {string} field */
export const attributesOf = (field) => ({
  id: `experiment-${field}`,
  "aria-invalid": wrong.value[field] || refusedFields("experiment").includes(field) ? "true" : undefined,
  "aria-describedby": wrong.value[field] ? `wrong-${field} about-${field}` : `about-${field}`,
});

/** @param {{ field: string }} props */
export const MistakeOf = ({ field }) => html`<${Mistake} id=${`wrong-${field}`}>${wrong.value[field]?.mistake}<//>`;

/** A sentence below a field. @param {{ field: string }} props */
export const Help = ({ field }) => html`<p class="sentence" id=${`about-${field}`}>${helpFor(field)}</p>`;

/**
 * A text that is a whole number, or a list of values; what is typed stays as it is.
 * @param {{ field: string, text: string, inputmode: string, placeholder?: string }} props
 */
export function TypedInput({ field, text, inputmode, placeholder = undefined }) {
  const [draft, setDraft] = useState(/** @type {string | null} */ (null));
  const isKept = draft !== null && String(parse(field, draft).value) === String(values.value[field]);
  /** @param {{ target: HTMLInputElement }} event */
  const onInput = ({ target }) => {
    setDraft(target.value);
    enter(field, target.value);
  };
  return html`
    <input type="text" inputmode=${inputmode} autocomplete="off" ...${attributesOf(field)}
      value=${wrong.value[field]?.text ?? (isKept ? draft : text)} placeholder=${placeholder} onInput=${onInput} />
  `;
}

/** One whole number. @param {{ field: string }} props */
export const CountInput = ({ field }) =>
  html`<${TypedInput} field=${field} text=${String(values.value[field])} inputmode="numeric" />`;

/** @param {ExperimentValue} list */
export const joined = (list) => /** @type {SettingValue[]} */ (list).join(", ");

/**
 * One value of a setting, or several; none where each agent has its own default.
 * @param {{ field: string, setting: SettingOption }} props
 */
export function ValuesInput({ field, setting }) {
  const isOwn = joined(defaults.value[field]) === "";
  return html`
    <${TypedInput} field=${field} text=${joined(values.value[field])}
      inputmode=${setting.is_number ? "decimal" : "text"} placeholder=${isOwn ? "by default" : undefined} />
  `;
}
