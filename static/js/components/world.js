// The form's worlds: those with a name as small pictures, and disturbances with their steps.
import { adjectiveOf, kindFor, legIn, legStates, shortName, splitText, textOf, withField } from "../disturbances.js";
import { form, mistakeInText, setField, wrong } from "../form.js";
import { azimuthsOf } from "../robots.js";
import { fullTitle, isAllowed, isClosed } from "../settings.js";
import { served } from "../store.js";
import { classOf, html, LegPicker } from "./elements.js";
import { Description, MistakeOf } from "./fields.js";
import { firstFields } from "./world-controls.js";

/** @import { Changed, Disturbance, FieldOption } from "../types.js" */

// ---- named worlds

/** Where a leg is drawn from the side, legs with low numbers in front. */
const LEGS_X = [30, 19, 7, -7, -19, -30];
const GROUND_Y = 15;
const ROUGH = "M-36 15l5-4 5 5 6-7 6 6 5-4 5 5 6-6 6 5 5-5 6 6 5-4 6 4";

/**
 * A world from the side: the robot on its ground, drawn by its disturbances.
 * @param {{ disturbances: Disturbance[] }} props
 */
export function WorldPicture({ disturbances }) {
  /** @param {string} kind */
  const of = (kind) => disturbances.find((disturbance) => disturbance.kind === kind);
  const states = legStates(disturbances);
  const weak = of("weak");
  const [noise, payload, patch, friction] = ["sensor-noise", "payload", "patch", "friction"].map(of);
  const slope = of("slope");
  const turned = slope ? `rotate(${-Math.min(20, 1.5 * Number(slope.degrees))})` : undefined;
  const body = weak ? 6 : 0;
  return html`
    <svg class="world-picture" viewBox="-38 -22 76 44" aria-hidden="true">
      <g transform=${turned}>
        ${of("rough") ? html`<path class="ground" d=${ROUGH} />`
          : html`<path class=${friction ? "ground slick" : "ground"} d="M-36 15H36" />`}
        ${friction && html`<path class="slick" d="M-30 19h10M-12 19h16M14 19h12" />`}
        ${patch && html`<path class="patch" d="M4 15H26" />`}
        ${LEGS_X.map((x, n) => {
          const state = classOf(states.get(n + 1));
          const foot = state === "stuck" ? GROUND_Y - 12 : GROUND_Y;
          return html`
            <path class=${`side-leg ${state}`} d=${`M${0.45 * x} ${body} L${0.8 * x} ${body - 9} L${x} ${foot}`} />
            ${noise && html`<circle class="noise" cx=${x} cy=${foot} r="4.5" />`}
          `;
        })}
        <rect class="side-body" x="-15" y=${body - 4} width="30" height="9" rx="4.5" />
        ${payload && html`
          <rect class="load" x=${Number(payload.x_m) > 0 ? 1 : -5} y=${body - 14} width="10" height="10" rx="1" />
        `}
      </g>
    </svg>
  `;
}

const worldChoices = () => served().worlds.filter(({ name }) => isAllowed("world", name));

export const WorldPicker = () => html`
  <fieldset role="radiogroup" disabled=${isClosed("world")} aria-invalid=${wrong.value.world ? "true" : undefined}
    aria-describedby=${wrong.value.world ? "mistake-world help-world" : "help-world"}>
    <legend><h3>World</h3></legend>
    <div class="gait-row">
      ${worldChoices().map(({ name, title, disturbances }, number) => html`
        <label class="gait" key=${name}>
          <input class="sr-only" type="radio" name="world" value=${name} id=${number ? undefined : "field-world"}
            checked=${name === (wrong.value.world?.text ?? form.value.world)}
            onChange=${() => setField("world", name)} />
          <${WorldPicture} disturbances=${disturbances} />
          <span>${title}</span>
        </label>
      `)}
    </div>
    <${MistakeOf} field="world" />
    <${Description} field="world"
      words=${served().worlds.find(({ name }) => name === form.value.world)?.description} />
  </fieldset>
`;

// ---- disturbances, each with its step

/** @param {string[]} texts */
const setDisturbances = (texts) => setField("disturb", texts);

