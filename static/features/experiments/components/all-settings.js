// Every setting of a new experiment, for those who want more than the chosen preset shows.
import { useState } from "preact/hooks";
import { splitWorlds } from "../../../js/disturbances.js";
import {
  agentSettings, chosenExperiment, enter, offeredAgents, setField, takesField, values, wrong,
} from "../form.js";
import { listed, sentence, whole } from "../../../js/format.js";
import { choiceTitle, fullTitle, settingOf, shortTitle } from "../../../js/settings.js";
import { options, served } from "../../../js/store.js";
import {
  agentTitle, choicesOf, gaitTitle, observationTitle, robotChoices, robotTitle, simulatorTitle,
} from "../../../js/titles.js";
import { html } from "../../../js/components/elements.js";
import { WorldPicture } from "../../../js/components/world.js";
import {
  attributesOf, CountInput, Help, joined, MistakeOf, settingBy, TypedInput, ValuesInput,
} from "./form-fields.js";

/** @import { Changed, SettingOption } from "../../../js/types.js" */
/** @import { ComponentChildren } from "preact" */

export const FIRST_SEED = "First seed";

/**
 * Fields of the grid that the chosen experiment takes: first the practice and the settings of the chosen agents,
 * the others further down.
 * @param {boolean} isMain
 */
function gridOf(isMain) {
  const main = ["steps", ...Object.keys(agentSettings.value)].filter(takesField);
  return isMain ? main : chosenExperiment.value.grid.filter((field) => takesField(field) && !main.includes(field));
}

export const AllSettings = () => html`
  <div class="experiment-fields all-settings">
    <div class="pair">
      <${CountField} field="seeds" label="Seeds" />
      <${CountField} field="seed" label=${FIRST_SEED} />
    </div>
    ${takesField("agents") && html`
      <${CheckList} field="agents" label="Agents" choices=${agentChoices()} />
    `}
    ${takesField("worlds") && html`<${Worlds} />`}
    <${Grid} fields=${gridOf(true)}>${takesField("tolerance") && html`<${ToleranceField} />`}<//>
    <${More} />
  </div>
`;

/** The agents that the experiment can compare: [name, title]. */
export const agentChoices = () =>
  choicesOf(served().agents.filter(({ name }) => offeredAgents().includes(name)), agentTitle);

/**
 * Fields that are combined: one value each, or several.
 * @param {{ fields: string[], children: ComponentChildren }} props
 */
const Grid = ({ fields, children }) => fields.length > 0 && html`
  <fieldset class="grid-fields">
    <legend class=${fields.length > 1 ? "" : "sr-only"}>Every combination of</legend>
    ${fields.map((field) => html`
      <${ValuesField} key=${field} field=${field} setting=${settingBy(field)} />
    `)}
    ${children}
  </fieldset>
`;

/** Gaits, robots, observations and simulator: rarely changed, so one line until opened. */
const More = () => html`
  <details class="more">
    <summary>Robots and gaits<span class="dim">${summaryOfAll()}</span></summary>
    <div class="where">
      <${CheckList} field="gaits" label="Gaits" choices=${choicesOf(options.value?.gaits, gaitTitle)} />
      <${CheckList} field="robots" label="Robots" choices=${robotChoices(values.value.robots)} />
      <${CheckList} field="observations" label="Observation"
        choices=${choicesOf(options.value?.observations, observationTitle)} />
      <${Grid} fields=${gridOf(false)} />
      <${SimulatorField} />
      ${takesField("reward") && html`<${RewardField} />`}
      <${NameField} />
    </div>
  </details>
`;

/** Where it walks: gaits, robots and observations; the simulator elsewhere. */
export function placeSummary() {
  const { gaits, robots, observations } = values.value;
  const all = options.value?.gaits ?? [];
  return [
    gaits.length === all.length ? `all ${whole(all.length)} gaits` : listed(gaits.map(gaitTitle)),
    listed(robots.map((name) => robotTitle(name).toLowerCase())),
    listed(observations.map(observationTitle)),
  ].filter(Boolean).join(" · ");
}

/** With a simulator that is not the usual one. */
function summaryOfAll() {
  const { simulator } = values.value;
  const isUsual = simulator === chosenExperiment.value.defaults.simulator;
  return [placeSummary(), isUsual ? "" : simulatorTitle(simulator)].filter(Boolean).join(" · ");
}

const SimulatorField = () => html`
  <div class="field">
    <label for="experiment-simulator">Simulator</label>
    <select ...${attributesOf("simulator")}
      onChange=${(/** @type {Changed} */ { target }) => setField("simulator", target.value)}>
      ${wrong.value.simulator && html`
        <option value="" selected disabled>${wrong.value.simulator.text || "(empty)"}: not valid</option>
      `}
      ${(options.value?.simulators ?? []).map(({ name }) => html`
        <option value=${name} selected=${!wrong.value.simulator && name === values.value.simulator}>
          ${sentence(simulatorTitle(name))}
        </option>
      `)}
    </select>
    <${MistakeOf} field="simulator" />
    <${Help} field="simulator" />
  </div>
`;

