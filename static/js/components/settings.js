// The settings of a run. Those of the learner that are live also change a training that runs.
import { tune } from "../live-changes.js";
import { presentRates, rateInWords } from "../training.js";
import { chooseRobot, enter, form, setField, wrong, isReadOnly } from "../form.js";
import { count, listed } from "../format.js";
import { liveTraining, trainingInView } from "../on-stage.js";
import { numberOfLegs } from "../robots.js";
import { isOperator } from "../selectors.js";
import {
  agentOf, beginningOf, fullTitle, furtherSettings, isAllowed, isClosed, kindOf, laneSettings,
  mainSettings, PRACTICE_FIELDS, quantityOf, ROBOT_FIELDS, settingOf, sliderOf,
} from "../settings.js";
import { evaluations, options, served } from "../store.js";
import {
  choicesOf, gaitTitle, labelOf, observationTitle, robotChoices, robotTitle, simulatorTitle,
} from "../titles.js";
import { isAtLeast } from "../workspace.js";
import { Beforehand } from "./beforehand.js";
import { HexapodGlyph, html } from "./elements.js";
import { Slot } from "../features.js";
import {
  attributesOf, closable, Description, MistakeOf, NumberField, SelectField, SettingField, SettingRow, Slider,
} from "./fields.js";
import { Learner } from "./learner.js";
import { Disturbances, WorldPicker } from "./world.js";

/** @import { Changed, Run, SettingOption, SettingValue } from "../types.js" */
/** @import { ComponentChildren } from "preact" */
/** @import { MainSetting } from "../settings.js" */

/** Ends of the slider of the practice, at most less than the server accepts: any other number can be typed. */
export const PRACTICE = { min: 50, max: 2000, step: 50 };

/**
 * Settings of the next training and race: what those who try change, and for those who study all of them. A spectator
 * reads those of the run that is shown.
 */
export function TrainSettings() {
  const isFull = isAtLeast("study");
  return html`
    <fieldset class="settings" disabled=${isReadOnly.value} aria-label="Settings">
      <div class="sliders">
        <${Learner} />
        <${PracticeSteps} />
        <${LearnerSettings} />
      </div>
      ${!isFull && html`
        <div class="inline-fields">
          <${RobotField} words="" />
          <${SelectField} field="world" label="World" words=""
            choices=${served().worlds.map(({ name, title }) => [name, title])} />
        </div>
      `}
      ${isFull && robotLine(html`<span class="dim">Robot</span><b>${robotTitle(form.value.robot)}</b>`)}
      <${GaitPicker} />
      ${isFull && html`
        <${SeedAndObservation} />
        <${Group} title="More settings" chosen=${[form.value.name]} fields=${furtherFields()}><${MoreSettings} /><//>
        <${Group} title="Race" chosen=${raceChosen()} fields=${raceFields()}><${RaceGroup} /><//>
      `}
    </fieldset>
  `;
}

/** Settings of the world and the robot: the worlds as pictures, and for those who study what happens, and the robot. */
export const WorldSettings = () => html`
  <fieldset class="settings" disabled=${isReadOnly.value} aria-label="World settings">
    <${WorldPicker} />
    ${isAtLeast("study") && html`
      <${Disturbances} />
      <${Group} title="Robot" chosen=${robotChosen()} fields=${ROBOT_FIELDS}><${RobotGroup} /><//>
    `}
  </fieldset>
`;

/**
 * Settings that are folded into one line. `fields` are those inside: one that is not valid is named by the summary.
 * @param {{ title: string, chosen: unknown[], fields: string[], children: ComponentChildren }} props
 */
function Group({ title, chosen, fields, children }) {
  const mistaken = fields.filter((field) => field in wrong.value).map(labelOf);
  return html`
    <details class="group">
      <summary>
        <b>${title}</b>${" "}
        ${mistaken.length
          ? html`<span class="bad">Not valid: ${listed(mistaken)}</span>`
          : html`<span class="dim">${chosen.filter(Boolean).join(" · ")}</span>`}
      </summary>
      <div class="group-fields">${children}</div>
    </details>
  `;
}

// ---- the training

