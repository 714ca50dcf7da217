// The settings of a run. Rates also change a training that runs.
import { tune } from "../actions.js";
import { form, setField } from "../form.js";
import { html } from "../html.js";
import { liveTraining } from "../selectors.js";
import { evaluations, options, rates } from "../store.js";
import { choicesOf, observationTitle } from "../titles.js";
import { GaitPicker } from "./gait-picker.js";
import { MoreSettings } from "./more-settings.js";
import { NumberField } from "./number-field.js";
import { SelectField } from "./select-field.js";
import { Description, SettingHelp, showHelp } from "./setting-help.js";
import { Slider } from "./slider.js";

/** What a slider reaches, which is less than the server accepts: any other number can be typed. */
const REACH = {
  steps: { min: 50, max: 2000, step: 50 },
  alpha: { min: 0.01, max: 1, step: 0.01 },
  gamma: { min: 0, max: 0.99, step: 0.01 },
  epsilon: { min: 0, max: 1, step: 0.01 },
};

export const Settings = () => html`
  <div class="settings">
    <${GaitPicker} />
    <div class="sliders">
      <${Slider} field="steps" label="Practice" ...${REACH.steps} unit="steps"
        value=${form.value.steps} onValue=${(value) => setField("steps", value)} />
      <${Rate} field="alpha" label="Learning rate" symbol="α" />
      <${Rate} field="gamma" label="Discount" symbol="γ" />
      <${Exploration} />
    </div>
    <${SettingHelp} />
    <div class="inline-fields">
      <div class="field" onFocusIn=${showHelp("seed")} onPointerEnter=${showHelp("seed")}>
        <label for="field-seed">Seed</label>
        <${NumberField} field="seed" value=${form.value.seed} onValue=${(value) => setField("seed", value)} />
        <${Description} field="seed" />
      </div>
      <${SelectField} field="observation" label="Observation"
        choices=${choicesOf(options.value?.observations, observationTitle)} />
    </div>
    <${MoreSettings} />
  </div>
`;

/** α or γ: of the form, and of the training that runs. */
function Rate({ field, label, symbol }) {
  const onValue = (value) => {
    setField(field, value);
    tune({ [field]: value });
  };
  return html`
    <${Slider} field=${field} label=${label} symbol=${symbol} ...${REACH[field]}
      value=${form.value[field]} onValue=${onValue} />
  `;
}

/** ε: the form's first value, or while a training runs its present value, which the form does not keep. */
function Exploration() {
  const run = liveTraining.value;
  if (!run) {
    return html`
      <${Slider} field="epsilon_start" label="Exploration" symbol="ε" unit=${`to ${form.value.epsilon_end}`}
        ...${REACH.epsilon}
        value=${form.value.epsilon_start} onValue=${(value) => setField("epsilon_start", value)} />
    `;
  }
  const scheduled = evaluations.value[run.id]?.at(-1)?.epsilon ?? run.config.epsilon_start;
  const present = rates.value[run.id]?.epsilon ?? scheduled;
  return html`
    <${Slider} field="epsilon" label="Exploration now" symbol="ε" ...${REACH.epsilon}
      value=${Math.round(100 * present) / 100} onValue=${(epsilon) => tune({ epsilon })} />
  `;
}
