// The form of an entry: an agent with its settings, or a table that was trained before.
import { useEffect } from "preact/hooks";
import { html } from "../../js/components/elements.js";
import { NumberRow } from "../../js/components/number-row.js";
import { count, sentence, whole } from "../../js/format.js";
import { parseSetting } from "../../js/parse.js";
import { isAway } from "../../js/store.js";
import { agentOf, choiceTitle, fullTitle, kindOf, rangeOf } from "../../js/settings.js";
import { messageOf, robotTitle } from "../../js/titles.js";
import {
  agentGroups, agentIn, change, changedSettings, draft, readSteps, requestOf, settingsOfEntry, setText, stepLimits,
  textOf,
} from "./draft.js";
import { loadTables, tables } from "./tables.js";
import { busy, enter, failures, shownTournament, refused } from "./tournament.js";
import { choicesInWords, entriesLeft } from "./words.js";

/** @import { Changed, Run, SettingOption } from "../../js/types.js" */

export function Enter() {
  const { own, rules, room, entries_per_hour, state } = shownTournament();
  // Who has used up the entries of this hour goes on with the form.
  const isEntrant = own.may_enter || own.left !== null;
  useEffect(() => {
    if (rules.tables && isEntrant) loadTables(shownTournament());
  }, [isEntrant]);
  if (state !== "open") return null;
  return html`
    <section class="panel enter" aria-labelledby="enter-title">
      <h2 id="enter-title">Enter the tournament</h2>
      ${isEntrant ? html`
        <p class="dim entries-left" role="status">${isAway.value ? "" : entriesLeft(own, entries_per_hour)}</p>
        <${Fields} />
      ` : html`
        <p>${own.reason}</p>
        ${room && html`<a class="secondary as-button" href=${`../r/${room}`}>Go to the room ${room}</a>`}
      `}
    </section>
  `;
}

/** Told before one enters: `hexapods verify` needs it, and other entries are compared with it. */
const KEPT = "At the end everybody sees what you entered, and without your name once the room is gone.";

function Fields() {
  const { rules, own, is_operator } = shownTournament();
  const { body, mistakes } = requestOf(draft.value, rules, tables.value ?? []);
  const canEnter = body !== null && own.may_enter && !busy.value.enter;
  const send = (/** @type {Event} */ event) => {
    event.preventDefault();
    if (canEnter) enter(body);
  };
  const isTable = draft.value.training !== "";
  const choices = choicesInWords(rules);
  return html`
    <form class="entry-form" onSubmit=${send}>
      ${choices && html`<p class="dim">${choices}</p>`}
      ${rules.tables && (tables.value ?? []).length > 0 && html`<${TableField} />`}
      ${!isTable && html`
        <${AgentField} />
        ${agentOf(agentIn(draft.value)).learns && html`<${StepsField} />`}
        ${rules.robots.length > 0 && html`<${RobotField} />`}
        <${Settings} mistakes=${mistakes} />
      `}
      ${is_operator ? html`<${NameField} />` : html`<p class="fine dim">${KEPT}</p>`}
      ${own.reason && own.left !== 0 && html`<p role="status">${own.reason}</p>`}
      <button class="primary" type="submit" aria-disabled=${canEnter ? undefined : "true"}>
        ${busy.value.enter ? "Entering…" : "Enter"}
      </button>
      <${General} />
    </form>
  `;
}

// ---- refusals of the server, beside the field that they are about

/** The fields of the form that can be refused by themselves. */
const OWN_FIELDS = ["agent", "steps", "robot", "training_id", "name"];

/** @param {string} field */
const isAbout = (field) => Boolean(failures.value.enter) && (refused.value.enter ?? []).includes(field);

/** Whether the last refusal stands beside a field. */
const hasPlace = () => {
  const shown = draft.value.training
    ? ["training_id", "name"]
    : [...OWN_FIELDS, ...settingsOfEntry(draft.value).map(([name]) => name)];
  return shown.some(isAbout);
};

/** Why it was refused, with the names of this form. */
const problem = () => messageOf({ message: failures.value.enter });

/** @param {{ field: string }} props */
const Refusal = ({ field }) => isAbout(field) && html`
  <p class="bad" role="alert" id=${`refused-${field}`}>${problem()}</p>
`;

const General = () => html`
  <div role="alert">${failures.value.enter && !hasPlace() && html`<p class="problem">${problem()}</p>`}</div>
`;

/** @param {string} field */
const refusalAttributes = (field) => (isAbout(field)
  ? { "aria-invalid": "true", "aria-describedby": `refused-${field}` }
  : {});

// ---- what enters

/** @param {Run} run */
const trainingTitle = ({ name, config, id, progress }) =>
  `${name || `${agentOf(config.agent).title} ${id.slice(0, 6)}`}, ${count(progress.done, "step")}`;

const TableField = () => html`
  <div class="field">
    <label for="entry-training">What enters</label>
    <select id="entry-training" ...${refusalAttributes("training_id")}
      onChange=${(/** @type {Changed} */ { target }) => change({ training: target.value })}>
      <option value="" selected=${draft.value.training === ""}>An agent, which practises on each seed</option>
      <optgroup label="A table I trained">
        ${(tables.value ?? []).map((run) => html`
          <option key=${run.id} value=${run.id} selected=${run.id === draft.value.training}>
            ${trainingTitle(run)}
          </option>
        `)}
      </optgroup>
    </select>
    <${Refusal} field="training_id" />
  </div>
`;