const SeedAndObservation = () => html`
  <div class="inline-fields">
    <div class="field">
      <label for="field-seed">${settingOf("seed").title}</label>
      <${NumberField} field="seed" value=${form.value.seed}
        onValue=${(/** @type {number} */ value) => setField("seed", value)} />
      <${Description} field="seed" />
    </div>
    <${SelectField} field="observation" label="Observation"
      choices=${choicesOf(options.value?.observations, observationTitle)} />
  </div>
`;

const PracticeSteps = () => html`
  <${Slider} field="steps" ...${PRACTICE} value=${form.value.steps}
    onValue=${(/** @type {number} */ value) => setField("steps", value)} />
`;

/** The training whose present values stand in the fields: operators change them, others may read those of the stage. */
function trainingInFields() {
  const run = liveTraining.value;
  if (isOperator.value) return run;
  return isReadOnly.value && run?.id === trainingInView.value?.id ? run : null;
}

/**
 * The main settings of the learner. While a training runs, its live settings that the form does not keep take the
 * places of those they replace.
 */
function LearnerSettings() {
  const run = trainingInFields();
  const live = run ? agentOf(run.config.agent).live_settings : {};
  const main = mainSettings(form.value.agent);
  const acting = main.map((setting) => setting.live);
  const further = Object.keys(live).filter((name) => !acting.includes(name));
  return [
    ...main.map(({ name, live: rate, ...setting }) => (rate && rate !== name && rate in live
      ? closable(name, html`<${Present} key=${rate} name=${rate} setting=${live[rate]} run=${run} />`)
      : html`<${Chosen} key=${name} one=${{ ...setting, name, live: rate }} run=${name in live ? run : null} />`)),
    ...further.map((name) =>
      closable(name, html`<${Present} key=${name} name=${name} setting=${live[name]} run=${run} />`)),
    run && isOperator.value && html`<${NextRates} key="next-rates" run=${run} />`,
  ];
}

/** The pace or a live setting now: of the training that runs. @type {(run: Run, name: string) => any} */
const rateNow = (run, name) => presentRates(run)[name] ?? run.config.settings[name] ?? run.config[name];

/** Values that the next training starts with, where the one that runs has others. @param {{ run: Run }} props */
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

/**
 * A setting of the form; of the training that runs, if it is live there.
 * @param {{ one: MainSetting, run: Run }} props
 */
function Chosen({ one: { name, setting, end }, run }) {
  /** @param {number} value */
  const onValue = (value) => {
    setField(name, value);
    if (run) tune({ [name]: value });
  };
  const value = run ? rateNow(run, name) : form.value[name];
  const words = end ? { title: quantityOf(setting), unit: `to ${form.value[end]}` } : {};
  return html`<${Row} name=${name} setting=${setting} ...${words} value=${value} onValue=${onValue} />`;
}

/** Of a rate that follows from a schedule. */
const SHOWN_DIGITS = 8;

/**
 * A setting of the training that runs with its present value, which the form does not keep.
 * @param {{ name: string, setting: SettingOption, run: Run }} props
 */
function Present({ name, setting, run }) {
  const { id, config } = run;
  const { step } = sliderOf(setting) ?? { step: 0 };
  const last = /** @type {Record<string, number> | undefined} */ (evaluations.value[id]?.at(-1));
  const scheduled = last?.[name] ?? beginningOf(config.agent, name, config.settings);
  const rounded = step && typeof scheduled === "number"
    ? Number((Math.round(scheduled / step) * step).toPrecision(SHOWN_DIGITS))
    : scheduled;
  const value = presentRates(run)[name] ?? rounded;
  /** @param {SettingValue} changed */
  const onValue = (changed) => tune({ [name]: changed });
  return html`<${Row} name=${name} setting=${setting} value=${value} onValue=${onValue} isOfForm=${false} />`;
}

/**
 * A slider for a number with both limits, else the setting's own control.
 * @param {{ name: string, setting: SettingOption } & { [prop: string]: unknown }} props
 */
