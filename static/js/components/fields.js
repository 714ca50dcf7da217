// Fields of the form: numbers, sliders, lists, the controls that settings declare, and their help.
import { signal } from "@preact/signals";
import { useEffect, useState } from "preact/hooks";
import { refusedFields } from "../actions.js";
import { form, mistakes, setField, setMistake } from "../form.js";
import { shareOf } from "../scale.js";
import { agentOf, fullTitle, kindOf, mistakeIn, settingOf, sliderOf, valueOf } from "../settings.js";
import { options } from "../store.js";
import { html } from "./elements.js";

// ---- help: visible for the field in use, for screen readers at each

export const helpFor = (field) => options.value?.help[field] ?? "";

/** The field whose help is visible, and its words where the field alone does not tell them. */
const shown = signal({ field: "gait", words: "" });

export const showHelp = (field, words = "") => () => (shown.value = { field, words });

/** The sentence that a field's `aria-describedby` names. */
export const Description = ({ field, id = field, words = helpFor(field) }) =>
  html`<span class="sr-only" id=${`help-${id}`}>${words}</span>`;

/** The help of the field in use; of the gait and the learner, the description of the one that is chosen. */
export function SettingHelp() {
  const { field, words } = shown.value;
  const { gait, agent } = form.value;
  const chosen = {
    gait: options.value?.gaits.find(({ name }) => name === gait)?.description,
    agent: agentOf(agent).description,
  };
  return html`<p class="setting-help" aria-hidden="true">${words || chosen[field] || helpFor(field)}</p>`;
}

// ---- a number to type; it takes effect as soon as it is valid, until then the reason is shown

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

// ---- a number as a slider and a text field

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

// ---- a choice out of a list

/** `choices`: [value, title]; `onValue` replaces setting the form's field. */
export function SelectField({
  field, label, choices, value = form.value[field], onValue = (chosen) => setField(field, chosen),
}) {
  const help = showHelp(field);
  const onChange = ({ target }) => onValue(choices.find(([one]) => String(one) === target.value)[0]);
  return html`
    <div class="field" onFocusIn=${help} onPointerEnter=${help}>
      <label for=${`field-${field}`}>${label}</label>
      <select id=${`field-${field}`} aria-describedby=${`help-${field}`} onChange=${onChange}>
        ${choices.map(([one, title]) => html`
          <option value=${String(one)} selected=${String(one) === String(value)}>${title}</option>
        `)}
      </select>
      <${Description} field=${field} />
    </div>
  `;
}

// ---- the control that a setting's declaration asks for: a number, a choice, a switch or a text

/** A setting among the fields that are seldom changed, with its help below it. */
export const SettingField = ({ name, setting }) => html`
  <div class="field">
    <label for=${`field-${name}`}>${fullTitle(setting)}</label>
    <${SettingControl} name=${name} setting=${setting} value=${form.value[name]}
      onValue=${(value) => setField(name, value)} />
    <p class="sentence" aria-hidden="true">${setting.help}</p>
    <${Description} field=${name} words=${setting.help} />
  </div>
`;

/** A setting without a slider in a row among the sliders. */
export function SettingRow({ name, setting, value, onValue }) {
  const { title, symbol, unit, help } = setting;
  const show = showHelp(name, help);
  return html`
    <div class="slider" onFocusIn=${show} onPointerEnter=${show}>
      <label for=${`field-${name}`} title=${title}>${title} ${symbol && html`<b>${symbol}</b>`}</label>
      <div class="control">
        <${SettingControl} name=${name} setting=${setting} value=${value} onValue=${onValue} />
      </div>
      <span class="unit">${unit}</span>
      <${Description} field=${name} words=${help} />
    </div>
  `;
}

function NumberControl({ name, setting, value, onValue }) {
  const step = sliderOf(setting)?.step ?? (setting.is_whole ? 1 : "any");
  return html`<${NumberField} field=${name} setting=${setting} value=${value} onValue=${onValue} step=${step} />`;
}

const attributes = (name) => ({
  id: `field-${name}`,
  "aria-describedby": `help-${name}`,
  "aria-invalid": refusedFields("start").includes(name) ? "true" : undefined,
});

const Choice = ({ name, setting: { choices }, value, onValue }) => html`
  <select ...${attributes(name)} onChange=${({ target }) => onValue(target.value)}>
    ${!choices.includes(value) && html`<option value="" selected disabled>choose</option>`}
    ${choices.map((one) => html`<option value=${one} selected=${one === value}>${one}</option>`)}
  </select>
`;

const Switch = ({ name, value, onValue }) => html`
  <input type="checkbox" ...${attributes(name)} checked=${value} onChange=${({ target }) => onValue(target.checked)} />
`;

const Text = ({ name, setting, value, onValue }) => html`
  <input type="text" ...${attributes(name)} value=${value ?? ""} placeholder=${setting.valid}
    onChange=${({ target }) => onValue(valueOf(target.value, setting) ?? target.value)} />
`;

const CONTROLS = { number: NumberControl, choice: Choice, switch: Switch, text: Text };

const SettingControl = ({ setting, ...rest }) =>
  html`<${CONTROLS[kindOf(setting)]} setting=${setting} ...${rest} />`;
