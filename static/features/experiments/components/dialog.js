// The dialog of a new experiment: cards of presets, the few fields of the chosen one, the estimate, and the start.
import { effect, signal } from "@preact/signals";
import { useEffect } from "preact/hooks";
import { pending, refusedFields } from "../../../js/actions.js";
import { shareOf } from "../../../js/scale.js";
import { enter, mistakes, setField, takesField, trials, values, wrong } from "../form.js";
import {
  choosePreset, chosenPreset, chooseAgent, chooseSwept, isMoreSet, isUntouched, presets, suggestedValues, sweepable,
  sweptField,
} from "../presets.js";
import { canStart, experimentEstimate, start, startLabel } from "../runs.js";
import { count, aboutDuration, listed, sentence } from "../../../js/format.js";
import { ignored, page } from "../../../js/page-state.js";
import { agentOf, learns, limitsOf, titleOf } from "../../../js/settings.js";
import { connection, options, served } from "../../../js/store.js";
import { agentTitle, fieldTitle, simulatorTitle } from "../../../js/titles.js";
import { worldTitle } from "../../../js/disturbances.js";
import { Dialog, goToField, html, Icon, Segments, UnknownParts } from "../../../js/components/elements.js";
import { Held, Problem } from "../../../js/components/foot.js";
import { agentChoices, AllSettings, FIRST_SEED, placeSummary } from "./all-settings.js";
import { attributesOf, CountInput, Help, MistakeOf, ValuesInput, settingBy } from "./form-fields.js";

/** @import { Changed } from "../../../js/types.js" */
/** @import { ComponentChildren } from "preact" */

/** Whether the dialog of a new experiment is open. */
export const formIsOpen = signal(false);
/** Whether every setting is shown. */
const isUnfolded = signal(false);
/** What the config that is repeated has and no form can say. @type {import("@preact/signals").Signal<string[]>} */
export const unsayable = signal([]);

/** Open the dialog as it was left, or with the first preset. */
export function openForm() {
  if (isUntouched()) choosePreset(presets()[0].name);
  formIsOpen.value = true;
}

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
  const isWhole = isUnfolded.value || isMoreSet();
  return html`
    <${Dialog} id="experiment-dialog" labelledBy="new-experiment" isOpen=${formIsOpen}>
      <div class="dialog-head">
        <h2 id="new-experiment">New experiment</h2>
        <button class="quiet square" aria-label="Close" onClick=${() => (formIsOpen.value = false)}>✕</button>
      </div>
      <div class="dialog-fields">
        <${Cards} isWhole=${isWhole} />
        ${unsayable.value.length > 0 && html`<${Unsayable} />`}
        <${UnknownParts} parts=${ignored.experiments} />
        ${isWhole ? html`<${AllSettings} />` : html`<${Few} fields=${chosenPreset().fields} />`}
      </div>
      <div class="dialog-foot">
        <p class="cost" role="status">${costInWords()}</p>
        <${Problem} at="experiment" />
        <${Mistakes} />
        <div class="dialog-actions">
          ${!isMoreSet() && html`
            <button class="quiet" aria-expanded=${isUnfolded.value ? "true" : "false"}
              onClick=${() => (isUnfolded.value = !isUnfolded.value)}>
              ${isUnfolded.value ? "Fewer settings" : "All settings"}
            </button>
          `}
          <${StartButton} />
        </div>
      </div>
    <//>
  `;
}

/** How many trials the form would start, and for how long. */
function costInWords() {
  if (!canStart()) return "No trials yet: something above is missing.";
  const number = html`<b>${count(trials.value, "trial")}</b>`;
  const estimate = experimentEstimate.value;
  if (estimate) {
    const { seconds, workers } = estimate;
    return html`${number}, <b>${aboutDuration(seconds)}</b> on ${count(workers ?? 1, "core")}.`;
  }
  if (estimate === undefined) return html`${number}. Estimating how long…`;
  return html`${number}.${connection.value === "live" ? " How long they take is not known." : ""}`;
}

const Unsayable = () => html`
  <p class="notice" role="status">
    The form has no words for its own ${listed(unsayable.value.map((field) => fieldTitle(field).toLowerCase()))}: here
    stand the usual ones. “Run again” in the menu repeats all of it.
  </p>
`;

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
  `;
}

const Mistakes = () => Object.keys(mistakes.value).length > 0 && html`
  <${Held} id="held-experiment" mistakes=${mistakes.value} nameOf=${nameOf}
    onField=${(/** @type {string} */ field) => goToField(`experiment-${field}`)} />
