// Settings that are seldom changed: robot, simulator, grid, pace, lanes, name, and the learner's others. Each with its
// help.
import { tune } from "../actions.js";
import { agentOf, furtherSettings } from "../agents.js";
import { form, setField } from "../form.js";
import { html } from "../html.js";
import { limitsOf, settingOf } from "../limits.js";
import { fullTitle } from "../settings.js";
import { options } from "../store.js";
import { choicesOf, robotTitle, simulatorTitle } from "../titles.js";
import { NumberField } from "./number-field.js";
import { SelectField } from "./select-field.js";
import { SettingField } from "./setting-control.js";
import { Description, helpFor } from "./setting-help.js";

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
  const { pace } = form.value;
  const choices = PACES.some(([one]) => one === pace) ? PACES : [...PACES, [pace, `×${pace}`]];
  const onValue = (value) => {
    setField("pace", value);
    tune({ pace: value });
  };
  return html`<${Choice} field="pace" label=${settingOf("pace").title} choices=${choices} onValue=${onValue} />`;
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
