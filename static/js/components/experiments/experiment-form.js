// The form of a new experiment.
import { effect, signal } from "@preact/signals";
import { useEffect, useState } from "preact/hooks";
import { pending, refusedFields } from "../../actions.js";
import { splitWorlds } from "../../disturbances.js";
import {
  agentSettings, chooseExperiment, chosenExperiment, defaults, enter, experiments, mistakes, offeredAgents, parse,
  setField, takesField, trials, values, wrong,
} from "../../experiments/form.js";
import { canStart, experimentEstimate, start, startLabel } from "../../experiments/runs.js";
import { count, listed, sentence, whole } from "../../format.js";
import { ignored, page } from "../../page-state.js";
import { fullTitle, settingOf, shortTitle } from "../../settings.js";
import { options, served } from "../../store.js";
import {
  agentTitle, choicesOf, fieldTitle, gaitTitle, observationTitle, robotTitle, simulatorTitle,
} from "../../titles.js";
import { Dialog, goToField, Held, html, Icon, Mistake, Problem, UnknownParts } from "../elements.js";
import { helpFor } from "../fields.js";
import { WorldPicture } from "../world.js";

/** @import { Changed, ExperimentValue, SettingOption, SettingValue } from "../../types.js" */
/** @import { ComponentChildren } from "preact" */

/** Whether the dialog of a new experiment is open. */
export const formIsOpen = signal(false);

/** The dialog opens by itself for an address that says what to run: with fields of the form, and no run to be shown. */
export function ExperimentDialog() {
  useEffect(() => {
    const stop = effect(() => {
      const saysWhat = page.experiment.value.size > 0 || ignored.experiments.value.length > 0;
      if (saysWhat && page.report.peek() === null) formIsOpen.value = true;
    });
    return () => {
      stop();
      formIsOpen.value = false;
    };
  }, []);
  return html`
    <${Dialog} id="experiment-dialog" labelledBy="new-experiment" isOpen=${formIsOpen}>
      <div class="dialog-head">
        <h2 id="new-experiment">New experiment</h2>
        <button class="quiet square" aria-label="Close" onClick=${() => (formIsOpen.value = false)}>✕</button>
      </div>
      <p class="cost" role="status">${costInWords()}</p>
      <${Fields} />
    <//>
  `;
}

/** What the form would start, before anything else: how many trials, and for how long if that is long. */
function costInWords() {
  if (!canStart()) return "No trials yet: something below is missing.";
  return [html`<b>${count(trials.value, "trial")}.</b>`, " ", experimentEstimate.value || "Done soon."];
}

/**
 * Fields of the grid that the chosen experiment takes: first the practice and the settings of the chosen agents,
 * the others further down.
 * @param {boolean} isMain
 */
function gridOf(isMain) {
  const main = ["steps", ...Object.keys(agentSettings.value)].filter(takesField);
  return isMain ? main : chosenExperiment.value.grid.filter((field) => takesField(field) && !main.includes(field));
}

const Fields = () => html`
  <div class="experiment-fields">
    <${Cards} />
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
    <${StartButton} />
    <${UnknownParts} parts=${ignored.experiments} />
    <${Problem} at="experiment" />
  </div>
`;

const agentChoices = () =>
  choicesOf(served().agents.filter(({ name }) => offeredAgents().includes(name)), agentTitle);

/** Start, and show the report. */
async function startAndShow() {
  if (await start() !== null) formIsOpen.value = false;
}

function StartButton() {
  const isDisabled = !canStart() || pending.value.experiment;
  const isHeld = Object.keys(mistakes.value).length > 0;
  const onClick = () => !isDisabled && startAndShow();
  return html`
    <button class="primary" aria-disabled=${isDisabled ? "true" : undefined} onClick=${onClick}
      aria-describedby=${isHeld ? "held-experiment" : undefined}>
      ${pending.value.experiment ? "Starting…" : html`<${Icon} name="play" />${startLabel()}`}
    </button>
    ${isHeld && html`
      <${Held} id="held-experiment" mistakes=${mistakes.value} nameOf=${nameOf}
        onField=${(/** @type {string} */ field) => goToField(`experiment-${field}`)} />
    `}
  `;
}

/** A field's name as this form shows it. @param {string} field */
const nameOf = (field) => (field === "seed" ? FIRST_SEED : fieldTitle(field));
const FIRST_SEED = "First seed";

const Cards = () => html`
  <fieldset class="cards" role="radiogroup" aria-invalid=${wrong.value.experiment ? "true" : undefined}
    aria-describedby=${wrong.value.experiment && "wrong-experiment"}>
    <legend class="sr-only">Experiment</legend>
    ${experiments.value.map(({ name, title, description }, number) => html`
      <label class="card" key=${name}>
        <input class="sr-only" type="radio" name="experiment" id=${number ? undefined : "experiment-experiment"}
          checked=${!wrong.value.experiment && chosenExperiment.value.name === name}
          onChange=${() => chooseExperiment(name)} />
        <b>${title}</b><span>${description}</span>
      </label>
    `)}
    <${MistakeOf} field="experiment" />
  </fieldset>
`;

