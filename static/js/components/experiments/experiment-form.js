// What to run: which experiment, how many seeds, and where.
import { useState } from "preact/hooks";
import { pending } from "../../actions.js";
import { listed, sentence, whole } from "../../format.js";
import { html } from "../../html.js";
import { isNarrow } from "../../page.js";
import { options } from "../../store.js";
import { canStart, start, startLabel } from "../../experiments/actions.js";
import { chosenKind, choose, maySay, say, values } from "../../experiments/form.js";
import { experiments, GRID } from "../../experiments/catalogue.js";
import { FIELD_TITLES, gaitTitle, OBSERVATIONS } from "../../experiments/titles.js";
import { Icon } from "../icon.js";
import { Problem } from "../problem.js";
import { CheckList } from "./check-list.js";
import { Help, help } from "./experiment-help.js";
import { CountField, NumbersField } from "./typed-field.js";

/** What one tunes first; the rest of the grid is further down. */
const MAIN_GRID = ["steps", "alpha", "gamma", "divisions"];
const SIMULATORS = [["mujoco", "Physics (MuJoCo)"], ["kinematic", "Ideal, without slip"]];

/** On a phone one line once there is a report to read. */
export function ExperimentForm({ isFirst }) {
  const [isOpen, setOpen] = useState(false);
  const isFolded = isNarrow.value && !isFirst;
  return html`
    <section class="panel experiment-form" aria-labelledby="new-experiment">
      <details class="folded" open=${isOpen || !isFolded} onToggle=${({ target }) => isFolded && setOpen(target.open)}>
        <summary hidden=${!isFolded}><span>New experiment</span></summary>
        <h2 id="new-experiment" class=${isFolded ? "sr-only" : ""}>New experiment</h2>
        <${Fields} />
      </details>
    </section>
  `;
}

function Fields() {
  const isHeld = !canStart() || pending.value.experiment;
  return html`
    <div class="experiment-fields">
      <${Cards} />
      <div class="pair">
        <${CountField} field="seeds" label="Seeds" low=${1} high=${10000} />
        <${CountField} field="seed" label="First seed" low=${0} />
      </div>
      ${maySay("agents") && html`<${CheckList} field="agents" label="Who" choices=${agents()} />`}
      ${maySay("alpha") && html`<${Grid} fields=${MAIN_GRID} />`}
      <${More} />
      <${Help} />
      <button class="primary" aria-disabled=${isHeld ? "true" : undefined} onClick=${() => !isHeld && start()}>
        ${pending.value.experiment ? "Starting…" : html`<${Icon} name="play" />${startLabel()}`}
      </button>
      <${Problem} at="experiment" />
    </div>
  `;
}

const agents = () => (options.value?.agents ?? []).map(({ name, title }) => [name, title]);

const Cards = () => html`
  <fieldset class="cards">
    <legend class="sr-only">Experiment</legend>
    ${experiments.value.map(({ name, title, help }) => html`
      <label class="card" key=${name}>
        <input class="sr-only" type="radio" name="experiment" checked=${chosenKind.value.name === name} onChange=${() => choose(name)} />
        <b>${title}</b><span>${help}</span>
      </label>
    `)}
  </fieldset>
`;

/** What a sweep varies: one number, or several with commas. */
const Grid = ({ fields }) => html`
  <fieldset class="grid-fields">
    <legend>Every combination of</legend>
    ${fields.map((field) => html`<${NumbersField} key=${field} field=${field} label=${FIELD_TITLES[field]} />`)}
  </fieldset>
`;

/** Gaits, robots and how they feel: seldom other than the paper's, so told in a line until asked for. */
function More() {
  const { gaits, robots, observations, simulator, name } = values.value;
  const all = options.value?.gaits?.map((gait) => gait.name) ?? gaits;
  return html`
    <details class="more">
      <summary>
        Where and how<span class="dim">${[
          gaits.length === all.length ? `all ${whole(all.length)} gaits` : listed(gaits.map(gaitTitle)),
          listed(robots), listed(observations), simulator === "mujoco" ? "" : "without slip",
        ].filter(Boolean).join(" · ")}</span>
      </summary>
      <div class="where">
        <${CheckList} field="gaits" label="Gaits" choices=${all.map((one) => [one, gaitTitle(one)])} />
        <${CheckList} field="robots" label="Robots" choices=${(options.value?.robots ?? []).map((one) => one.name ?? one).map((one) => [one, sentence(one)])} />
        <${CheckList} field="observations" label="What it goes by" choices=${Object.entries(OBSERVATIONS).map(([one, [title, words]]) => [one, `${title}: ${words}`])} />
        ${maySay("alpha") && html`<${Grid} fields=${GRID.filter((field) => !MAIN_GRID.includes(field))} />`}
        <div class="field" onFocusIn=${help("simulator")}>
          <label for="experiment-simulator">Simulator</label>
          <select id="experiment-simulator" onChange=${({ target }) => say("simulator", target.value)}>
            ${SIMULATORS.map(([one, title]) => html`<option value=${one} selected=${one === simulator}>${title}</option>`)}
          </select>
        </div>
        <div class="field" onFocusIn=${help("name")}>
          <label for="experiment-name">Name</label>
          <input type="text" id="experiment-name" maxlength="100" placeholder="optional" value=${name}
            onInput=${({ target }) => say("name", target.value.trim())} />
        </div>
      </div>
    </details>
  `;
}
