// What happens to a robot and its ground: a drawn hexapod whose legs are clicked, and sliders; for the training that
// runs, and for a race that is held, which is raced on from there.
import { signal } from "@preact/signals";
import { useRef, useState } from "preact/hooks";
import { branchRace, disturb, pending } from "../actions.js";
import {
  conditionsAt, conditionsInWords, conditionsNow, happeningsOf, isSimulated, kindNamed, LEG_WORDS, legStates, mainField,
  PUSH, shortName, splitText, textOf, toggled, withField, withUnit,
} from "../disturbances.js";
import { form, mistakeInText, setField, wrong } from "../form.js";
import { listed } from "../format.js";
import { azimuthsOf } from "../robots.js";
import { heldRace, liveTraining, stepShown } from "../selectors.js";
import { fullTitle, sliderOf } from "../settings.js";
import { served } from "../store.js";
import { html, pointAt, Problem } from "./elements.js";
import { Description, MistakeOf } from "./fields.js";

// ---- the drawn hexapod, forward up; each leg is a button

const FOOT = 37;
const HIP = 13;
const KNEE = 24;

/**
 * @param {object} props
 * @param {number[]} props.azimuths of the legs from forward [°]
 * @param {Map<number, string>} props.states what happened to legs, by their numbers
 * @param {(leg: number) => void} props.onLeg
 * @param {boolean} [props.isDisabled]
 * @param {string} [props.describedBy]
 * @param {[string, string]} [props.verbs] what a click does to a leg without and with a state
 */
export function LegPicker({ azimuths, states, onLeg, isDisabled = false, describedBy, verbs }) {
  const legs = azimuths.map((azimuth, n) => ({ azimuth, leg: n + 1, state: states.get(n + 1) }));
  return html`
    <div class="leg-picker" role="group" aria-label="Legs, seen from above"
      aria-describedby=${describedBy}>
      <svg viewBox="-50 -50 100 100" aria-hidden="true">
        ${legs.map(({ azimuth, leg, state }) => html`
          <path key=${leg} class=${`drawn-leg ${classOf(state)}`}
            d=${`M${pointAt(azimuth, HIP)} L${pointAt(azimuth, KNEE)} L${pointAt(azimuth, FOOT)}`} />
        `)}
        <circle class="body" r=${HIP} /><path class="forward" d="M0-8 6 2H-6z" />
      </svg>
      ${legs.map(({ azimuth, leg, state }) => {
        const [x, y] = pointAt(azimuth, FOOT).map((part) => `${50 + Number(part)}%`);
        const does = state ? verbs?.[1] ?? "Repair" : verbs?.[0] ?? "Break";
        return html`
          <button key=${leg} type="button" style=${{ left: x, top: y }} aria-pressed=${state ? "true" : "false"}
            aria-disabled=${isDisabled ? "true" : undefined} title=${`${does} leg ${leg}`}
            aria-label=${`Leg ${leg}${state ? `, ${state}` : ""}`} onClick=${() => !isDisabled && onLeg(leg)}>
            ${leg}
          </button>
        `;
      })}
    </div>
  `;
}

const classOf = (state) => (state ? state.split(" ").at(-1) : "");

// ---- sliders for what has one number: slope, friction, payload, a push

/** What happens with one number, as the server lists it. */
const slidable = () => served().disturbances.flatMap((kind) => {
  const main = mainField(kind.name);
  return main ? [{ kind, name: main[0], field: main[1] }] : [];
});

const PAUSE_MS = 500;