/**
 * Fields that are combined: one value each, or several.
 * @param {{ fields: string[], children: ComponentChildren }} props
 */
const Grid = ({ fields, children }) => fields.length > 0 && html`
  <fieldset class="grid-fields">
    <legend class=${fields.length > 1 ? "" : "sr-only"}>Every combination of</legend>
    ${fields.map((field) => html`
      <${ValuesField} key=${field} field=${field} setting=${agentSettings.value[field] ?? settingOf(field)} />
    `)}
    ${children}
  </fieldset>
`;

/** Gaits, robots, observations and simulator: rarely changed, so one line until opened. */
const More = () => html`
  <details class="more">
    <summary>Robots and gaits<span class="dim">${placeSummary()}</span></summary>
    <div class="where">
      <${CheckList} field="gaits" label="Gaits" choices=${choicesOf(options.value?.gaits, gaitTitle)} />
      <${CheckList} field="robots" label="Robots" choices=${choicesOf(options.value?.robots, robotTitle)} />
      <${CheckList} field="observations" label="Observation"
        choices=${choicesOf(options.value?.observations, observationTitle)} />
      <${Grid} fields=${gridOf(false)} />
      <${SimulatorField} />
      <${NameField} />
    </div>
  </details>
`;

function placeSummary() {
  const { gaits, robots, observations, simulator } = values.value;
  const all = options.value?.gaits ?? [];
  return [
    gaits.length === all.length ? `all ${whole(all.length)} gaits` : listed(gaits.map(gaitTitle)),
    listed(robots.map((name) => robotTitle(name).toLowerCase())),
    listed(observations.map(observationTitle)),
    simulator === chosenExperiment.value.defaults.simulator ? "" : simulatorTitle(simulator),
  ].filter(Boolean).join(" · ");
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

// ---- what is not valid, and why

/** The attributes of a field's control: its id, whether it is marked, and what describes it. @param {string} field */
const attributesOf = (field) => ({
  id: `experiment-${field}`,
  "aria-invalid": wrong.value[field] || refusedFields("experiment").includes(field) ? "true" : undefined,
  "aria-describedby": wrong.value[field] ? `wrong-${field} about-${field}` : `about-${field}`,
});

/** @param {{ field: string }} props */
const MistakeOf = ({ field }) => html`<${Mistake} id=${`wrong-${field}`}>${wrong.value[field]?.mistake}<//>`;

// ---- help: a sentence below each field

/** @param {{ field: string }} props */
const Help = ({ field }) => html`<p class="sentence" id=${`about-${field}`}>${helpFor(field)}</p>`;

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
  <${TypedField} field="tolerance" label=${fullTitle(settingOf("tolerance"))} text=${String(values.value.tolerance)}
    inputmode="decimal" />
`;

// ---- text fields: a whole number, or a list of values; what is typed stays as it is

/** @param {{ field: string, label: string, text: string, inputmode: string, placeholder?: string }} props */
function TypedField({ field, label, text, inputmode, placeholder = undefined }) {
  const [draft, setDraft] = useState(/** @type {string | null} */ (null));
  const isKept = draft !== null && String(parse(field, draft).value) === String(values.value[field]);
  /** @param {{ target: HTMLInputElement }} event */
  const onInput = ({ target }) => {
    setDraft(target.value);
    enter(field, target.value);
  };
  return html`
    <div class="field">
      <label for=${`experiment-${field}`}>${label}</label>
      <input type="text" inputmode=${inputmode} autocomplete="off" ...${attributesOf(field)}
        value=${wrong.value[field]?.text ?? (isKept ? draft : text)} placeholder=${placeholder} onInput=${onInput} />
      <${MistakeOf} field=${field} />
      <${Help} field=${field} />
    </div>
  `;
}

/** One whole number. @param {{ field: string, label: string }} props */
const CountField = ({ field, label }) => html`
  <${TypedField} field=${field} label=${label} text=${String(values.value[field])} inputmode="numeric" />
`;

/** @param {ExperimentValue} list */
const joined = (list) => /** @type {SettingValue[]} */ (list).join(", ");

/**
 * One value of a setting, or several; none where each agent has its own default.
 * @param {{ field: string, setting: SettingOption }} props
 */
function ValuesField({ field, setting }) {
  const isOwn = joined(defaults.value[field]) === "";
  return html`
    <${TypedField} field=${field} label=${shortTitle(setting)} text=${joined(values.value[field])}
      inputmode=${setting.is_number ? "decimal" : "text"} placeholder=${isOwn ? "by default" : undefined} />
  `;
}
