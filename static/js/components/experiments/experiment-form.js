// The form of a new experiment.
import { useState } from "preact/hooks";
import { pending, refusedFields } from "../../actions.js";
import {
  agentSettings, chooseExperiment, chosenExperiment, defaults, experiments, mistakes, setField, setMistake, takesField,
  values,
} from "../../experiments/form.js";
import { canStart, start, startLabel } from "../../experiments/runs.js";
import { listed, sentence, whole } from "../../format.js";
import { isNarrow } from "../../page.js";
import { limitsOf, mistakeIn, parseValues, settingOf, shortTitle } from "../../settings.js";
import { options } from "../../store.js";
import { agentTitle, choicesOf, gaitTitle, observationTitle, robotTitle, simulatorTitle } from "../../titles.js";
import { html, Icon, Problem } from "../elements.js";
import { helpFor } from "../fields.js";

/** @import { SettingValue } from "../../types.js" */

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
  <div class="field">
    <label for="experiment-simulator">Simulator</label>
    <select id="experiment-simulator" aria-describedby="about-simulator"
      onChange=${({ target }) => setField("simulator", target.value)}>
      ${(options.value?.simulators ?? []).map(({ name }) => html`
        <option value=${name} selected=${name === values.value.simulator}>${sentence(simulatorTitle(name))}</option>
      `)}
    </select>
    <${Help} field="simulator" />
  </div>
`;

const NameField = () => html`
  <div class="field">
    <label for="experiment-name">Name</label>
    <input type="text" id="experiment-name" maxlength=${limitsOf("name").maximum} placeholder="optional"
      aria-describedby="about-name" value=${values.value.name}
      onInput=${({ target }) => setField("name", target.value.trim())} />
    <${Help} field="name" />
  </div>
`;

// ---- help: a sentence below each field

const Help = ({ field }) => html`<p class="sentence" id=${`about-${field}`}>${helpFor(field)}</p>`;

// ---- a choice of several out of a few; at least one stays chosen

/** `choices`: [value, title]. */
function CheckList({ field, label, choices }) {
  const chosen = /** @type {string[]} */ (values.value[field]);
  const toggle = (event, name) => {
    const isChosen = (one) => (one === name ? !chosen.includes(one) : chosen.includes(one));
    const next = choices.map(([one]) => one).filter(isChosen);
    if (next.length) setField(field, next);
    else event.target.checked = true;
  };
  return html`
    <fieldset class="field" aria-describedby=${`about-${field}`}>
      <legend>${label}</legend>
      <div class="checks">
        ${choices.map(([name, title]) => html`
          <label class="check" key=${name}>
            <input type="checkbox" checked=${chosen.includes(name)} onChange=${(event) => toggle(event, name)} />
            ${title}
          </label>
        `)}
      </div>
      <${Help} field=${field} />
    </fieldset>
  `;
}

// ---- text fields: a whole number, or values with commas; a mistake disables the start

function TypedField({ field, label, text, parse, inputmode, placeholder = undefined }) {
  const [draft, setDraft] = useState(null);
  const mistake = mistakes.value[field];
  const isRefused = refusedFields("experiment").includes(field);
  const onInput = ({ target }) => {
    setDraft(target.value);
    const parsed = parse(target.value);
    setMistake(field, parsed.mistake ?? null);
    if (!parsed.mistake) setField(field, parsed.value);
  };
  const onBlur = () => {
    setDraft(null);
    setMistake(field, null);
  };
  return html`
    <div class="field">
      <label for=${`experiment-${field}`}>${label}</label>
      <span class="number">
        <input type="text" inputmode=${inputmode} id=${`experiment-${field}`} value=${draft ?? text}
          placeholder=${placeholder}
          aria-invalid=${mistake || isRefused ? "true" : undefined}
          aria-describedby=${mistake ? `wrong-${field}` : `about-${field}`} onInput=${onInput} onBlur=${onBlur} />
        ${mistake && html`<span class="mistake" role="alert" id=${`wrong-${field}`}>${mistake}</span>`}
      </span>
      <${Help} field=${field} />
    </div>
  `;
}

/** One whole number. */
function CountField({ field, label }) {
  const parse = (typed) => {
    const value = /^\d+$/.test(typed.trim()) ? Number(typed) : NaN;
    const mistake = mistakeIn(value, limitsOf(field), true);
    return mistake ? { mistake } : { value };
  };
  const text = String(values.value[field]);
  return html`<${TypedField} field=${field} label=${label} text=${text} parse=${parse} inputmode="numeric" />`;
}

const joined = (list) => /** @type {SettingValue[]} */ (list).join(", ");

/** One value of a setting, or several with commas between; none where each agent has its own default. */
function ValuesField({ field, setting }) {
  const standard = defaults.value[field];
  const isOwn = joined(standard) === "";
  const parse = (typed) => (isOwn && typed.trim() === "" ? { value: standard } : parseValues(typed, setting));
  return html`
    <${TypedField} field=${field} label=${shortTitle(setting)} text=${joined(values.value[field])} parse=${parse}
      inputmode=${setting.is_number ? "decimal" : "text"} placeholder=${isOwn ? "by default" : undefined} />
  `;
}