/** It takes effect when the slider, or its key, has been let go: a run has only so many disturbances. */
function KindSlider({ one: { kind, name, field }, conditions, simulator, onHappen }) {
  const [draft, setDraft] = useState(/** @type {number | null} */ (null));
  const timer = useRef(/** @type {ReturnType<typeof setTimeout> | undefined} */ (undefined));
  const ends = sliderOf(field) ?? { min: 0, max: 1, step: 0.01 };
  const present = conditions.find((other) => other.kind === kind.name)?.[name];
  const value = draft ?? present ?? null;
  const isKnown = isSimulated(kind.name, simulator);
  const isPush = kind.name === PUSH;
  const id = `happen-${kind.name}`;
  const send = async (chosen) => {
    await onHappen({ kind: kind.name, [name]: chosen });
    if (!isPush) setDraft(null);
  };
  const onChange = ({ target }) => {
    clearTimeout(timer.current);
    if (!isPush) timer.current = setTimeout(() => send(Number(target.value)), PAUSE_MS);
  };
  // Friction has no value at which nothing happens: it is the robot's own until it is set.
  const at = value ?? (field.minimum === 0 ? 0 : 1);
  const neutral = field.minimum === 0 ? withUnit(0, field.unit) : "as built";
  const words = value === null ? neutral : withUnit(value, field.unit);
  return html`
    <div class="slider happen">
      <label for=${id} title=${kind.description}>${kind.title}</label>
      <input type="range" id=${id} min=${ends.min} max=${ends.max} step=${ends.step} value=${at} disabled=${!isKnown}
        style=${{ "--share": `${(100 * (at - ends.min)) / (ends.max - ends.min)}%` }} aria-valuetext=${words}
        onInput=${({ target }) => setDraft(Number(target.value))}
        onChange=${onChange} />
      <output class="num" for=${id}>${words}</output>
      ${isPush && html`
        <button type="button" class="secondary compact" disabled=${!isKnown || !value} onClick=${() => send(value)}>
          Push it
        </button>
      `}
    </div>
  `;
}

// ---- both together

/** Why legs of a simulator's robot cannot be broken; empty if they can. */
function reasonAgainst(simulator) {
  if (isSimulated("limp", simulator)) return "";
  const known = served().disturbances.filter(({ simulators }) => simulators.includes(simulator));
  const titles = listed(known.map(({ title }) => title.toLowerCase()));
  return `The ideal simulator has no ground and no servos: only ${titles} can happen there.`;
}

/** `conditions`: what holds; `onHappen` takes what is to happen, without its step. */
function WorldControls({ id, config, conditions, onHappen, sentenceOf, children }) {
  const { robot, gait, simulator } = config;
  const reason = reasonAgainst(simulator);
  const now = conditionsInWords(conditions);
  return html`
    <div class="break">
      <${LegPicker} azimuths=${azimuthsOf(robot, gait, served().gaits)} states=${legStates(conditions)}
        isDisabled=${Boolean(reason)} describedBy=${`${id}-words`}
        onLeg=${(leg) => onHappen(toggled(conditions, leg))} />
      <div class="break-words">
        <p id=${`${id}-words`} role="status">${sentenceOf(now)}</p>
        <p class="sentence">${reason || "Press a leg to make it limp; press it again to repair it."}</p>
        ${children}
      </div>
    </div>
    <details class="more">
      <summary>Ground, load and servos</summary>
      <div class="sliders">
        ${slidable().map((one) => html`
          <${KindSlider} key=${one.kind.name} one=${one} conditions=${conditions} simulator=${simulator}
            onHappen=${onHappen} />
        `)}
      </div>
    </details>
  `;
}

/** What can happen to the training that runs. */
export function LiveWorld() {
  const run = liveTraining.value;
  if (!run) return null;
  const words = (now) => (now.length ? html`<b>Now:</b> ${now.join(", ")}` : "Nothing has happened to this robot.");
  return html`
    <section class="world-now" aria-label="What happens now">
      <${WorldControls} id="live" config=${run.config} conditions=${conditionsNow(run)} sentenceOf=${words}
        onHappen=${(one) => disturb(run, one)} />
      <${Problem} at="disturb" />
    </section>
  `;
}

// ---- a race that is held: something happens, and it is raced on from there

/** Shown while the replay of a race is held. */
export const Branch = () => heldRace.value && html`<${BranchOf} key=${heldRace.value.id} race=${heldRace.value} />`;

/** Kept while the replay goes on to another moment. */
const isBranchOpen = signal(false);

