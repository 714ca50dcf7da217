// The settings of a run. Those of the learner that are live also change a training that runs.
import { tune } from "../actions.js";
import { agentOf, beginningOf, learners, mainSettings } from "../agents.js";
import { chooseLearner, form, setField } from "../form.js";
import { html } from "../html.js";
import { settingOf } from "../limits.js";
import { liveTraining } from "../selectors.js";
import { kindOf, quantityOf, sliderOf } from "../settings.js";
import { evaluations, options, rates } from "../store.js";
import { choicesOf, observationTitle } from "../titles.js";
import { GaitPicker } from "./gait-picker.js";
import { MoreSettings } from "./more-settings.js";
import { NumberField } from "./number-field.js";
import { SelectField } from "./select-field.js";
import { SettingRow } from "./setting-control.js";
import { Description, SettingHelp, showHelp } from "./setting-help.js";
import { Slider } from "./slider.js";

/** What the slider of the practice reaches, which is less than the server accepts: any other number can be typed. */
const PRACTICE = { min: 50, max: 2000, step: 50 };

export const Settings = () => html`
  <div class="settings">
    <${GaitPicker} />
    <div class="sliders">
      <${Learner} />
      <${Slider} field="steps" ...${PRACTICE}
        value=${form.value.steps} onValue=${(value) => setField("steps", value)} />
      <${LearnerSettings} />
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

const Learner = () => html`
  <${SelectField} field="agent" label="Learner" onValue=${chooseLearner}
    choices=${learners.value.map(({ name, title }) => [name, title])} />
`;

/**
 * The main settings of the learner. While a training runs, its live settings that the form does not keep take the
 * places of those they replace.
 */
function LearnerSettings() {
  const run = liveTraining.value;
  const live = run ? agentOf(run.config.agent).live_settings : {};
  const main = mainSettings(form.value.agent);
  const acting = main.map((one) => one.live);
  const others = Object.keys(live).filter((name) => !acting.includes(name));
  return [
    ...main.map((one) => (one.live && one.live !== one.name && one.live in live
      ? html`<${Present} key=${one.live} name=${one.live} setting=${live[one.live]} run=${run} />`
      : html`<${Chosen} key=${one.name} one=${one} isLive=${one.name in live} />`)),
    ...others.map((name) => html`<${Present} key=${name} name=${name} setting=${live[name]} run=${run} />`),
  ];
}

/** A setting of the form, and of the training that runs if it is live there. */
function Chosen({ one: { name, setting, end }, isLive }) {
  const onValue = (value) => {
    setField(name, value);
    if (isLive) tune({ [name]: value });
  };
  const words = end ? { title: quantityOf(setting.title), unit: `to ${form.value[end]}` } : {};
  return html`<${Row} name=${name} setting=${setting} ...${words} value=${form.value[name]} onValue=${onValue} />`;
}

/** A setting of the training that runs with its present value, which the form does not keep. */
function Present({ name, setting, run }) {
  const { id, config } = run;
  const { step } = sliderOf(setting) ?? { step: 0 };
  const scheduled = evaluations.value[id]?.at(-1)?.[name] ?? beginningOf(config.agent, name, config);
  const rounded = step && typeof scheduled === "number" ? Math.round(scheduled / step) * step : scheduled;
  const value = rates.value[id]?.[name] ?? rounded;
  return html`<${Row} name=${name} setting=${setting} value=${value} onValue=${(one) => tune({ [name]: one })} />`;
}

/** A slider for a number with both limits, else the setting's own control. */
function Row({ name, setting, ...rest }) {
  const ends = kindOf(setting) === "number" ? sliderOf(setting) : null;
  return ends
    ? html`<${Slider} field=${name} setting=${setting} ...${ends} ...${rest} />`
    : html`<${SettingRow} name=${name} setting=${setting} ...${rest} />`;
}
