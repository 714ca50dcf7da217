// The settings of a run. Rates also change a training that runs.
import { tune } from "../actions.js";
import { form, setField } from "../form.js";
import { html } from "../html.js";
import { limitsOf, settingOf } from "../limits.js";
import { liveTraining } from "../selectors.js";
import { evaluations, options, rates } from "../store.js";
import { choicesOf, observationTitle } from "../titles.js";
import { GaitPicker } from "./gait-picker.js";
import { MoreSettings } from "./more-settings.js";
import { NumberField } from "./number-field.js";
import { SelectField } from "./select-field.js";
import { Description, SettingHelp, showHelp } from "./setting-help.js";
import { Slider } from "./slider.js";

/** What the slider of the practice reaches, which is less than the server accepts: any other number can be typed. */
const PRACTICE = { min: 50, max: 2000, step: 50 };
const RATE_STEP = 0.01;

/** The ends of a slider: the limits, or the next step to one that is not valid itself. */
function endsOf(field) {
  const { minimum, maximum, excludes_minimum, excludes_maximum } = limitsOf(field);
  const [low, high] = [minimum ?? 0, maximum ?? 1];
  return {
    min: excludes_minimum ? low + RATE_STEP : low,
    max: excludes_maximum ? high - RATE_STEP : high,
    step: RATE_STEP,
  };
}

export const Settings = () => html`
  <div class="settings">
    <${GaitPicker} />
    <div class="sliders">
      <${Slider} field="steps" ...${PRACTICE}
        value=${form.value.steps} onValue=${(value) => setField("steps", value)} />
      <${Rate} field="alpha" />
      <${Rate} field="gamma" />
      <${Exploration} />
    </div>
    <${SettingHelp} />
    <div class="inline-fields">
      <div class="field" onFocusIn=${showHelp("seed")} onPointerEnter=${showHelp("seed")}>
        <label for="field-seed">${settingOf("seed").title}</label>
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
function Rate({ field }) {
  const onValue = (value) => {
    setField(field, value);
    tune({ [field]: value });
  };
  return html`
    <${Slider} field=${field} ...${endsOf(field)} value=${form.value[field]} onValue=${onValue} />
  `;
}

/** ε: the form's first value, or while a training runs its present value, which the form does not keep. */
function Exploration() {
  const run = liveTraining.value;
  if (!run) {
    return html`
      <${Slider} field="epsilon_start" label="Exploration" unit=${`to ${form.value.epsilon_end}`}
        ...${endsOf("epsilon_start")}
        value=${form.value.epsilon_start} onValue=${(value) => setField("epsilon_start", value)} />
    `;
  }
  const scheduled = evaluations.value[run.id]?.at(-1)?.epsilon ?? run.config.epsilon_start;
  const present = rates.value[run.id]?.epsilon ?? scheduled;
  return html`
    <${Slider} field="epsilon" ...${endsOf("epsilon")}
      value=${Math.round(100 * present) / 100} onValue=${(epsilon) => tune({ epsilon })} />
  `;
}