function BranchOf({ race }) {
  const [chosen, setChosen] = useState(/** @type {any[]} */ ([]));
  const { config } = race;
  // At the end nothing is left to walk: the middle is offered.
  const from = stepShown.value ?? Math.floor(config.steps / 2) + 1;
  const before = conditionsAt(happeningsOf(race), from - 1);
  const conditions = conditionsAt([...before, ...chosen].map((one) => ({ ...one, at_step: 0 })), 0);
  const words = (now) => {
    const pushes = chosen.filter(({ kind }) => kind === PUSH).length ? ["a push"] : [];
    return html`<b>From step ${from}:</b> ${[...now, ...pushes].join(", ") || "as it was"}`;
  };
  const start = () => {
    isBranchOpen.value = false;
    branchRace(race, from - 1, chosen);
  };
  return html`
    <details class="more branch" open=${isBranchOpen.value}
      onToggle=${({ target, currentTarget }) => target === currentTarget && (isBranchOpen.value = target.open)}>
      <summary>What if something had happened in this race?</summary>
      <${WorldControls} id="branch" config=${config} conditions=${conditions} sentenceOf=${words}
        onHappen=${(one) => setChosen((all) => [...all.filter((other) => !replaces(one, other)), one])}>
        <button type="button" class="secondary" disabled=${!chosen.length || pending.value.branch} onClick=${start}>
          Race on from ${stepShown.value === null ? `step ${from}` : "here"}
        </button>
      <//>
      <p class="sentence">Until then both races are the same. Hold the replay elsewhere for another step.</p>
      <${Problem} at="branch" />
    </details>
  `;
}

/** Whether one that is chosen takes the place of another. */
const replaces = (one, other) =>
  one.legs ? other.legs?.[0] === one.legs[0] : one.kind === other.kind;

// ---- the form: named worlds as small pictures

/** Where a leg is drawn from the side, legs with low numbers in front. */
const LEGS_X = [30, 19, 7, -7, -19, -30];
const GROUND_Y = 15;
const ROUGH = "M-36 15l5-4 5 5 6-7 6 6 5-4 5 5 6-6 6 5 5-5 6 6 5-4 6 4";

/** A world from the side: the robot on its ground, drawn by what happens there. */
export function WorldPicture({ disturbances }) {
  const of = (kind) => disturbances.find((one) => one.kind === kind);
  const states = legStates(disturbances);
  const weak = of("weak");
  const [noise, payload, patch, friction] = ["sensor-noise", "payload", "patch", "friction"].map(of);
  const turned = of("slope") ? `rotate(${-Math.min(20, 1.5 * of("slope").degrees)})` : undefined;
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
          <rect class="load" x=${payload.x_m > 0 ? 1 : -5} y=${body - 14} width="10" height="10" rx="1" />
        `}
      </g>
    </svg>
  `;
}

export const WorldPicker = () => html`
  <fieldset role="radiogroup" aria-invalid=${wrong.value.world ? "true" : undefined}
    aria-describedby=${wrong.value.world ? "mistake-world help-world" : "help-world"}>
    <legend><h2>World</h2></legend>
    <div class="gait-row">
      ${served().worlds.map(({ name, title, disturbances }, number) => html`
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

// ---- the form: what happens, and at which step

const setHappenings = (texts) => setField("disturb", texts);