const AgentField = () => html`
  <div class="field">
    <label for="entry-agent">Agent</label>
    <select id="entry-agent" ...${refusalAttributes("agent")}
      onChange=${(/** @type {Changed} */ { target }) => change({ agent: target.value })}>
      ${agentGroups().map(([title, agents]) => html`
        <optgroup key=${title} label=${title}>
          ${agents.map((agent) => html`
            <option key=${agent.name} value=${agent.name} selected=${agent.name === agentIn(draft.value)}>
              ${agent.title}
            </option>
          `)}
        </optgroup>
      `)}
    </select>
    <p class="dim">${agentOf(agentIn(draft.value)).description}</p>
    <${Refusal} field="agent" />
  </div>
`;

function StepsField() {
  const { rules } = shownTournament();
  const { steps } = draft.value;
  return html`
    <${NumberRow} id="entry-steps" label="Steps of practice" limits=${stepLimits(rules)} isWhole=${true}
      text=${steps === "" ? String(rules.steps) : steps} parsed=${readSteps(draft.value, rules)}
      words=${`On each seed, at most ${whole(rules.steps)}.`}
      onText=${(/** @type {string} */ text) => change({ steps: text || " " })} />
    <${Refusal} field="steps" />
  `;
}

const RobotField = () => html`
  <div class="field">
    <label for="entry-robot">Creature</label>
    <select id="entry-robot" ...${refusalAttributes("robot")}
      onChange=${(/** @type {Changed} */ { target }) => change({ robot: target.value })}>
      <option value="" selected=${draft.value.robot === ""}>${robotTitle(shownTournament().rules.robot)}</option>
      ${shownTournament().rules.robots.map((robot, number) => html`
        <option key=${number} value=${number} selected=${draft.value.robot === String(number)}>
          ${robotTitle(robot)}, in the gait that suits it
        </option>
      `)}
    </select>
    <${Refusal} field="robot" />
  </div>
`;

const NameField = () => html`
  <div class="field">
    <label for="entry-name">Name of the entry</label>
    <input id="entry-name" type="text" maxlength="40" placeholder="optional" autocomplete="off"
      value=${draft.value.name} ...${refusalAttributes("name")}
      onInput=${(/** @type {Changed} */ { target }) => change({ name: target.value })} />
    <${Refusal} field="name" />
  </div>
`;

// ---- the settings that the agent declares

/** @param {{ mistakes: Record<string, string> }} props */
function Settings({ mistakes }) {
  const settings = settingsOfEntry(draft.value);
  const names = settings.map(([name]) => name);
  const wrong = names.filter((name) => name in mistakes);
  // A refusal is shown, not folded away.
  const isRefused = names.some(isAbout);
  const words = wrong.length
    ? html`<span class="bad">Not valid: ${settings.filter(([name]) => name in mistakes)
      .map(([, { title }]) => title.toLowerCase()).join(", ")}</span>`
    : html`<span class="dim">${changedSettings(draft.value).join(" · ") || "the agent’s defaults"}</span>`;
  return settings.length > 0 && html`
    <details class="entry-settings" open=${isRefused || undefined}>
      <summary><b>Settings</b> ${words}</summary>
      <div class="entry-settings-fields">
        ${settings.map(([name, setting]) => html`
          <${Setting} key=${`${agentIn(draft.value)} ${name}`} name=${name} setting=${setting} />
          <${Refusal} field=${name} />
        `)}
      </div>
    </details>
  `;
}

/** @param {{ name: string, setting: SettingOption }} props */
function Setting({ name, setting }) {
  const text = textOf(draft.value, name, setting);
  const onText = (/** @type {string} */ typed) => setText(name, typed);
  const parsed = parseSetting(text, setting);
  const kind = kindOf(setting);
  if (kind === "number") {
    const range = rangeOf(setting);
    return html`
      <${NumberRow} id=${`entry-${name}`} label=${fullTitle(setting)} limits=${setting} isWhole=${setting.is_whole}
        text=${text} parsed=${parsed} words=${[setting.help, range && `${sentence(range)}.`].join(" ")}
        onText=${onText} />
    `;
  }
  const Control = kind === "switch" ? Switch : kind === "choice" ? Choice : Text;
  return html`
    <div class=${kind === "switch" ? "field switch" : "field"}>
      <label for=${`entry-${name}`}>${fullTitle(setting)}</label>
      <${Control} id=${`entry-${name}`} setting=${setting} text=${text} onText=${onText}
        isWrong=${parsed.mistake !== undefined} />
      <p id=${`about-entry-${name}`} class=${parsed.mistake ? "bad" : "dim"}
        role=${parsed.mistake ? "alert" : undefined}>${parsed.mistake ?? setting.help}</p>
    </div>
  `;
}

/**
 * @typedef {{
 *   id: string, setting: SettingOption, text: string, isWrong: boolean, onText: (text: string) => unknown,
 * }} Control
 */

/** @param {Control} props */
const Switch = ({ id, text, onText }) => html`
  <input id=${id} type="checkbox" checked=${text === "true"} aria-describedby=${`about-${id}`}
    onChange=${(/** @type {Changed} */ { target }) => onText(String(target.checked))} />
`;

/** @param {Control} props */
const Choice = ({ id, setting, text, onText }) => html`
  <select id=${id} aria-describedby=${`about-${id}`}
    onChange=${(/** @type {Changed} */ { target }) => onText(target.value)}>
    ${setting.default === null && html`<option value="" selected=${text === ""}>by default</option>`}
    ${setting.choices.map((choice) => html`
      <option key=${choice} value=${choice} selected=${choice === text}>
        ${sentence(choiceTitle(setting, String(choice)))}</option>
    `)}
  </select>
`;

/** @param {Control} props */
const Text = ({ id, setting, text, isWrong, onText }) => html`
  <input id=${id} type="text" value=${text} placeholder=${setting.valid} autocomplete="off"
    aria-invalid=${isWrong ? "true" : undefined} aria-describedby=${`about-${id}`}
    onInput=${(/** @type {Changed} */ { target }) => onText(target.value)} />
`;
