// The settings of a run. Those of the learner that are live also change a training that runs.
import { tune } from "../actions.js";
import { presentRates, rateInWords } from "../changes.js";
import { chooseLearner, form, setField } from "../form.js";
import { liveTraining } from "../selectors.js";
import {
  agentOf, beginningOf, fullTitle, furtherSettings, kindOf, learners, limitsOf, mainSettings, quantityOf, settingOf,
  sliderOf,
} from "../settings.js";
import { evaluations, options, served } from "../store.js";
import { choicesOf, observationTitle, robotTitle, simulatorTitle } from "../titles.js";
import { HexapodGlyph, html } from "./elements.js";
import {
  Description, helpFor, NumberField, SelectField, SettingField, SettingHelp, SettingRow, showHelp, Slider,
} from "./fields.js";

/** @import { Run } from "../types.js" */

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
      : html`<${Chosen} key=${one.name} one=${one} run=${one.name in live ? run : null} />`)),
    ...others.map((name) => html`<${Present} key=${name} name=${name} setting=${live[name]} run=${run} />`),
    run && html`<${NextRates} key="next-rates" run=${run} />`,
  ];
}

/** The pace or a live setting now: of the training that runs. @type {(run: Run, name: string) => any} */
const rateNow = (run, name) => presentRates(run)[name] ?? run.config[name];

/** What the next training starts with, where the one that runs has other values. */
function NextRates({ run }) {
  /** @type {Record<string, any>} */
  const values = form.value;
  const live = [...Object.keys(agentOf(run.config.agent).live_settings), "pace"];
  const names = live.filter((name) => name in values);
  const other = names.filter((name) => rateNow(run, name) !== values[name]);
  if (!other.length) return null;
  const words = other.map((name) => rateInWords(values.agent, { name, value: values[name] }));
  return html`<p class="next-rates dim">These are the values of the training that runs. The next one starts with
    ${" "}${words.join(", ")}.</p>`;
}

/** A setting of the form; of the training that runs, if it is live there. */
function Chosen({ one: { name, setting, end }, run }) {
  const onValue = (value) => {
    setField(name, value);
    if (run) tune({ [name]: value });
  };
  const value = run ? rateNow(run, name) : form.value[name];
  const words = end ? { title: quantityOf(setting.title), unit: `to ${form.value[end]}` } : {};
  return html`<${Row} name=${name} setting=${setting} ...${words} value=${value} onValue=${onValue} />`;
}

/** A setting of the training that runs with its present value, which the form does not keep. */
function Present({ name, setting, run }) {
  const { id, config } = run;
  const { step } = sliderOf(setting) ?? { step: 0 };
  const scheduled = evaluations.value[id]?.at(-1)?.[name] ?? beginningOf(config.agent, name, config);
  const rounded = step && typeof scheduled === "number" ? Math.round(scheduled / step) * step : scheduled;
  const value = presentRates(run)[name] ?? rounded;
  return html`<${Row} name=${name} setting=${setting} value=${value} onValue=${(one) => tune({ [name]: one })} />`;
}

/** A slider for a number with both limits, else the setting's own control. */
function Row({ name, setting, ...rest }) {
  const ends = kindOf(setting) === "number" ? sliderOf(setting) : null;
  return ends
    ? html`<${Slider} field=${name} setting=${setting} ...${ends} ...${rest} />`
    : html`<${SettingRow} name=${name} setting=${setting} ...${rest} />`;
}

// ---- the gait, chosen by its drawing

export const GaitPicker = () => html`
  <fieldset onFocusIn=${showHelp("gait")} onPointerEnter=${showHelp("gait")}>
    <legend><h2>Gait</h2></legend>
    <div class="gait-row">
      ${served().gaits.map((gait) => html`
        <label class="gait" key=${gait.name}>
          <input class="sr-only" type="radio" name="gait" value=${gait.name}
            checked=${gait.name === form.value.gait} onChange=${() => setField("gait", gait.name)} />
          <${HexapodGlyph} gait=${gait} />
          <span>${gait.title}</span>
        </label>
      `)}
    </div>
  </fieldset>
`;

