// Fields of the form: numbers, sliders, lists, the controls that settings declare, and their help. What is typed
// stays as it is; while it is not valid, the field says why.
import { useState } from "preact/hooks";
import { refusedFields } from "../actions.js";
import { enter, form, setField, wrong } from "../form.js";
import { parseSetting } from "../parse.js";
import { shareOf } from "../scale.js";
import {
  bounded, choiceTitle, closesSome, fullTitle, isAllowed, isClosed, isLifted, kindOf, restriction, settingOf, sliderOf,
} from "../settings.js";
import { options } from "../store.js";
import { html, Mistake } from "./elements.js";

/** @import { Changed, FormValue, SettingOption, SettingValue } from "../types.js" */

/**
 * A field that is disabled where a restriction closes it.
 * @param {string} field
 * @param {import("preact").ComponentChildren} drawn
 * @param {boolean} [isOfForm]
 */
export const closable = (field, drawn, isOfForm = true) => (isOfForm && isClosed(field)
  ? html`<fieldset class="closed" disabled>${drawn}</fieldset>`
  : drawn);

/** What a restriction closes, and the way out. @param {{ what?: string }} props */
export const Restricted = ({ what = "what is grey" }) => closesSome.value && html`
  <div class="steering" role="note">
    <p>${restriction.value?.reason} ${what}. Nothing is locked here.</p>
    <button type="button" class="link" onClick=${() => (isLifted.value = true)}>Open all settings</button>
  </div>
`;

// ---- help: a sentence below each field

/** @param {string} field */
export const helpFor = (field) => options.value?.help[field] ?? "";

/** The sentence that a field's `aria-describedby` names. @param {{ field: string, words?: string }} props */
export const Description = ({ field, words = helpFor(field) }) =>
  html`<p class="sentence" id=${`help-${field}`}>${words}</p>`;

/**
 * The attributes of a field's control: its id, whether it is marked, and what describes it.
 * @param {string} field
 * @param {string | null} [mistake] why it is not valid
 */
export const attributesOf = (field, mistake = wrong.value[field]?.mistake) => ({
  id: `field-${field}`,
  "aria-invalid": mistake || refusedFields("start").includes(field) ? "true" : undefined,
  "aria-describedby": mistake ? `mistake-${field} help-${field}` : `help-${field}`,
});

/** Why a field of the form is not valid, if it is not. @param {{ field: string, mistake?: string }} props */
export const MistakeOf = ({ field, mistake = wrong.value[field]?.mistake }) =>
  html`<${Mistake} id=${`mistake-${field}`}>${mistake}<//>`;

// ---- a number to type; it takes effect as soon as it is valid

/** A sum without the digits that binary fractions add: 0.3, not 0.30000000000000004. */
const SUM_DIGITS = 12;

/** @type {Record<string, number>} */
const DIRECTIONS = { ArrowUp: 1, ArrowDown: -1 };

/**
 * The text of a number's field, and why it is not valid.
 * @param {string} field
 * @param {SettingOption} setting
 * @param {{ value: FormValue, draft: string | null, isOfForm: boolean }} typed
 */
function shownIn(field, setting, { value, draft, isOfForm }) {
  const invalid = isOfForm ? wrong.value[field] : undefined;
  if (invalid) return invalid;
  const read = draft === null ? null : parseSetting(draft, setting);
  if (read && read.mistake !== undefined && !isOfForm) return { text: draft, mistake: read.mistake };
  // Typed text is replaced only when the value has become another one, by a slider or a link.
  const isValue = read !== null && read.mistake === undefined && read.value === value;
  return { text: isValue ? draft : String(value ?? ""), mistake: null };
}

/**
 * A text field, because one of type "number" drops what it cannot read; arrow keys step its value. `setting` is the
 * declaration; `label` is for screen readers where no <label> names the field. One that is not `isOfForm` keeps to
 * itself what is typed, until it is valid.
 * @param {object} props
 * @param {string} props.field
 * @param {SettingOption} [props.setting]
 * @param {FormValue} props.value
 * @param {(value: FormValue) => unknown} props.onValue
 * @param {number} [props.step]
 * @param {string} props.label
 * @param {boolean} [props.isOfForm]
 * @param {boolean} [props.isDisabled]
 */
export function NumberField({
  field, setting: declared = settingOf(field), value, onValue, step = 1, label, isOfForm = true, isDisabled = false,
}) {
  const setting = isOfForm ? bounded(field, declared) : declared;
  const [draft, setDraft] = useState(/** @type {string | null} */ (null));
  const { text, mistake } = shownIn(field, setting, { value, draft, isOfForm });
  /** @param {string} typed */
  const take = (typed) => {
    setDraft(typed);
    const parsed = parseSetting(typed, setting);
    if (parsed.mistake === undefined) onValue(parsed.value);
    else if (isOfForm) enter(field, typed);
  };
  return html`
    <${NumberInput} attributes=${attributesOf(field, mistake)} setting=${setting} value=${value} text=${text}
      isWrong=${mistake !== null} step=${step} label=${label} isDisabled=${isDisabled} onText=${take} />
    <${MistakeOf} field=${field} mistake=${mistake} />
  `;
}