/** What is to happen, each with its fields; a text that a link has and that is none stands as it is. */
export function Happenings() {
  const texts = form.value.disturb;
  const worlds = served().worlds.filter(({ disturbances }) => disturbances.length);
  const at_step = Math.floor(form.value.race_steps / 2);
  const add = ({ target }) => {
    const [what, name] = target.value.split(" ");
    const added = what === "world"
      ? (worlds.find((one) => one.name === name)?.disturbances ?? []).map((one) => textOf({ ...one, at_step }))
      : [textOf({ kind: name, ...firstFields(name), at_step })];
    target.value = "";
    setHappenings([...texts, ...added]);
  };
  return html`
    <fieldset class="happenings" id="field-disturb" tabindex="-1" aria-describedby="help-disturb">
      <legend><h2>What happens</h2></legend>
      <p class="sentence" id="help-disturb">
        In the race, after practice in the world above; in the practice, if there is no race.
      </p>
      ${texts.map((text, number) => html`
        <${Happening} key=${number} text=${text} number=${number}
          onText=${(changed) => setHappenings(texts.map((one, n) => (n === number ? changed : one)))}
          onRemove=${() => setHappenings(texts.filter((_, n) => n !== number))} />
      `)}
      <select class="add" aria-label="Add what happens" onChange=${add}>
        <option value="">Add what happens…</option>
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

/** Values for what must be given: those of a named world, else the first valid ones. */
function firstFields(kind) {
  const example = served().worlds.flatMap(({ disturbances }) => disturbances).find((one) => one.kind === kind);
  if (example) return example;
  const needed = Object.entries(kindNamed(kind)?.fields ?? {}).filter(([, field]) => field.is_required);
  return Object.fromEntries(needed.map(([name, field]) => [name, firstValue(field)]));
}

function firstValue(field) {
  if (field.is_list) return [1];
  if (field.choices.length) return field.choices[0];
  const { min, max, step } = sliderOf(field) ?? { min: 0, max: 1, step: 0.1 };
  return Math.max(min, Number((Math.round((min + (max - min) / 10) / step) * step).toPrecision(4)));
}

function Happening({ text, number, onText, onRemove }) {
  const { kind: name, fields } = splitText(text);
  const kind = kindNamed(name);
  const mistake = mistakeInText(text, form.value.simulator);
  const { robot, gait } = form.value;
  const given = (field) => fields.find(([one]) => one === field || one === shortName(field))?.[1] ?? "";
  const legs = given("legs").split(",").map(Number).filter(Boolean);
  const toggle = (leg) => {
    const chosen = legs.includes(leg) ? legs.filter((one) => one !== leg) : [...legs, leg].sort((a, b) => a - b);
    onText(withField(text, "legs", chosen.join(",")));
  };
  const words = LEG_WORDS[name] ?? name;
  return html`
    <div class="happening-row" role="group" aria-label=${kind?.title ?? text}>
      <div class="happening-head">
        <b>${kind?.title ?? text}</b>
        <button type="button" class="quiet square small" aria-label=${`Remove ${kind?.title ?? text}`}
          onClick=${onRemove}>✕</button>
      </div>
      ${kind && html`
        <div class="happening-fields">
          ${kind.fields.legs && html`
            <${LegPicker} azimuths=${azimuthsOf(robot, gait, served().gaits)} onLeg=${toggle}
              states=${new Map(legs.map((leg) => [leg, words]))} verbs=${["Add", "Leave out"]} />
          `}
          ${Object.entries(kind.fields).filter(([, field]) => !field.is_list).map(([field, setting]) => html`
            <${HappeningField} key=${field} id=${`happening-${number}-${field}`} field=${field} setting=${setting}
              value=${given(field)} onValue=${(value) => onText(withField(text, field, value))} />
          `)}
        </div>
      `}
      ${mistake && html`<span class="mistake" role="alert">${mistake}</span>`}
    </div>
  `;
}

/** Steps are counted from 1 here, and from 0 in texts; the last step is the one before `until`. */
const AT = "at_step";
const TITLES = { at_step: "From step", until_step: "To step" };
const WHOLE = /^\d+$/;

function HappeningField({ id, field, setting, value, onValue }) {
  const title = TITLES[field] ?? fullTitle(setting);
  if (setting.choices.length) {
    return html`
      <label class="happening-field" for=${id}>${title}
        <select id=${id} title=${setting.help} onChange=${({ target }) => onValue(target.value)}>
          ${setting.choices.map((one) => html`<option value=${one} selected=${one === value}>${one}</option>`)}
        </select>
      </label>
    `;
  }
  const isAt = field === AT;
  const shown = isAt && (value === "" || WHOLE.test(value)) ? String(Number(value) + 1) : value;
  const placeholder = field === "until_step" ? "the end" : String(setting.default ?? "");
  const take = ({ target }) => {
    const typed = target.value.trim().replaceAll(":", "");
    onValue(isAt && WHOLE.test(typed) ? String(Number(typed) - 1) : typed);
  };
  return html`
    <label class="happening-field" for=${id}>${title}
      <input type="text" id=${id} inputmode="decimal" autocomplete="off" title=${setting.help} value=${shown}
        placeholder=${placeholder} onChange=${take} />
    </label>
  `;
}
