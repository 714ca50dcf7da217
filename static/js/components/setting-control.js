// The control of a setting of an agent, made from its declaration: a number, a choice, a switch or a text.
import { refusedFields } from "../actions.js";
import { form, setField } from "../form.js";
import { html } from "../html.js";
import { fullTitle, kindOf, sliderOf, valueOf } from "../settings.js";
import { NumberField } from "./number-field.js";
import { Description, showHelp } from "./setting-help.js";

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
