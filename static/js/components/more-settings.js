// What few need: robot, grid, schedule, pace, lanes, name. Each with its sentence below it.
import { tune } from "../actions.js";
import { form, set } from "../form.js";
import { html } from "../html.js";
import { options } from "../store.js";
import { NumberField } from "./number-field.js";
import { SelectField } from "./select-field.js";
import { Description, sentenceFor } from "./setting-help.js";

const SIMULATORS = { mujoco: "Physics (MuJoCo)", kinematic: "Ideal, without slip" };
const PACES = [
  ["max", "As fast as it can"], [0.5, "Half real time"], [1, "Real time"], [2, "×2"], [4, "×4"], [8, "×8"],
];
const MAX_LANES = 6;

const named = (list, fallback) => (list ?? fallback).map((one) => one.name ?? one);
const title = (word) => word.charAt(0).toUpperCase() + word.slice(1);

export const MoreSettings = () => html`
  <details class="more">
    <summary>More settings</summary>
    <div class="more-fields">
      <${Choice} field="robot" label="Robot"
        choices=${named(options.value?.robots, ["stiff"]).map((name) => [name, title(name)])} />
      <${Choice} field="simulator" label="Simulator"
        choices=${named(options.value?.simulators, ["mujoco"]).map((name) => [name, SIMULATORS[name] ?? name])} />
      <${Pace} />
      <${Figure} field="divisions" label="Foot grid, divisions" />
      <${Figure} field="grid_side_m" label="Foot grid, side" unit="m" step=${0.005} />
      <${Figure} field="epsilon_end" label="Exploring ε, at last" step=${0.01} />
      <${Figure} field="steps_per_episode" label="Steps an episode" />
      <${Figure} field="evaluate_every" label="Try out every" unit="steps" />
      <${Figure} field="race_steps" label="Steps of the race" />
      <${Lanes} />
      <div class="field wide">
        <label for="field-name">Name</label>
        <input type="text" id="field-name" maxlength="100" value=${form.value.name}
          placeholder="optional" aria-describedby="help-name"
          onInput=${({ target }) => set("name", target.value)} />
        <${Sentence} field="name" />
      </div>
    </div>
  </details>
`;

const Sentence = ({ field }) => html`<p class="sentence" aria-hidden="true">${sentenceFor(field)}</p><${Description} field=${field} />`;

const Choice = ({ field, label, choices, ...rest }) => html`
  <div><${SelectField} field=${field} label=${label} choices=${choices} ...${rest} />
  <p class="sentence" aria-hidden="true">${sentenceFor(field)}</p></div>
`;

const Figure = ({ field, label, unit, step }) => html`
  <div class="field">
    <label for=${`field-${field}`}>${label}${unit && ` (${unit})`}</label>
    <${NumberField} field=${field} value=${form.value[field]} step=${step}
      onValue=${(value) => set(field, value)} />
    <${Sentence} field=${field} />
  </div>
`;

function Pace() {
  const { pace } = form.value;
  const choices = PACES.some(([one]) => one === pace) ? PACES : [...PACES, [pace, `×${pace}`]];
  const onValue = (value) => {
    set("pace", value);
    tune({ pace: value });
  };
  return html`<${Choice} field="pace" label="Pace of practice" choices=${choices} onValue=${onValue} />`;
}

function Lanes() {
  const { lanes } = form.value;
  const agents = options.value?.agents ?? [];
  const toggle = (name) => {
    const chosen = lanes.includes(name)
      ? lanes.filter((one) => one !== name)
      : agents.map((agent) => agent.name).filter((one) => one === name || lanes.includes(one));
    if (chosen.length && chosen.length <= MAX_LANES) set("lanes", chosen);
    else set("lanes", [...lanes]);
  };
  return html`
    <fieldset class="field wide">
      <legend>Who races</legend>
      <div class="checks">
      ${agents.map(({ name, title: words }) => html`
        <label class="check">
          <input type="checkbox" checked=${lanes.includes(name)} onChange=${() => toggle(name)} />
          ${words ?? name}
        </label>
      `)}
      </div>
      <${Sentence} field="lanes" />
    </fieldset>
  `;
}