// ---- settings that are seldom changed, each with its help

/** Suggestions; a link may contain any other pace that the server accepts. */
const PACES = [
  ["max", "As fast as possible"], [0.5, "Half real time"], [1, "Real time"], [2, "×2"], [4, "×4"], [8, "×8"],
];

export const MoreSettings = () => html`
  <details class="more">
    <summary>More settings</summary>
    <div class="more-fields">
      <${Choice} field="robot" label="Robot" choices=${choicesOf(options.value?.robots, robotTitle)} />
      <${Choice} field="simulator" label="Simulator"
        choices=${choicesOf(options.value?.simulators, simulatorTitle)} />
      <${Pace} />
      <${Figure} field="divisions" />
      <${Figure} field="grid_side_m" step=${0.005} />
      ${furtherSettings(form.value.agent).map(([name, setting]) => html`
        <${SettingField} key=${name} name=${name} setting=${setting} />
      `)}
      <${Figure} field="steps_per_episode" />
      <${Figure} field="evaluate_every" />
      <${Figure} field="race_steps" />
      <${Lanes} />
      <${Name} />
    </div>
  </details>
`;

const Sentence = ({ field }) => html`
  <p class="sentence" aria-hidden="true">${helpFor(field)}</p>
  <${Description} field=${field} />
`;

const Choice = ({ field, ...rest }) => html`
  <div>
    <${SelectField} field=${field} ...${rest} />
    <p class="sentence" aria-hidden="true">${helpFor(field)}</p>
  </div>
`;

function Figure({ field, step }) {
  return html`
    <div class="field">
      <label for=${`field-${field}`}>${fullTitle(settingOf(field))}</label>
      <${NumberField} field=${field} value=${form.value[field]} step=${step}
        onValue=${(value) => setField(field, value)} />
      <${Sentence} field=${field} />
    </div>
  `;
}

function Pace() {
  const run = liveTraining.value;
  const pace = run ? rateNow(run, "pace") : form.value.pace;
  const choices = PACES.some(([one]) => one === pace) ? PACES : [...PACES, [pace, `×${pace}`]];
  const onValue = (value) => {
    setField("pace", value);
    tune({ pace: value });
  };
  return html`<${Choice} field="pace" label=${settingOf("pace").title} choices=${choices} value=${pace}
    onValue=${onValue} />`;
}

function Lanes() {
  const { lanes } = form.value;
  const { minimum, maximum } = limitsOf("lanes");
  const names = (options.value?.agents ?? []).map(({ name }) => name);
  const toggle = (name) => {
    const chosen = lanes.includes(name)
      ? lanes.filter((one) => one !== name)
      : names.filter((one) => one === name || lanes.includes(one));
    const isAllowed = chosen.length >= (minimum ?? 0) && chosen.length <= (maximum ?? Infinity);
    // A copy draws the refused check box again.
    setField("lanes", isAllowed ? chosen : [...lanes]);
  };
  return html`
    <fieldset class="field wide">
      <legend>Lanes</legend>
      <div class="checks">
      ${names.map((name) => html`
        <label class="check">
          <input type="checkbox" checked=${lanes.includes(name)} onChange=${() => toggle(name)} />
          ${agentOf(name).title}
        </label>
      `)}
      </div>
      <${Sentence} field="lanes" />
    </fieldset>
  `;
}

const Name = () => html`
  <div class="field wide">
    <label for="field-name">Name</label>
    <input type="text" id="field-name" maxlength=${limitsOf("name").maximum} value=${form.value.name}
      placeholder="optional" aria-describedby="help-name"
      onInput=${({ target }) => setField("name", target.value)} />
    <${Sentence} field="name" />
  </div>
`;