/**
 * The text field of a number, with the text that it shows; what is typed, or stepped to, is told as a text.
 * @param {object} props
 * @param {object} props.attributes
 * @param {SettingOption} props.setting
 * @param {FormValue} props.value
 * @param {string} props.text
 * @param {boolean} props.isWrong
 * @param {number} props.step
 * @param {string} [props.label]
 * @param {boolean} [props.isDisabled]
 * @param {(text: string) => unknown} props.onText
 */
export function NumberInput({
  attributes, setting, value, text, isWrong, step, label, isDisabled = false, onText,
}) {
  /** @param {KeyboardEvent} event */
  const onKeyDown = (event) => {
    const direction = DIRECTIONS[event.key];
    if (!direction || event.altKey || event.ctrlKey || event.metaKey) return;
    event.preventDefault();
    if (isWrong || typeof value !== "number") return;
    const next = String(Number((value + direction * step).toPrecision(SUM_DIGITS)));
    if (parseSetting(next, setting).mistake === undefined) onText(next);
  };
  return html`
    <span class="number">
      <input type="text" role="spinbutton" inputmode=${setting.is_whole ? "numeric" : "decimal"} autocomplete="off"
        ...${attributes} value=${text} disabled=${isDisabled} aria-label=${label} aria-valuetext=${text || "empty"}
        aria-valuenow=${value} aria-valuemin=${setting.minimum} aria-valuemax=${setting.maximum}
        onInput=${(/** @type {Changed} */ { target }) => onText(target.value)} onKeyDown=${onKeyDown} />
    </span>
  `;
}

// ---- a number as a slider and a text field

/**
 * `setting` is the field's declaration, of which `title` and `unit` replace the words. `min` and `max` are the
 * slider's ends; the text field accepts what the server does.
 * @param {object} props
 * @param {string} props.field
 * @param {SettingOption} [props.setting]
 * @param {string} props.title
 * @param {string | null} props.unit
 * @param {number | null} props.value
 * @param {(value: FormValue) => unknown} props.onValue
 * @param {number} props.min
 * @param {number} props.max
 * @param {number} props.step
 * @param {boolean} [props.isOfForm]
 */
export function Slider({
  field, setting = settingOf(field), title, unit, value, onValue, min: from, max: to, step, isOfForm = true,
}) {
  const { symbol, help } = setting;
  const { minimum, maximum } = isOfForm ? bounded(field, setting) : setting;
  const [min, max] = [Math.max(from, minimum ?? from), Math.min(to, maximum ?? to)];
  const name = title ?? setting.title;
  const reached = Math.min(Math.max(value ?? min, min), max);
  return closable(field, html`
    <div class="slider">
      <label for=${`slide-${field}`} title=${name}>${name} ${symbol && html`<b>${symbol}</b>`}</label>
      <input type="range" id=${`slide-${field}`} min=${min} max=${max} step=${step}
        value=${reached} style=${{ "--share": `${100 * shareOf(reached, min, max)}%` }}
        aria-describedby=${`help-${field}`}
        onInput=${(/** @type {Changed} */ { target }) => onValue(Number(target.value))} />
      <${NumberField} field=${field} setting=${setting} value=${value} onValue=${onValue} step=${step}
        label=${`${name}, as a number`} isOfForm=${isOfForm} />
      <span class="unit">${unit ?? setting.unit}</span>
      <${Description} field=${field} words=${help} />
    </div>
  `, isOfForm);
}

// ---- a choice out of a list

/**
 * `choices`: [value, title]; `value` and `onValue` replace the form's field, `words` its help.
 * @param {object} props
 * @param {string} props.field
 * @param {string} props.label
 * @param {[string, string][]} props.choices
 * @param {FormValue} [props.value]
 * @param {(value: FormValue) => unknown} [props.onValue]
 * @param {string} [props.words] "" leaves the help out
 */
export function SelectField({
  field, label, choices, value = form.value[field], onValue = (chosen) => setField(field, chosen), words,
}) {
  const invalid = wrong.value[field];
  /** @param {{ target: HTMLSelectElement }} event */
  const onChange = ({ target }) => onValue(choices.find(([choice]) => textOf(choice) === target.value)?.[0] ?? null);
  return closable(field, html`
    <div class="field">
      <label for=${`field-${field}`}>${label}</label>
      <select ...${attributesOf(field)} onChange=${onChange}>
        ${invalid && html`<${InvalidOption} text=${invalid.text} />`}
        ${choices.filter(([choice]) => isAllowed(field, choice)).map(([choice, title]) => html`
          <option value=${textOf(choice)} selected=${!invalid && textOf(choice) === textOf(value)}>${title}</option>
        `)}
      </select>
      <${MistakeOf} field=${field} />
      ${words !== "" && html`<${Description} field=${field} words=${words || helpFor(field)} />`}
    </div>
  `);
}