`;

/** A field's name as this form shows it. @param {string} field */
const nameOf = (field) => (field === "seed" ? FIRST_SEED : fieldTitle(field));

/** @param {{ isWhole: boolean }} props */
const Cards = ({ isWhole }) => html`
  <fieldset class="cards" role="radiogroup" aria-invalid=${wrong.value.experiment ? "true" : undefined}
    aria-describedby=${wrong.value.experiment && "wrong-experiment"}>
    <legend class="sr-only">Experiment</legend>
    ${presets().map(({ name, title, about }, number) => html`
      <label class="card" key=${name}>
        <input class="sr-only" type="radio" name="experiment" id=${number ? undefined : "experiment-experiment"}
          aria-labelledby=${`card-${name}`} aria-describedby=${`about-card-${name}`}
          checked=${!wrong.value.experiment && chosenPreset().name === name}
          onChange=${() => choosePreset(name, isWhole)} />
        <b id=${`card-${name}`}>${title}</b><span id=${`about-card-${name}`}>${about}</span>
      </label>
    `)}
    <${MistakeOf} field="experiment" />
  </fieldset>
`;

// ---- the few fields of a preset, a line each

/** @param {{ fields: string[] }} props */
function Few({ fields }) {
  const isOfSetting = fields.includes("setting");
  return html`
    <div class="few-fields">
      ${isOfSetting && html`<${SweptRows} />`}
      ${fields.includes("agents") && (isOfSetting
        ? html`<${AgentRow} />`
        : html`<${AgentsRow} label=${chosenPreset().name === "learners" ? "Learners" : "Agents"} />`)}
      ${fields.includes("worlds") && html`<${WorldsRow} />`}
      ${fields.includes("steps") && takesField("steps") && html`
        <${Line} field="steps" label="Practice" unit="steps">
          <${ValuesInput} field="steps" setting=${settingBy("steps")} />
        <//>
      `}
      <${SeedsRow} isExplained=${isOfSetting} />
      <${SimulatorRow} />
      <p class="dim where-it-walks">${placeSummary()}</p>
    </div>
  `;
}

/**
 * A field in a line: its name, its control, and what is wrong with it.
 * @param {object} props
 * @param {string} props.field
 * @param {string} props.label
 * @param {string} [props.target] id of the control
 * @param {string} [props.unit]
 * @param {ComponentChildren} props.children
 */
const Line = ({ field, label, target = `experiment-${field}`, unit, children }) => html`
  <div class="line">
    <label for=${target}>${label}</label>
    <div class="line-control">
      <div class="line-value">${children}${unit && html`<span class="dim">${unit}</span>`}</div>
      <${MistakeOf} field=${field} />
    </div>
  </div>
`;

/** Which setting is swept, among all that can be, and its values. */
function SweptRows() {
  const field = sweptField();
  const own = Object.keys(agentOf(values.value.agents[0]).settings).filter((one) => sweepable().includes(one));
  const common = sweepable().filter((one) => !own.includes(one));
  const setting = settingBy(field);
  const suggested = suggestedValues(setting);
  const isOther = String(suggested) !== String(values.value[field]) && suggested.length > 1;
  return html`
    <${Line} field="" label="Setting" target="swept-setting">
      <select id="swept-setting" onChange=${(/** @type {Changed} */ { target }) => chooseSwept(target.value)}>
        <optgroup label=${agentTitle(values.value.agents[0])}><${Options} names=${own} chosen=${field} /></optgroup>
        <optgroup label="Every practice"><${Options} names=${common} chosen=${field} /></optgroup>
      </select>
    <//>
    <div class="line">
      <label for=${`experiment-${field}`}>Values</label>
      <div class="line-control">
        <div class="line-value">
          <${ValuesInput} key=${field} field=${field} setting=${setting} />
          ${isOther && html`
            <button class="link" title=${suggested.join(", ")} onClick=${() => setField(field, suggested)}>
              Suggest
            </button>
          `}
        </div>
        <${MistakeOf} field=${field} />
        <p class="sentence" id=${`about-${field}`}>${setting.help}</p>
      </div>
    </div>
  `;
}

/** @param {{ names: string[], chosen: string }} props */
const Options = ({ names, chosen }) => names.map((name) => html`
  <option key=${name} value=${name} selected=${name === chosen}>${titleOf(settingBy(name))}</option>
