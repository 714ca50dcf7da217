// Everything that can be set before a run; the rates also while it runs.
import { tune } from "../actions.js";
import { form, set } from "../form.js";
import { html } from "../html.js";
import { liveTraining } from "../selectors.js";
import { evaluations, options, rates } from "../store.js";
import { GaitPicker } from "./gait-picker.js";
import { MoreSettings } from "./more-settings.js";
import { NumberField } from "./number-field.js";
import { SelectField } from "./select-field.js";
import { Description, SettingHelp, showHelp } from "./setting-help.js";
import { Slider } from "./slider.js";

const OBSERVATIONS = ["measured", "commanded"];

export const Settings = () => html`
  <div class="settings">
    <${GaitPicker} />
    <div class="sliders">
      <${Slider} field="steps" label="Practice" min=${50} max=${2000} step=${50} unit="steps"
        value=${form.value.steps} onValue=${(value) => set("steps", value)} />
      <${Rate} field="alpha" label="Learning rate" symbol="α" min=${0.01} />
      <${Rate} field="gamma" label="Looking ahead" symbol="γ" max=${0.99} />
      <${Exploration} />
    </div>
    <${SettingHelp} />
    <div class="inline-fields">
      <div class="field" onFocusIn=${showHelp("seed")} onPointerEnter=${showHelp("seed")}>
        <label for="field-seed">Seed</label>
        <${NumberField} field="seed" value=${form.value.seed} onValue=${(value) => set("seed", value)} />
        <${Description} field="seed" />
      </div>
      <${SelectField} field="observation" label="Observation" choices=${observations()} />
    </div>
    <${MoreSettings} />
  </div>
`;

const observations = () => {
  const known = options.value?.observations?.map((one) => one.name ?? one) ?? OBSERVATIONS;
  return known.map((name) => [name, name]);
};

/** α or γ: of the form, and at once of the training that runs. */
function Rate({ field, label, symbol, min = 0, max = 1 }) {
  const onValue = (value) => {
    set(field, value);
    tune({ [field]: value });
  };
  return html`
    <${Slider} field=${field} label=${label} symbol=${symbol} min=${min} max=${max} step=${0.01}
      value=${form.value[field]} onValue=${onValue} />
  `;
}

/** ε: where it starts; while a training runs, where it is, which is no business of the form's. */
function Exploration() {
  const run = liveTraining.value;
  if (!run) {
    return html`
      <${Slider} field="epsilon_start" label="Exploring" symbol="ε" unit=${`to ${form.value.epsilon_end}`}
        min=${0} max=${1} step=${0.01}
        value=${form.value.epsilon_start} onValue=${(value) => set("epsilon_start", value)} />
    `;
  }
  const scheduled = evaluations.value[run.id]?.at(-1)?.epsilon ?? run.config.epsilon_start;
  return html`
    <${Slider} field="epsilon" label="Exploring now" symbol="ε" min=${0} max=${1} step=${0.01}
      value=${Math.round(100 * (rates.value[run.id]?.epsilon ?? scheduled)) / 100} onValue=${(epsilon) => tune({ epsilon })} />
  `;
}