/** Disturbances to come, each with its fields; a text of a link that is no disturbance stands as it is. */
export function Disturbances() {
  const texts = form.value.disturb;
  const worlds = served().worlds.filter(({ disturbances }) => disturbances.length);
  const at_step = Math.floor(form.value.race_steps / 2);
  /** @param {{ target: HTMLSelectElement }} event */
  const add = ({ target }) => {
    const [what, name] = target.value.split(" ");
    const added = what === "world"
      ? (worlds.find((world) => world.name === name)?.disturbances ?? [])
        .map((disturbance) => textOf({ ...disturbance, at_step }))
      : [textOf({ kind: name, ...firstFields(name, form.value.robot), at_step })];
    target.value = "";
    setDisturbances([...texts, ...added]);
  };
  return html`
    <fieldset class="disturbances" disabled=${isClosed("disturb")} id="field-disturb" tabindex="-1"
      aria-describedby="help-disturb">
      <legend><h3>Disturbances</h3></legend>
      <p class="sentence" id="help-disturb">
        In the race, after practice in the world above; in the practice, if there is no race.
      </p>
      ${texts.map((text, number) => html`
        <${DisturbanceRow} key=${number} text=${text} number=${number}
          onText=${(/** @type {string} */ changed) => setDisturbances(texts.with(number, changed))}
          onRemove=${() => setDisturbances(texts.filter((_, n) => n !== number))} />
      `)}
      <select class="add" aria-label="Add a disturbance" onChange=${add}>
        <option value="">Add a disturbance…</option>
        <optgroup label="Named">
          ${worlds.map(({ name, title }) => html`<option value=${`world ${name}`}>${title}</option>`)}
        </optgroup>
        <optgroup label="With its own values">
          ${served().disturbances.map(({ name, title }) => html`<option value=${`kind ${name}`}>${title}</option>`)}
        </optgroup>
      </select>
    </fieldset>
  `;
}

/** @param {{ text: string, number: number, onText: (text: string) => unknown, onRemove: () => unknown }} props */
function DisturbanceRow({ text, number, onText, onRemove }) {
  const { kind: name, fields } = splitText(text);
  const kind = kindFor(name, form.value.robot, legIn(fields));
  const mistake = mistakeInText(text, form.value.simulator, form.value.robot);
  const { robot, gait } = form.value;
  /** @param {string} field */
  const textOfField = (field) => fields.find(([key]) => key === field || key === shortName(name, field))?.[1] ?? "";
  const legs = textOfField("legs").split(",").map(Number).filter(Boolean);
  /** @param {number} leg */
  const toggle = (leg) => {
    const chosen = legs.includes(leg) ? legs.filter((other) => other !== leg) : [...legs, leg].sort((a, b) => a - b);
    onText(withField(text, "legs", chosen.join(",")));
  };
  const words = adjectiveOf(name);
  return html`
    <div class="disturbance-row" role="group" aria-label=${kind?.title ?? text}>
      <div class="disturbance-head">
        <b>${kind?.title ?? text}</b>
        <button type="button" class="quiet square small" aria-label=${`Remove ${kind?.title ?? text}`}
          onClick=${onRemove}>✕</button>
      </div>
      ${kind && html`
        <div class="disturbance-fields">
          ${kind.fields.legs && html`
            <${LegPicker} azimuths=${azimuthsOf(robot, gait, served())} onLeg=${toggle}
              states=${new Map(legs.map((leg) => [leg, words]))}
              verbOf=${(/** @type {number} */ leg) => (legs.includes(leg) ? "Leave out" : "Add")} />
          `}
          ${Object.entries(kind.fields).filter(([, field]) => !field.is_list).map(([field, setting]) => html`
            <${DisturbanceField} key=${field} id=${`disturbance-${number}-${field}`} field=${field} setting=${setting}
              value=${textOfField(field)}
              onValue=${(/** @type {string} */ value) => onText(withField(text, field, value))} />
          `)}
        </div>
      `}
      ${mistake && html`<span class="mistake" role="alert">${mistake}</span>`}
    </div>
  `;
}

/** Steps are counted from 1 here, and from 0 in texts; the last step is the one before `until`. */
const AT = "at_step";
/** @type {Record<string, string>} */
const TITLES = { at_step: "From step", until_step: "To step" };
const WHOLE = /^\d+$/;

/**
 * @param {object} props
 * @param {string} props.id
 * @param {string} props.field
 * @param {FieldOption} props.setting
 * @param {string} props.value
 * @param {(value: string) => unknown} props.onValue
 */
function DisturbanceField({ id, field, setting, value, onValue }) {
  const title = TITLES[field] ?? fullTitle(setting);
  if (setting.choices.length) {
    return html`
      <label class="disturbance-field" for=${id}>${title}
        <select id=${id} title=${setting.help} onChange=${(/** @type {Changed} */ { target }) => onValue(target.value)}>
          ${setting.choices.map((choice) => html`
            <option value=${choice} selected=${choice === value}>${choice}</option>
          `)}
        </select>
      </label>
    `;
  }
  const isAt = field === AT;
  const shown = isAt && (value === "" || WHOLE.test(value)) ? String(Number(value) + 1) : value;
  const placeholder = field === "until_step" ? "the end" : String(setting.default ?? "");
  /** @param {{ target: HTMLInputElement | HTMLSelectElement }} event */
  const take = ({ target }) => {
    const typed = target.value.trim().replaceAll(":", "");
    onValue(isAt && WHOLE.test(typed) ? String(Number(typed) - 1) : typed);
  };
  return html`
    <label class="disturbance-field" for=${id}>${title}
      <input type="text" id=${id} inputmode="decimal" autocomplete="off" title=${setting.help} value=${shown}
        placeholder=${placeholder} onChange=${take} />
    </label>
  `;
}