`);

/** @type {[string, (name: string) => boolean][]} */
const AGENT_GROUPS = [["Learners", learns], ["Others", (name) => !learns(name)]];

/** The one agent whose setting is swept, of those that have one. */
const AgentRow = () => html`
  <${Line} field="agents" label="Learner">
    <select ...${attributesOf("agents")}
      onChange=${(/** @type {Changed} */ { target }) => chooseAgent(target.value)}>
      ${AGENT_GROUPS.map(([title, isIn]) => html`
        <optgroup label=${title}>
          ${agentChoices().filter(([name]) => isIn(name) && Object.keys(agentOf(name).settings).length > 0)
            .map(([name, words]) => html`
              <option key=${name} value=${name} selected=${name === values.value.agents[0]}>${words}</option>
            `)}
        </optgroup>
      `)}
    </select>
  <//>
`;

/** @param {{ label: string }} props */
const AgentsRow = ({ label }) => html`
  <${Several} field="agents" label=${label} noun=${label === "Agents" ? "an agent" : "a learner"}
    choices=${agentChoices()} titleOf=${agentTitle} />
`;

const WorldsRow = () => html`
  <${Several} field="worlds" label="Worlds" noun="a world"
    choices=${served().worlds.map(({ name, title }) => [name, title])} titleOf=${worldTitle} />
`;

/**
 * Several out of many: those that are chosen, each to be taken out, and a list of the others.
 * @param {object} props
 * @param {string} props.field
 * @param {string} props.label
 * @param {string} props.noun
 * @param {[string, string][]} props.choices
 * @param {(name: string) => string} props.titleOf
 */
function Several({ field, label, noun, choices, titleOf: nameOfOne }) {
  const chosen = /** @type {string[]} */ (values.value[field]);
  const rest = choices.filter(([name]) => !chosen.includes(name));
  /** @param {string[]} names */
  const take = (names) => enter(field, names.join(","));
  return html`
    <div class="line" role="group" aria-label=${label}>
      <span class="line-label" aria-hidden="true">${label}</span>
      <div class="line-control">
        <div class="chosen">
          ${chosen.map((name) => html`
            <button key=${name} class="taken" aria-label=${`Take out ${nameOfOne(name)}`} title="Take it out"
              aria-disabled=${chosen.length < 2 ? "true" : undefined}
              onClick=${() => chosen.length > 1 && take(chosen.filter((one) => one !== name))}>
              ${field === "agents" && html`<i class="swatch" style=${{ "--agent": agentOf(name).color }}></i>`}
              ${nameOfOne(name)}${chosen.length > 1 && html`<span aria-hidden="true">✕</span>`}
            </button>
          `)}
          ${rest.length > 0 && html`
            <select ...${attributesOf(field)} aria-label=${`Add ${noun}`}
              onChange=${(/** @type {Changed} */ { target }) => {
                take([...chosen, target.value]);
                target.value = "";
              }}>
              <option value="" selected>Add ${noun}…</option>
              ${rest.map(([name, title]) => html`<option key=${name} value=${name}>${title}</option>`)}
            </select>
          `}
        </div>
        <${MistakeOf} field=${field} />
      </div>
    </div>
  `;
}

/** Most experiments need no more; the number beside the slider takes any that the server does. */
const SLIDER_SEEDS = 100;

/** @param {{ isExplained: boolean }} props */
function SeedsRow({ isExplained }) {
  const { minimum } = limitsOf("seeds");
  const min = minimum ?? 1;
  const reached = Math.min(Math.max(values.value.seeds, min), SLIDER_SEEDS);
  return html`
    <${Line} field="seeds" label="Seeds">
      <input type="range" aria-label="Seeds, by a slider" min=${min} max=${SLIDER_SEEDS} step="1" value=${reached}
        style=${{ "--share": `${100 * shareOf(reached, min, SLIDER_SEEDS)}%` }}
        onInput=${(/** @type {Changed} */ { target }) => setField("seeds", Number(target.value))} />
      <${CountInput} field="seeds" />
    <//>
    <div class=${isExplained ? "after-line" : "sr-only"}><${Help} field="seeds" /></div>
  `;
}

const SimulatorRow = () => html`
  <div class="line">
    <span class="line-label">Simulator</span>
    <div class="line-control">
      <${Segments} label="Simulator" value=${values.value.simulator}
        choices=${(options.value?.simulators ?? []).map(({ name }) => [name, sentence(simulatorTitle(name))])}
        onValue=${(/** @type {string} */ name) => setField("simulator", name)} />
      <${MistakeOf} field="simulator" />
      ${refusedFields("experiment").includes("simulator") && html`<${Help} field="simulator" />`}
    </div>
  </div>
`;
