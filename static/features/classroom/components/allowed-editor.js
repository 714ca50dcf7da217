// The settings that the card lets be changed, and within which bounds.
import { changeCard } from "../lessons/draft.js";
import { numberOf } from "../../../js/parse.js";
import { agentOf, rangeOf } from "../../../js/settings.js";
import { options } from "../../../js/store.js";
import { labelOf } from "../../../js/titles.js";
import { html } from "../../../js/components/elements.js";

/** @import { Bounds, LessonCard, SettingOption } from "../../../js/types.js" */

/** Fields of which one has a name. */
const NAMED = ["gait", "robot", "world", "simulator", "observation", "agent"];
/** A participant's seed is the room's; a pace would hold a core that others wait for. */
const NEVER = ["seed", "pace"];

/** Settings of the practice, of the race and of the robot. */
const COMMON = [
  "steps", "steps_per_episode", "evaluate_every", "race_steps", "divisions", "grid_side_m", "tolerance", "reward",
];

/** @param {LessonCard} card */
const agentOfCard = (card) => String(card.state?.form?.agent ?? "q-learning");

/** The settings that a card can open: of the practice, of its agent, and those with names. @param {LessonCard} card */
function openable(card) {
  const agentSettings = agentOf(agentOfCard(card)).settings;
  const served = options.value?.settings ?? {};
  return [...NAMED, ...Object.keys(agentSettings), ...COMMON.filter((name) => name in served)]
    .filter((name) => !NEVER.includes(name));
}

/** @type {(name: string, card: LessonCard) => SettingOption | null} */
const settingOf = (name, card) =>
  agentOf(agentOfCard(card)).settings[name] ?? options.value?.settings[name] ?? null;

/** @param {string} name */
function namesOf(name) {
  const { gaits = [], robots = [], worlds = [], simulators = [], observations = [], agents = [] } = options.value ?? {};
  const lists = /** @type {Record<string, { name: string, title: string }[]>} */ (
    { gait: gaits, robot: robots, world: worlds, simulator: simulators, observation: observations, agent: agents });
  return lists[name] ?? [];
}

/** @param {{ card: LessonCard }} props */
export function MayEditor({ card }) {
  const may = card.may ?? {};
  const change = (/** @type {string} */ name, /** @type {Partial<Bounds> | null} */ bounds) => {
    const { [name]: _, ...otherBounds } = may;
    changeCard({ may: bounds === null ? otherBounds : { ...otherBounds, [name]: bounds } });
  };
  const left = openable(card).filter((name) => !(name in may));
  const open = (/** @type {any} */ { target: { value } }) => value && change(value, firstBounds(value, card));
  return html`
    <fieldset class="may-editor">
      <legend>Settings that may be changed</legend>
      ${Object.entries(may).map(([name, bounds]) => html`
        <${One} key=${name} name=${name} bounds=${bounds} card=${card}
          onBounds=${(/** @type {Partial<Bounds> | null} */ now) => change(name, now)} />
      `)}
      <select aria-label="Open a setting" value="" onChange=${open}>
        <option value="">Open a setting…</option>
        ${left.map((name) => html`<option key=${name} value=${name}>${labelOf(name)}</option>`)}
      </select>
    </fieldset>
  `;
}

/** The bounds with which a setting is opened: all that is valid. @type {(name: string, card: LessonCard) => any} */
function firstBounds(name, card) {
  if (NAMED.includes(name)) return { choices: namesOf(name).slice(0, 2).map((item) => item.name) };
  const setting = settingOf(name, card);
  if (!setting?.is_number) return {};
  const { minimum, maximum } = setting;
  return { ...(minimum !== null && { minimum }), ...(maximum !== null && { maximum }) };
}

/** @param {{ name: string, bounds: any, card: LessonCard, onBounds: (bounds: any) => unknown }} props */
function One({ name, bounds, card, onBounds }) {
  const setting = settingOf(name, card);
  const limit = (/** @type {string} */ side) => (/** @type {any} */ { target }) => {
    const { [side]: _, ...otherSides } = bounds;
    const value = numberOf(target.value);
    onBounds(value === null ? otherSides : { ...otherSides, [side]: value });
  };
  return html`
    <div class="may-one" role="group" aria-label=${labelOf(name)}>
      <b>${labelOf(name)}</b>
      ${NAMED.includes(name) && html`<${Names} name=${name} bounds=${bounds} onBounds=${onBounds} />`}
      ${setting?.is_number && html`
        ${[["minimum", "From"], ["maximum", "to"]].map(([side, word]) => html`
          <label key=${side}>${word}
            <input type="text" inputmode="decimal" value=${bounds[side] ?? ""} onChange=${limit(side)} />
          </label>
        `)}
      `}
      <button class="quiet square small" aria-label=${`Close ${labelOf(name)}`} onClick=${() => onBounds(null)}>
        ✕
      </button>
      ${setting && html`<p class="fine dim">Valid: ${rangeOf(setting) || setting.valid}</p>`}
    </div>
  `;
}

/** @param {{ name: string, bounds: any, onBounds: (bounds: any) => unknown }} props */
function Names({ name, bounds, onBounds }) {
  const chosen = bounds.choices ?? [];
  const toggle = (/** @type {string} */ choice) => {
    const remaining = chosen.filter((/** @type {string} */ other) => other !== choice);
    const now = chosen.includes(choice) ? remaining : [...chosen, choice];
    if (now.length > 0) onBounds({ choices: now });
  };
  return html`
    <div class="panel-boxes">
      ${namesOf(name).map((item) => html`
        <label class="check" key=${item.name}>
          <input type="checkbox" checked=${chosen.includes(item.name)}
            onChange=${() => toggle(item.name)} />${item.title}
        </label>
      `)}
    </div>
  `;
}