function Row({ name, setting, ...rest }) {
  const ends = kindOf(setting) === "number" ? sliderOf(setting) : null;
  return ends
    ? html`<${Slider} field=${name} setting=${setting} ...${ends} ...${rest} />`
    : html`<${SettingRow} name=${name} setting=${setting} ...${rest} />`;
}

// ---- the gait, chosen by its drawing

/** How many of them those who try choose from; those who study see all. */
const FEW_GAITS = 5;

const chosenRobot = () => served().robots.find(({ name }) => name === form.value.robot);
/** Gaits are drawn with six legs. */
const isDrawn = () => numberOfLegs(form.value.robot, served().robots) === HEXAPOD_LEGS;
const HEXAPOD_LEGS = 6;

/** The gaits that the robot's legs can have. A robot of one's own may have any: the server tells if not. */
function gaitChoices() {
  const [chosen, fitting] = [form.value.gait, chosenRobot()?.gaits];
  const offered = served().gaits.filter(({ name }) => isAllowed("gait", name) && (!fitting || fitting.includes(name)));
  return offered.filter(({ name }, number) => isAtLeast("study") || number < FEW_GAITS || name === chosen);
}

const GaitPicker = () => html`
  <fieldset role="radiogroup" disabled=${isClosed("gait")} aria-invalid=${wrong.value.gait ? "true" : undefined}
    aria-describedby=${wrong.value.gait ? "mistake-gait help-gait" : "help-gait"}>
    <legend><h2>Gait</h2></legend>
    <div class="gait-row">
      ${gaitChoices().map((gait, number) => html`
        <label class="gait" key=${gait.name}>
          <input class="sr-only" type="radio" name="gait" value=${gait.name} id=${number ? undefined : "field-gait"}
            checked=${!wrong.value.gait && gait.name === form.value.gait}
            onChange=${() => setField("gait", gait.name)} />
          ${isDrawn() && html`<${HexapodGlyph} gait=${gait} />`}
          <span>${gait.title}</span>
        </label>
      `)}
    </div>
    ${!wrong.value.gait && typeof form.value.gait !== "string" && html`
      <p class="notice">${gaitTitle(form.value.gait)}</p>
    `}
    <${MistakeOf} field="gait" />
    ${isAtLeast("study") && html`
      <${Description} field="gait" words=${served().gaits.find(({ name }) => name === form.value.gait)?.description} />
    `}
    <${Beforehand} hasPlan=${!isDrawn() || typeof form.value.gait !== "string"} isEdited=${isAtLeast("study")} />
  </fieldset>
`;

// ---- settings that are seldom changed, each with its help

/** Suggestions; a link may contain any other pace that the server accepts. */
const PACES = [
  ["max", "As fast as possible"], [0.5, "Half real time"], [1, "Real time"], [2, "×2"], [4, "×4"], [8, "×8"],
];

const furtherFields = () =>
  ["pace", ...furtherSettings(form.value.agent).map(([name]) => name), ...PRACTICE_FIELDS, "name"];

const MoreSettings = () => html`
  <div class="more-fields">
    <${Pace} />
    ${furtherSettings(form.value.agent).map(([name, setting]) => html`
      <${SettingField} key=${name} name=${name} setting=${setting} />
    `)}
    <${Figure} field="steps_per_episode" />
    <${Figure} field="evaluate_every" />
    <${SettingField} name="reward" setting=${settingOf("reward")} />
    <${Name} />
  </div>
`;

// ---- the robot

function robotChosen() {
  const { robot, simulator, tolerance } = form.value;
  return [
    robotTitle(robot), tolerance && `${settingOf("tolerance").title.toLowerCase()} ${tolerance}`,
    simulator !== served().defaults.training.simulator && simulatorTitle(simulator),
  ];
}

/** What is told of the chosen robot, and what features do with it. @param {ComponentChildren} [words] */
const robotLine = (words = null) => closable("robot", html`
  <div class="chosen-robot">${words}<${Slot} name="robot of the form" /></div>
`);

const RobotGroup = () => html`
  <div class="more-fields">
    <div class="field"><${RobotField} />${robotLine()}</div>
    <${SelectField} field="simulator" label="Simulator"
      choices=${choicesOf(options.value?.simulators, simulatorTitle)} />
    <${Figure} field="divisions" />
    <${Figure} field="grid_side_m" step=${0.005} />
    <${Figure} field="tolerance" step=${0.01} />
  </div>
`;