const NameField = () => html`
  <div class="field">
    <label for="experiment-name">Name</label>
    <input type="text" ...${attributesOf("name")} placeholder="optional"
      value=${wrong.value.name?.text ?? values.value.name}
      onInput=${(/** @type {Changed} */ { target }) => enter("name", target.value)} />
    <${MistakeOf} field="name" />
    <${Help} field="name" />
  </div>
`;

// ---- a choice of several out of a few; with none the start is held

/** `choices`: [value, title]. @param {{ field: string, label: string, choices: [string, string][] }} props */
function CheckList({ field, label, choices }) {
  const chosen = /** @type {string[]} */ (wrong.value[field]?.text.split(",") ?? values.value[field]);
  /** @param {string} name */
  const toggle = (name) => {
    /** @param {string} one */
    const isChosen = (one) => (one === name ? !chosen.includes(one) : chosen.includes(one));
    enter(field, choices.map(([one]) => one).filter(isChosen).join(","));
  };
  return html`
    <fieldset class="field" aria-describedby=${`about-${field}`}>
      <legend>${label}</legend>
      <div class="checks">
        ${choices.map(([name, title], number) => html`
          <label class="check" key=${name}>
            <input type="checkbox" checked=${chosen.includes(name)} onChange=${() => toggle(name)}
              ...${attributesOf(field)} id=${number ? undefined : `experiment-${field}`} />
            ${title}
          </label>
        `)}
      </div>
      <${MistakeOf} field=${field} />
      <${Help} field=${field} />
    </fieldset>
  `;
}

// ---- worlds: those with a name by their pictures, others as a text

/** Names that are chosen, and what else the text of the field has. */
function worldsChosen() {
  const all = splitWorlds(wrong.value.worlds?.text ?? joined(values.value.worlds));
  const names = served().worlds.map(({ name }) => name);
  return { named: names.filter((name) => all.includes(name)), others: all.filter((one) => !names.includes(one)) };
}

function Worlds() {
  const { named, others } = worldsChosen();
  /** @param {string} name */
  const toggle = (name) => {
    /** @param {string} one */
    const isChosen = (one) => (one === name ? !named.includes(one) : named.includes(one));
    enter("worlds", [...served().worlds.map((one) => one.name).filter(isChosen), ...others].join(","));
  };
  return html`
    <fieldset class="field" aria-describedby="about-worlds">
      <legend>Worlds</legend>
      <div class="gait-row">
        ${served().worlds.map(({ name, title, disturbances, description }, number) => html`
          <label class="gait" key=${name} title=${description}>
            <input class="sr-only" type="checkbox" checked=${named.includes(name)} onChange=${() => toggle(name)}
              ...${attributesOf("worlds")} id=${number ? undefined : "experiment-worlds"} />
            <${WorldPicture} disturbances=${disturbances} />
            <span>${title}</span>
          </label>
        `)}
      </div>
      <${OtherWorlds} named=${named} others=${others.join("; ")} />
      <${MistakeOf} field="worlds" />
      <${Help} field="worlds" />
    </fieldset>
  `;
}

/**
 * Worlds without a name, as on the command line. The typed text stays while it means the same.
 * @param {{ named: string[], others: string }} props
 */
function OtherWorlds({ named, others }) {
  const [draft, setDraft] = useState("");
  const isKept = splitWorlds(draft).join("; ") === others;
  /** @param {{ target: HTMLInputElement }} event */
  const onInput = ({ target }) => {
    setDraft(target.value);
    enter("worlds", [...named, target.value].join(","));
  };
  return html`
    <label class="other-worlds">Others
      <input type="text" autocomplete="off" spellcheck=${false} value=${isKept ? draft : others} onInput=${onInput}
        placeholder="limp:legs=2,5+slope:degrees=4"
        aria-invalid=${wrong.value.worlds && others ? "true" : undefined} aria-describedby="about-worlds" />
    </label>
  `;
}

const ToleranceField = () => html`
  <${Labelled} field="tolerance" label=${fullTitle(settingOf("tolerance"))}>
    <${TypedInput} field="tolerance" text=${String(values.value.tolerance)} inputmode="decimal" />
  <//>
`;

const RewardField = () => html`
  <${Labelled} field="reward" label=${fullTitle(settingOf("reward"))}>
    <select ...${attributesOf("reward")}
      onChange=${(/** @type {Changed} */ { target }) => setField("reward", target.value)}>
      ${settingOf("reward").choices?.map((/** @type {string} */ name) => html`
        <option value=${name} selected=${name === values.value.reward}>
          ${sentence(choiceTitle(settingOf("reward"), name))}
        </option>
      `)}
    </select>
  <//>
`;

/** @param {{ field: string, label: string, children: ComponentChildren }} props */
const Labelled = ({ field, label, children }) => html`
  <div class="field">
    <label for=${`experiment-${field}`}>${label}</label>
    ${children}
    <${MistakeOf} field=${field} />
    <${Help} field=${field} />
  </div>
`;

/** @param {{ field: string, label: string }} props */
const CountField = ({ field, label }) =>
  html`<${Labelled} field=${field} label=${label}><${CountInput} field=${field} /><//>`;

/** @param {{ field: string, setting: SettingOption }} props */
const ValuesField = ({ field, setting }) => html`
  <${Labelled} field=${field} label=${shortTitle(setting)}><${ValuesInput} field=${field} setting=${setting} /><//>
`;
