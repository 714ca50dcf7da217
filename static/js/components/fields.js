// Fields of the form: numbers, sliders, lists, the controls that settings declare, and their help. What is typed
// stays as it is; while it is not valid, the field says why.
import { useState } from "preact/hooks";
import { refusedFields } from "../actions.js";
import { enter, form, setField, wrong } from "../form.js";
import { parseSetting } from "../parse.js";
import { shareOf } from "../scale.js";
import { choiceTitle, fullTitle, kindOf, settingOf, sliderOf } from "../settings.js";
import { options } from "../store.js";
import { html, Mistake } from "./elements.js";

// ---- help: a sentence below each field

export const helpFor = (field) => options.value?.help[field] ?? "";

/** The sentence that a field's `aria-describedby` names. */
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

/** Why a field of the form is not valid, if it is not. */
export const MistakeOf = ({ field, mistake = wrong.value[field]?.mistake }) =>
  html`<${Mistake} id=${`mistake-${field}`}>${mistake}<//>`;

// ---- a number to type; it takes effect as soon as it is valid

/** A sum without the digits that binary fractions add: 0.3, not 0.30000000000000004. */
const SUM_DIGITS = 12;

/** @type {Record<string, number>} */
const DIRECTIONS = { ArrowUp: 1, ArrowDown: -1 };

