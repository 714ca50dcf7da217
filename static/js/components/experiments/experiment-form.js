// The form of a new experiment.
import { useState } from "preact/hooks";
import { pending } from "../../actions.js";
import { listed, sentence, whole } from "../../format.js";
import { html } from "../../html.js";
import { limitsOf, settingOf } from "../../limits.js";
import { isNarrow } from "../../page.js";
import { options } from "../../store.js";
import { choicesOf, gaitTitle, observationTitle, robotTitle, simulatorTitle } from "../../titles.js";
import { canStart, start, startLabel } from "../../experiments/actions.js";
import {
  agentSettings, chosenExperiment, chooseExperiment, setField, takesField, values,
} from "../../experiments/form.js";
import { experiments } from "../../experiments/catalogue.js";
import { agentTitle } from "../../experiments/titles.js";
import { Icon } from "../icon.js";
import { Problem } from "../problem.js";
import { CheckList } from "./check-list.js";
import { Help, help } from "./experiment-help.js";
import { CountField, ValuesField } from "./typed-field.js";

/** Folded on a phone once there is a report. */
export function ExperimentForm({ isFirst }) {
  const [isOpen, setOpen] = useState(false);
  const isFolded = isNarrow.value && !isFirst;
  const onToggle = ({ target }) => isFolded && setOpen(target.open);
  return html`
    <section class="panel experiment-form" aria-labelledby="new-experiment">
      <details class="folded" open=${isOpen || !isFolded} onToggle=${onToggle}>
        <summary hidden=${!isFolded}><span>New experiment</span></summary>
        <h2 id="new-experiment" class=${isFolded ? "sr-only" : ""}>New experiment</h2>
        <${Fields} />
      </details>
    </section>
  `;
}

/**
 * Fields of the grid that the chosen experiment takes: first the practice and the settings of the chosen agents,
 * the others further down.
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
      <${CountField} field="seed" label="First seed" />
    </div>
    ${takesField("agents") && html`
      <${CheckList} field="agents" label="Agents" choices=${choicesOf(options.value?.agents, agentTitle)} />
    `}
    <${Grid} fields=${gridOf(true)} />
    <${More} />
    <${Help} />
    <${StartButton} />
    <${Problem} at="experiment" />
  </div>
`;

function StartButton() {
  const isDisabled = !canStart() || pending.value.experiment;
  return html`
    <button class="primary" aria-disabled=${isDisabled ? "true" : undefined} onClick=${() => !isDisabled && start()}>
      ${pending.value.experiment ? "Starting…" : html`<${Icon} name="play" />${startLabel()}`}
    </button>
  `;
}

const Cards = () => html`
  <fieldset class="cards">
    <legend class="sr-only">Experiment</legend>
    ${experiments.value.map(({ name, title, description }) => html`
      <label class="card" key=${name}>
        <input class="sr-only" type="radio" name="experiment" checked=${chosenExperiment.value.name === name}
          onChange=${() => chooseExperiment(name)} />
        <b>${title}</b><span>${description}</span>
      </label>
    `)}
  </fieldset>
`;

/** Fields that a sweep combines: one value each, or several with commas. */
const Grid = ({ fields }) => fields.length > 0 && html`
  <fieldset class="grid-fields">
    <legend>Every combination of</legend>
    ${fields.map((field) => html`
      <${ValuesField} key=${field} field=${field} setting=${agentSettings.value[field] ?? settingOf(field)} />
    `)}
  </fieldset>
`;

/** Gaits, robots, observations and simulator: rarely changed, so one line until opened. */
const More = () => html`
  <details class="more">
    <summary>Where and how<span class="dim">${placeSummary()}</span></summary>
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
  <div class="field" onFocusIn=${help("simulator")}>
    <label for="experiment-simulator">Simulator</label>
    <select id="experiment-simulator" onChange=${({ target }) => setField("simulator", target.value)}>
      ${(options.value?.simulators ?? []).map(({ name }) => html`
        <option value=${name} selected=${name === values.value.simulator}>${sentence(simulatorTitle(name))}</option>
      `)}
    </select>
  </div>
`;

const NameField = () => html`
  <div class="field" onFocusIn=${help("name")}>
    <label for="experiment-name">Name</label>
    <input type="text" id="experiment-name" maxlength=${limitsOf("name").maximum} placeholder="optional"
      value=${values.value.name} onInput=${({ target }) => setField("name", target.value.trim())} />
  </div>
`;
