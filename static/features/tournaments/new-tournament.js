// The form of a new tournament. The walking problem is that of the page, or of the card of a room.
import { root } from "../../js/api.js";
import {
  busy, change, changeNumber, draft, failures, inFormWords, numberFields, open, ownRoom, readNumber, refused, requestOf,
  rooms, toggled, walk,
} from "./list.js";
import { walkInWords } from "./words.js";
import { presetOf } from "../../js/robots.js";
import { served } from "../../js/store.js";
import { robotChoices } from "../../js/titles.js";
import { html } from "../../js/components/elements.js";

/** @import { Changed } from "../../js/types.js" */

export function NewTournamentForm() {
  const isValid = requestOf(draft.value, walk.value) !== null;
  const canOpen = isValid && !busy.value.open;
  const send = (/** @type {Event} */ event) => {
    event.preventDefault();
    if (canOpen) open();
  };
  return html`
    <form class="new-tournament" onSubmit=${send}>
      <${TitleAndRoom} />
      <${Walk} />
      <div class="number-fields">
        ${numberFields().map(([name, { title }]) => html`<${NumberOf} key=${name} name=${name} title=${title} />`)}
      </div>
      <${Choices} name="worlds" legend="Worlds, of which each seed has one"
        choices=${served().worlds.map(({ name, title }) => [name, title])} />
      <${Creatures} />
      <label class="check">
        <input type="checkbox" checked=${draft.value.tables}
          onChange=${(/** @type {Changed} */ { target }) => change({ tables: target.checked })} />
        Trained tables may enter
      </label>
      <div role="alert">
        ${failures.value.open && !isPlaced() && html`<p class="problem">${problem()}</p>`}
      </div>
      <button class="primary" type="submit" aria-disabled=${canOpen ? undefined : "true"}>
        ${busy.value.open ? "Opening…" : "Open the tournament"}
      </button>
    </form>
  `;
}

/** @param {string} field */
const isAbout = (field) => Boolean(failures.value.open) && (refused.value.open ?? []).includes(field);
/** Whether the refusal stands beside a field. */
const isPlaced = () => ["title", "room", "worlds", "robots", ...numberFields().map(([name]) => name)].some(isAbout);

const problem = () => inFormWords(failures.value.open);

/** @param {{ field: string }} props */
const Refusal = ({ field }) => isAbout(field) && html`<p class="bad" role="alert">${problem()}</p>`;

const TitleAndRoom = () => html`
  <div class="field">
    <label for="tournament-title">Title</label>
    <input id="tournament-title" type="text" maxlength="80" autocomplete="off" placeholder="Tournament"
      value=${draft.value.title} onInput=${(/** @type {Changed} */ { target }) => change({ title: target.value })} />
    <${Refusal} field="title" />
  </div>
  ${ownRoom.value === null && html`
    <div class="field">
      <label for="tournament-room">Who may enter</label>
      <select id="tournament-room" onChange=${(/** @type {Changed} */ { target }) => change({ room: target.value })}>
        <option value="" selected=${draft.value.room === ""}>Operators of this server</option>
        ${rooms.value.map(({ code, title }) => html`
          <option key=${code} value=${code} selected=${draft.value.room === code}>Room ${code}: ${title}</option>
        `)}
      </select>
      <${Refusal} field="room" />
    </div>
  `}
`;

/** On which robot all walk, and how, which is not chosen here. */
const Walk = () => html`
  <div class="taken-walk">
    <p><b>${ownRoom.value === null ? "All walk as the page is set" : "All walk as the card is set"}</b></p>
    <p class="dim">${walkInWords(/** @type {any} */ (walk.value))}</p>
    <p class="fine dim">
      ${ownRoom.value === null
        ? "To change it, close this, and choose gait, robot and simulator in Train and World."
        : html`For another robot or gait, <a href=${root()}>open it from the dashboard</a>, for this room.`}
    </p>
  </div>
`;

/** @param {{ name: string, title: string }} props */
function NumberOf({ name, title }) {
  const { mistake } = readNumber(draft.value, name);
  const id = `tournament-${name}`;
  return html`
    <div class="field">
      <label for=${id}>${title}</label>
      <input id=${id} type="text" inputmode="numeric" autocomplete="off" value=${draft.value.numbers[name]}
        aria-invalid=${mistake || isAbout(name) ? "true" : undefined} aria-describedby=${`about-${id}`}
        onInput=${(/** @type {Changed} */ { target }) => changeNumber(name, target.value)} />
      <div id=${`about-${id}`}>
        ${mistake && html`<p class="bad" role="alert">${mistake}</p>`}
        <${Refusal} field=${name} />
      </div>
    </div>
  `;
}

/** @param {{ name: "worlds" | "robots", legend: string, choices: [string, string][] }} props */
const Choices = ({ name, legend, choices }) => html`
  <fieldset>
    <legend>${legend}</legend>
    <div class="panel-boxes">
      ${choices.map(([value, title]) => html`
        <label class="check" key=${value}>
          <input type="checkbox" checked=${draft.value[name].includes(value)}
            onChange=${() => change({ [name]: toggled(draft.peek()[name], value, choices.map(([other]) => other)) })} />
          ${title}
        </label>
      `)}
    </div>
    ${name === "worlds" && draft.value.worlds.length === 0 && html`
      <p class="bad" role="alert">Choose at least one.</p>
    `}
    <${Refusal} field=${name} />
  </fieldset>
`;

function Creatures() {
  const preset = presetOf(/** @type {any} */ (walk.value.robot));
  const otherRobots = robotChoices([]).filter(([name]) => name !== preset);
  return html`
    <details>
      <summary>Other creatures that may enter <span class="dim">${draft.value.robots.length || "none"}</span></summary>
      <${Choices} name="robots" legend="Creatures, each in the gait that suits it" choices=${otherRobots} />
    </details>
  `;
}