/** The text of a number's field, and why it is not valid. */
function shownIn(field, setting, { value, draft, isOfForm }) {
  const kept = isOfForm ? wrong.value[field] : undefined;
  if (kept) return kept;
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
 */
export function NumberField({
  field, setting = settingOf(field), value, onValue, step = 1, label, isOfForm = true, isDisabled = false,
}) {
  const [draft, setDraft] = useState(/** @type {string | null} */ (null));
  const { text, mistake } = shownIn(field, setting, { value, draft, isOfForm });
  const take = (typed) => {
    setDraft(typed);
    const parsed = parseSetting(typed, setting);
    if (parsed.mistake === undefined) onValue(parsed.value);
    else if (isOfForm) enter(field, typed);
  };
  const onKeyDown = (event) => {
    const direction = DIRECTIONS[event.key];
    if (!direction || event.altKey || event.ctrlKey || event.metaKey) return;
    event.preventDefault();
    if (mistake || typeof value !== "number") return;
    const next = String(Number((value + direction * step).toPrecision(SUM_DIGITS)));
    if (parseSetting(next, setting).mistake === undefined) take(next);
  };
  return html`
    <span class="number">
      <input type="text" role="spinbutton" inputmode=${setting.is_whole ? "numeric" : "decimal"} autocomplete="off"
        ...${attributesOf(field, mistake)} value=${text} disabled=${isDisabled} aria-label=${label}
        aria-valuetext=${text || "empty"}
        aria-valuenow=${value} aria-valuemin=${setting.minimum} aria-valuemax=${setting.maximum}
        onInput=${({ target }) => take(target.value)} onKeyDown=${onKeyDown} />
    </span>
    <${MistakeOf} field=${field} mistake=${mistake} />
  `;
}

// ---- a number as a slider and a text field

/**
 * `setting` is the field's declaration, of which `title` and `unit` replace the words. `min` and `max` are the
 * slider's ends; the text field accepts what the server does.
 */
export function Slider({
  field, setting = settingOf(field), title, unit, value, onValue, min, max, step, isOfForm = true,
}) {
  const { symbol, help } = setting;
  const name = title ?? setting.title;
  const reached = Math.min(Math.max(value ?? min, min), max);
  return html`
    <div class="slider">
      <label for=${`slide-${field}`} title=${name}>${name} ${symbol && html`<b>${symbol}</b>`}</label>
      <input type="range" id=${`slide-${field}`} min=${min} max=${max} step=${step}
        value=${reached} style=${{ "--share": `${100 * shareOf(reached, min, max)}%` }}
        aria-describedby=${`help-${field}`}
        onInput=${({ target }) => onValue(Number(target.value))} />
      <${NumberField} field=${field} setting=${setting} value=${value} onValue=${onValue} step=${step}
        label=${`${name}, as a number`} isOfForm=${isOfForm} />
      <span class="unit">${unit ?? setting.unit}</span>
      <${Description} field=${field} words=${help} />
    </div>
  `;
}

// ---- a choice out of a list

/** `choices`: [value, title]; `value` and `onValue` replace the form's field, `words` its help. */
export function SelectField({
  field, label, choices, value = form.value[field], onValue = (chosen) => setField(field, chosen), words,
}) {
  const kept = wrong.value[field];
  const onChange = ({ target }) => onValue(choices.find(([one]) => textOf(one) === target.value)[0]);
  return html`
    <div class="field">
      <label for=${`field-${field}`}>${label}</label>
      <select ...${attributesOf(field)} onChange=${onChange}>
        ${kept && html`<${InvalidOption} text=${kept.text} />`}
        ${choices.map(([one, title]) => html`
          <option value=${textOf(one)} selected=${!kept && textOf(one) === textOf(value)}>${title}</option>
        `)}
      </select>
      <${MistakeOf} field=${field} />
      <${Description} field=${field} words=${words || helpFor(field)} />
    </div>
  `;
}

/** The choice that a link made and that is none; it cannot be chosen again. */
const InvalidOption = ({ text }) => html`
  <option value=${text} selected disabled>${text || "(empty)"}: not valid</option>
`;

/** The value of a choice as an option's text; a custom robot is an object. */
const textOf = (value) => (typeof value === "object" ? JSON.stringify(value) : String(value));

// ---- the control that a setting's declaration asks for: a number, a choice, a switch or a text

/** A setting among the fields that are seldom changed, with its help below it. */
export const SettingField = ({ name, setting }) => html`
  <div class="field">
    <label for=${`field-${name}`}>${fullTitle(setting)}</label>
    <${SettingControl} name=${name} setting=${setting} value=${form.value[name]} isOfForm=${true}
      onValue=${(value) => setField(name, value)} />
    <${Description} field=${name} words=${setting.help} />
  </div>
`;

/** A setting without a slider in a row among the sliders. */
export function SettingRow({ name, setting, value, onValue, isOfForm = true }) {
  const { title, symbol, unit, help } = setting;
  return html`
    <div class="slider">
      <label for=${`field-${name}`} title=${title}>${title} ${symbol && html`<b>${symbol}</b>`}</label>
      <div class="control">
        <${SettingControl} name=${name} setting=${setting} value=${value} onValue=${onValue} isOfForm=${isOfForm} />
      </div>
      <span class="unit">${unit}</span>
      <${Description} field=${name} words=${help} />
    </div>
  `;
}

function NumberControl({ name, setting, ...rest }) {
  const step = sliderOf(setting)?.step ?? 1;
  return html`<${NumberField} field=${name} setting=${setting} step=${step} ...${rest} />`;
}

function Choice({ name, setting, value, onValue }) {
  const { choices, default: first } = setting;
  const kept = wrong.value[name];
  return html`
    <select ...${attributesOf(name)} onChange=${({ target }) => onValue(target.value || null)}>
      ${kept && html`<${InvalidOption} text=${kept.text} />`}
      ${first === null && html`<option value="" selected=${!kept && value === null}>by default</option>`}
      ${first !== null && !kept && !choices.includes(value) && html`
        <option value="" selected disabled>choose</option>
      `}
      ${choices.map((one) => html`
        <option value=${one} selected=${!kept && one === value}>${choiceTitle(setting, one)}</option>
      `)}
    </select>
    <${MistakeOf} field=${name} />
  `;
}

const Switch = ({ name, value, onValue }) => html`
  <input type="checkbox" ...${attributesOf(name)} checked=${value}
    onChange=${({ target }) => onValue(target.checked)} />
  <${MistakeOf} field=${name} />
`;

/** A text, or a number or one of some words. Text takes effect when it has been typed. */
function Text({ name, setting, value, onValue, isOfForm }) {
  const onChange = ({ target }) => {
    const { value: found, mistake } = parseSetting(target.value, setting);
    if (mistake === undefined) onValue(found);
    else if (isOfForm) enter(name, target.value);
  };
  return html`
    <input type="text" ...${attributesOf(name)} value=${wrong.value[name]?.text ?? value ?? ""}
      placeholder=${setting.valid} onChange=${onChange} />
    <${MistakeOf} field=${name} />
  `;
}

const CONTROLS = { number: NumberControl, choice: Choice, switch: Switch, text: Text };

const SettingControl = ({ setting, ...rest }) =>
  html`<${CONTROLS[kindOf(setting)]} setting=${setting} ...${rest} />`;