/** The choice that a link made and that is none; it cannot be chosen again. @param {{ text: string }} props */
const InvalidOption = ({ text }) => html`
  <option value=${text} selected disabled>${text || "(empty)"}: not valid</option>
`;

/** The value of a choice as an option's text; a custom robot is an object. @param {FormValue} value */
const textOf = (value) => (typeof value === "object" ? JSON.stringify(value) : String(value));

// ---- the control that a setting's declaration asks for: a number, a choice, a switch or a text

/**
 * A setting among the fields that are seldom changed, with its help below it.
 * @param {{ name: string, setting: SettingOption }} props
 */
export const SettingField = ({ name, setting }) => closable(name, html`
  <div class="field">
    <label for=${`field-${name}`}>${fullTitle(setting)}</label>
    <${SettingControl} name=${name} setting=${setting} value=${form.value[name]} isOfForm=${true}
      onValue=${(/** @type {SettingValue} */ value) => setField(name, value)} />
    <${Description} field=${name} words=${setting.help} />
  </div>
`);

/**
 * A setting without a slider in a row among the sliders.
 * @param {object} props
 * @param {string} props.name
 * @param {SettingOption} props.setting
 * @param {FormValue} props.value
 * @param {(value: FormValue) => unknown} props.onValue
 * @param {boolean} [props.isOfForm]
 */
export function SettingRow({ name, setting, value, onValue, isOfForm = true }) {
  const { title, symbol, unit, help } = setting;
  return closable(name, html`
    <div class="slider">
      <label for=${`field-${name}`} title=${title}>${title} ${symbol && html`<b>${symbol}</b>`}</label>
      <div class="control">
        <${SettingControl} name=${name} setting=${setting} value=${value} onValue=${onValue} isOfForm=${isOfForm} />
      </div>
      <span class="unit">${unit}</span>
      <${Description} field=${name} words=${help} />
    </div>
  `, isOfForm);
}

/** @param {{ name: string, setting: SettingOption } & { [prop: string]: unknown }} props */
function NumberControl({ name, setting, ...rest }) {
  const step = sliderOf(setting)?.step ?? 1;
  return html`<${NumberField} field=${name} setting=${setting} step=${step} ...${rest} />`;
}

/**
 * @typedef {{ name: string, setting: SettingOption, value: FormValue, onValue: (value: FormValue) => unknown }} Control
 */

/** @param {Control} props */
function Choice({ name, setting, value, onValue }) {
  const { choices, default: first } = bounded(name, setting);
  const invalid = wrong.value[name];
  return html`
    <select ...${attributesOf(name)} onChange=${(/** @type {Changed} */ { target }) => onValue(target.value || null)}>
      ${invalid && html`<${InvalidOption} text=${invalid.text} />`}
      ${first === null && html`<option value="" selected=${!invalid && value === null}>by default</option>`}
      ${first !== null && !invalid && !choices.includes(String(value)) && html`
        <option value="" selected disabled>choose</option>
      `}
      ${choices.map((choice) => html`
        <option value=${choice} selected=${!invalid && choice === value}>${choiceTitle(setting, choice)}</option>
      `)}
    </select>
    <${MistakeOf} field=${name} />
  `;
}

/** @param {{ name: string, value: FormValue, onValue: (value: FormValue) => unknown }} props */
const Switch = ({ name, value, onValue }) => html`
  <input type="checkbox" ...${attributesOf(name)} checked=${value}
    onChange=${(/** @type {Changed} */ { target }) => onValue(target.checked)} />
  <${MistakeOf} field=${name} />
`;

/**
 * A text, or a number or one of some words. Text takes effect when it has been typed.
 * @param {object} props
 * @param {string} props.name
 * @param {SettingOption} props.setting
 * @param {FormValue} props.value
 * @param {(value: FormValue) => unknown} props.onValue
 * @param {boolean} props.isOfForm
 */
function Text({ name, setting, value, onValue, isOfForm }) {
  /** @param {{ target: HTMLSelectElement }} event */
  const onChange = ({ target }) => {
    const { value: parsed, mistake } = parseSetting(target.value, setting);
    if (mistake === undefined) onValue(parsed);
    else if (isOfForm) enter(name, target.value);
  };
  return html`
    <input type="text" ...${attributesOf(name)} value=${wrong.value[name]?.text ?? value ?? ""}
      placeholder=${setting.valid} onChange=${onChange} />
    <${MistakeOf} field=${name} />
  `;
}

const CONTROLS = { number: NumberControl, choice: Choice, switch: Switch, text: Text };

/** @param {{ setting: SettingOption } & { [prop: string]: unknown }} props */
const SettingControl = ({ setting, ...rest }) =>
  html`<${CONTROLS[kindOf(setting)]} setting=${setting} ...${rest} />`;