// ---- the race

const raceFields = () => ["lanes", "race_steps", ...Object.keys(laneSettings(form.value.lanes))];

const raceChosen = () =>
  [form.value.lanes.map((agent) => agentOf(agent).title).join(", "), count(form.value.race_steps, "step")];

const RaceGroup = () => html`
  <div class="more-fields">
    <${Lanes} />
    <${Figure} field="race_steps" />
  </div>
`;

/** @param {{ words?: string }} props */
const RobotField = ({ words = chosenRobot()?.description }) => html`
  <${SelectField} field="robot" label="Robot" choices=${choicesOfRobot()} onValue=${chooseRobot} words=${words} />
`;

/** Those that are offered, and a custom robot that a link or a run has brought. */
function choicesOfRobot() {
  const { robot } = form.value;
  const choices = robotChoices([robot]);
  return typeof robot === "string" ? choices : [...choices, [robot, robotTitle(robot)]];
}

/** @param {{ field: string, step: number }} props */
function Figure({ field, step }) {
  return html`
    <div class="field">
      <label for=${`field-${field}`}>${fullTitle(settingOf(field))}</label>
      <${NumberField} field=${field} value=${form.value[field]} step=${step} isDisabled=${isClosed(field)}
        onValue=${(/** @type {number} */ value) => setField(field, value)} />
      <${Description} field=${field} />
    </div>
  `;
}

function Pace() {
  const run = trainingInFields();
  const pace = run ? rateNow(run, "pace") : form.value.pace;
  const choices = PACES.some(([choice]) => choice === pace) ? PACES : [...PACES, [pace, `×${pace}`]];
  const onValue = (/** @type {number} */ value) => {
    setField("pace", value);
    tune({ pace: value });
  };
  return html`<${SelectField} field="pace" label=${settingOf("pace").title} choices=${choices} value=${pace}
    onValue=${onValue} />`;
}

/** Any number of lanes can be checked; one that is not valid is explained and holds the start. */
function Lanes() {
  const invalid = wrong.value.lanes;
  const lanes = invalid ? invalid.text.split(",").map((name) => name.trim()) : form.value.lanes;
  const names = (options.value?.agents ?? []).map(({ name }) => name);
  /** @param {string} name */
  const toggle = (name) => {
    const chosen = lanes.includes(name)
      ? lanes.filter((lane) => lane !== name)
      : names.filter((other) => other === name || lanes.includes(other));
    enter("lanes", chosen.filter((lane) => names.includes(lane)).join(","));
  };
  return html`
    <fieldset class="field wide" disabled=${isClosed("lanes")}>
      <legend>Lanes</legend>
      <div class="checks">
      ${names.map((name, number) => html`
        <label class="check">
          <input type="checkbox" checked=${lanes.includes(name)} onChange=${() => toggle(name)}
            ...${attributesOf("lanes")} id=${number ? undefined : "field-lanes"} />
          ${agentOf(name).title}
        </label>
      `)}
      </div>
      <${MistakeOf} field="lanes" />
      <${Description} field="lanes" />
    </fieldset>
    ${form.value.lanes.map((agent) => html`<${LaneFields} key=${agent} agent=${agent} />`)}
  `;
}

/** The settings of a lane's agent: "Beam: width". @param {{ agent: string }} props */
const LaneFields = ({ agent }) =>
  Object.entries(laneSettings([agent])).map(([field, setting]) => {
    const title = `${agentOf(agent).title}: ${setting.title.toLowerCase()}`;
    return html`<${SettingField} key=${field} name=${field} setting=${{ ...setting, title }} />`;
  });

const Name = () => html`
  <div class="field wide">
    <label for="field-name">Name</label>
    <input type="text" ...${attributesOf("name")} value=${wrong.value.name?.text ?? form.value.name}
      placeholder="optional" onInput=${(/** @type {Changed} */ { target }) => enter("name", target.value)} />
    <${MistakeOf} field="name" />
    <${Description} field="name" />
  </div>
`;
