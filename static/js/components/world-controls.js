// Disturbances of a robot and its ground: a drawn hexapod whose legs are pressed, and sliders; for the training that
// runs, and for a race that is held, which is raced on from there.
import { useRef, useState } from "preact/hooks";
import { disturb } from "../live-changes.js";
import { branchRace, pending, setStage } from "../actions.js";
import {
  chosenWith, conditionsAt, conditionsInWords, conditionsNow, disturbancesOf, isSimulated, kindFor,
  kindNamed, legStates, nothingOf, pressed, withUnit,
} from "../disturbances.js";
import { listed } from "../format.js";
import { azimuthsOf } from "../robots.js";
import { liveTraining, playbackName, stepShown } from "../on-stage.js";
import { isMoving, openRace } from "../raced-on.js";
import { fieldBeside, kindOf, sliderOf, withinRanges } from "../settings.js";
import { served } from "../store.js";
import { isAtLeast } from "../workspace.js";
import { html, LegPicker } from "./elements.js";
import { Description, NumberField, SettingRow, Slider } from "./fields.js";
import { Problem } from "./foot.js";

/** @import {
 *   Changed, Disturbance, DisturbanceKind, FieldOption, RobotConfig, Run, RunConfig, SettingValue,
 * } from "../types.js" */
/** @import { ComponentChildren } from "preact" */

/** @typedef {{ kind: string, [field: string]: SettingValue }} Wish */
/** Takes a disturbance without its step. @typedef {(disturbance: Disturbance) => unknown} OnDisturb */
/** @typedef {DisturbanceKind & { size: string }} SizedKind */
/** @typedef {Pick<RunConfig, "robot" | "gait" | "simulator">} Walk */

// ---- what a press on a leg does

/** Kinds of disturbances of legs, as the server lists them. */
export const legKinds = () => served().disturbances.filter(({ fields }) => fields.legs || fields.leg);

const NO_OWN_FIELDS = ["leg", "at_step", "until_step"];

/** The fields of a kind beside the leg and the steps. @param {DisturbanceKind | undefined} kind */
const ownFieldsOf = (kind) =>
  Object.entries(kind?.fields ?? {}).filter(([name, field]) => !field.is_list && !NO_OWN_FIELDS.includes(name));

/**
 * A kind with the first values of its own fields, for a leg of a robot.
 * @param {string} name
 * @param {RobotConfig} [robot]
 * @param {number} [leg]
 */
export function firstWish(name, robot, leg) {
  const first = firstFields(name, robot, leg);
  return { kind: name, ...Object.fromEntries(ownFieldsOf(kindNamed(name)).map(([field]) => [field, first[field]])) };
}

/** @param {{ id: string, wish: Wish, onWish: (wish: Wish) => void, robot: RobotConfig }} props */
const LegWish = ({ id, wish, onWish, robot }) => html`
  <div class="leg-wish">
    <label for=${`${id}-leg-kind`}>A press on a leg</label>
    <select id=${`${id}-leg-kind`} aria-describedby=${`${id}-leg-help`}
      onChange=${(/** @type {Changed} */ { target }) => onWish(firstWish(target.value, robot))}>
      ${legKinds().map(({ name, title }) => html`
        <option value=${name} selected=${name === wish.kind}>${title}</option>
      `)}
    </select>
    <p class="sentence" id=${`${id}-leg-help`}>${kindNamed(wish.kind)?.description}</p>
  </div>
`;

/**
 * The joint and its angle, the share of the torque.
 * @param {{ id: string, wish: Wish, onWish: (wish: Wish) => void, robot: RobotConfig }} props
 */
function WishFields({ id, wish, onWish, robot }) {
  const kind = kindFor(wish.kind, robot);
  /** @param {string} name @param {SettingValue} value */
  const take = (name, value) => onWish(withinRanges(kind?.fields ?? {}, { ...wish, [name]: value }));
  return ownFieldsOf(kind).map(([name, setting]) => html`
    <${OwnField} key=${`${wish.kind} ${name}`} name=${`${id}-${name}`} setting=${fieldBeside(setting, wish)}
      value=${wish[name]} onValue=${(/** @type {SettingValue} */ value) => take(name, value)} />
  `);
}

/** @param {{ name: string, setting: FieldOption } & { [prop: string]: unknown }} props */
function OwnField({ name, setting, ...rest }) {
  const ends = kindOf(setting) === "number" ? sliderOf(setting) : null;
  return ends
    ? html`<${Slider} field=${name} setting=${setting} ...${ends} ...${rest} isOfForm=${false} />`
    : html`<${SettingRow} name=${name} setting=${setting} ...${rest} isOfForm=${false} />`;
}

/**
 * Values for what must be given: those of a named world, else the first valid ones.
 * @param {string} kind
 * @param {RobotConfig} [robot]
 * @param {number} [leg]
 */
export function firstFields(kind, robot, leg) {
  const fields = kindFor(kind, robot, leg)?.fields ?? {};
  const all = served().worlds.flatMap(({ disturbances }) => disturbances);
  const example = all.find((disturbance) => disturbance.kind === kind);
  const isFor = (/** @type {[string, FieldOption]} */ [name, { choices }]) =>
    !choices.length || choices.includes(/** @type {any} */ (example)?.[name]);
  if (example && Object.entries(fields).every(isFor)) return example;
  const needed = Object.entries(fields).filter(([, field]) => field.is_required);
  return Object.fromEntries(needed.map(([name, field]) => [name, firstValue(field)]));
}

/** @param {FieldOption} field */
function firstValue(field) {
  if (field.is_list) return [1];
  if (field.choices.length) return field.choices[0];
  const { min, max, step } = sliderOf(field) ?? { min: 0, max: 1, step: 0.1 };
  return Math.max(min, Number((Math.round((min + (max - min) / 10) / step) * step).toPrecision(4)));
}

// ---- sliders for the size of a disturbance: slope, friction, payload, a push; below it, its other numbers

/** @param {DisturbanceKind} kind @returns {kind is SizedKind} */
const hasSize = (kind) => Boolean(kind.size) && !kind.fields.legs;

/** Kinds of disturbances of more than a leg, as the server lists them. */
const kindsWithSize = () => served().disturbances.filter(hasSize);

/** A place is exact, and no seed is near another: such numbers are typed. @param {FieldOption} field */
const isTyped = (field) => field.is_required || field.is_whole;

const PAUSE_MS = 500;

/** @param {number} value @param {{ min: number, max: number }} other */
const shareIn = (value, { min, max }) => ({ "--share": `${(100 * (value - min)) / (max - min)}%` });

/** Action of its button. @type {Record<string, string>} */
const PRESS_WORDS = { push: "Push it", patch: "Lay it" };

/**
 * Whether it waits for its button: a push, and what has no size at which nothing happens.
 * @param {DisturbanceKind} kind
 */
const isPressed = ({ lasts, nothing }) => !lasts || nothing === null;

/**
 * The values of a kind as they hold, with what is being changed. A change takes effect when the slider, or its key,
 * has been let go: a run has only so many disturbances.
 * @param {SizedKind} kind
 * @param {[string, FieldOption][]} otherFields
 * @param {Disturbance[]} conditions
 * @param {OnDisturb} onDisturb
 */
function useValues(kind, otherFields, conditions, onDisturb) {
  const [draft, setDraft] = useState(/** @type {Record<string, number | null>} */ ({}));
  const timer = useRef(/** @type {ReturnType<typeof setTimeout> | undefined} */ (undefined));
  const present = conditions.find((other) => other.kind === kind.name);
  const begin = kind.nothing === null ? firstFields(kind.name) : present;
  const values = /** @type {Record<string, number | null | undefined>} */ ({ ...begin, ...draft });
  /** @param {Record<string, number | null | undefined>} chosen */
  const send = async (chosen) => {
    clearTimeout(timer.current);
    const set = [kind.size, ...otherFields.map(([other]) => other)].filter((field) => chosen[field] !== undefined);
    const wanted = { kind: kind.name, ...Object.fromEntries(set.map((field) => [field, chosen[field] ?? null])) };
    await onDisturb(/** @type {Disturbance} */ (wanted));
    if (!isPressed(kind)) setDraft({});
  };
  /** @param {string} name @param {number | null} value */
  const change = (name, value) => setDraft({ ...draft, [name]: value });
  /**
   * A direction alone is no disturbance.
   * @param {string} name
   * @param {number | null} value
   */
  const finish = (name, value) => {
    const chosen = { ...values, [name]: value };
    clearTimeout(timer.current);
    if (!isPressed(kind) && (chosen[kind.size] ?? null) !== null) {
      timer.current = setTimeout(() => send(chosen), PAUSE_MS);
    }
  };
  return { values, change, finish, send };
}

/** @param {{ kind: SizedKind, conditions: Disturbance[], config: Walk, onDisturb: OnDisturb }} props */
function KindSlider({ kind, conditions, config: { robot, simulator }, onDisturb }) {
  const field = kind.fields[kind.size];
  const otherFields = ownFieldsOf(kind).filter(([other]) => other !== kind.size);
  const { values, change, finish, send } = useValues(kind, otherFields, conditions, onDisturb);
  const ends = sliderOf(field) ?? { min: 0, max: 1, step: 0.01 };
  const isDisabled = !isSimulated(kind.name, simulator);
  const id = `disturb-${kind.name}`;
  const value = values[kind.size] ?? null;
  const nothing = nothingOf(kind.name, robot);
  const at = value ?? nothing ?? ends.min;
  const isBuilt = typeof kind.nothing === "string";
  const words = value === null && isBuilt ? "as built" : withUnit(at, field.unit);
  /** @param {string} name */
  const handlers = (name) => ({
    onInput: (/** @type {Changed} */ { target }) => change(name, Number(target.value)),
    onChange: (/** @type {Changed} */ { target }) => finish(name, Number(target.value)),
  });
  return html`
    <div class="slider disturb">
      <label for=${id} title=${kind.description}>${kind.title}</label>
      <input type="range" id=${id} min=${ends.min} max=${ends.max} step=${ends.step} value=${at} disabled=${isDisabled}
        style=${shareIn(at, ends)} aria-valuetext=${words} aria-describedby=${`${id}-help`} ...${handlers(kind.size)} />
      <output class="num" for=${id}>${words}</output>
      ${isPressed(kind) && html`
        <button type="button" class="secondary compact" disabled=${isDisabled || !value} onClick=${() => send(values)}>
          ${PRESS_WORDS[kind.name] ?? "Let it happen"}
        </button>
      `}
      ${isBuilt && html`
        <button type="button" class="secondary compact" aria-label=${`${kind.title} as built`}
          disabled=${isDisabled || nothing === null || value === null} onClick=${() => send({ [kind.size]: nothing })}>
          As built
        </button>
      `}
      <p class=${isAtLeast("study") ? "sentence" : "sr-only"} id=${`${id}-help`}>${kind.description}</p>
    </div>
    ${isAtLeast("study") && otherFields.map(([name, setting]) => {
      const more = {
        id: `${id}-${name}`, of: kind.title, setting, value: values[name] ?? setting.default, isDisabled,
      };
      /** @param {number | null} typed */
      const onValue = (typed) => {
        change(name, typed);
        finish(name, typed);
      };
      return isTyped(setting)
        ? html`<${OtherNumber} key=${name} ...${more} onValue=${onValue} />`
        : html`<${OtherSlider} key=${name} ...${more} handlers=${handlers(name)} />`;
    })}
  `;
}

/**
 * A number of a disturbance that is typed.
 * @param {{ id: string, of: string, setting: FieldOption, isDisabled: boolean } & { [prop: string]: unknown }} props
 */
const OtherNumber = ({ id, of, setting, isDisabled, ...rest }) => html`
  <div class="slider disturb other">
    <label for=${`field-${id}`}><span class="sr-only">${of}: </span>${setting.title}</label>
    <${NumberField} field=${id} setting=${setting} step=${setting.is_whole ? 1 : TYPED_STEP} isOfForm=${false}
      isDisabled=${isDisabled} ...${rest} />
    <span class="unit">${setting.unit}</span>
    <${Description} field=${id} words=${setting.help} />
  </div>
`;

/**
 * @param {object} props
 * @param {string} props.id
 * @param {string} props.of
 * @param {FieldOption} props.setting
 * @param {number | null} props.value
 * @param {boolean} props.isDisabled
 * @param {Record<string, (event: { target: HTMLInputElement }) => unknown>} props.handlers
 */
function OtherSlider({ id, of, setting, value: given, isDisabled, handlers }) {
  const value = given ?? 0;
  const ends = sliderOf(setting) ?? { min: 0, max: 1, step: 0.01 };
  const words = withUnit(value, setting.unit);
  const step = setting.unit === "°" ? DIRECTION_STEP : ends.step;
  return html`
    <div class="slider disturb other">
      <label for=${id}><span class="sr-only">${of}: </span>${setting.title}</label>
      <input type="range" id=${id} min=${ends.min} max=${ends.max} step=${step} value=${value} disabled=${isDisabled}
        style=${shareIn(value, ends)} aria-valuetext=${words} aria-describedby=${`${id}-help`} ...${handlers} />
      <output class="num" for=${id}>${words}</output>
      <p class="sentence" id=${`${id}-help`}>${setting.help}</p>
    </div>
  `;
}

const DIRECTION_STEP = 5;
/** Of the arrow keys in a place [m]. */
const TYPED_STEP = 0.01;

// ---- both together

/** Why legs of a simulator's robot cannot be broken; empty if they can. @param {string} simulator */
function reasonAgainst(simulator) {
  if (isSimulated("limp", simulator)) return "";
  const kinds = served().disturbances.filter(({ simulators }) => simulators.includes(simulator));
  const titles = listed(kinds.map(({ title }) => title.toLowerCase()));
  return `The ideal simulator has no ground and no servos: only ${titles} can happen there.`;
}

/**
 * `conditions`: what holds; `onDisturb` takes a disturbance without its step.
 * @param {object} props
 * @param {string} props.id
 * @param {Walk} props.config
 * @param {Disturbance[]} props.conditions
 * @param {OnDisturb} props.onDisturb
 * @param {(words: string[]) => ComponentChildren} props.sentenceOf
 * @param {ComponentChildren} props.children
 */
function WorldControls({ id, config, conditions, onDisturb, sentenceOf, children }) {
  const { robot, gait, simulator } = config;
  const [wish, setWish] = useState(() => firstWish(legKinds()[0].name, robot));
  const reason = reasonAgainst(simulator);
  /** @param {number} leg */
  const meant = (leg) => /** @type {Disturbance} */ (pressed(conditions, leg, wish));
  const now = conditionsInWords(conditions);
  return html`
    <div class="break">
      <${LegPicker} azimuths=${azimuthsOf(robot, gait, served())} states=${legStates(conditions)}
        isDisabled=${Boolean(reason)} describedBy=${`${id}-words`}
        onLeg=${(/** @type {number} */ leg) => onDisturb(meant(leg))}
        verbOf=${(/** @type {number} */ leg) => (meant(leg).kind === "repair" ? "Repair" : "Break")} />
      <div class="break-words">
        <p id=${`${id}-words`} role="status">${sentenceOf(now)}</p>
        ${reason
          ? html`<p class="sentence">${reason}</p>`
          : html`<${LegWish} id=${id} wish=${wish} onWish=${setWish} robot=${robot} />`}
        ${children}
      </div>
    </div>
    ${!reason && html`<${WishFields} id=${id} wish=${wish} onWish=${setWish} robot=${robot} />`}
    <${Sliders} kinds=${kindsWithSize().filter(isMain)} conditions=${conditions} config=${config}
      onDisturb=${onDisturb} />
    ${isAtLeast("study") && html`
      <details class="more">
        <summary>Ground, load and servos</summary>
        <${Sliders} kinds=${kindsWithSize().filter((kind) => !isMain(kind))} conditions=${conditions} config=${config}
          onDisturb=${onDisturb} />
      </details>
    `}
  `;
}

/** What those who try change; the other kinds are for those who study. */
const MAIN_KINDS = ["friction", "slope", "payload", "delay", "push"];
/** @param {SizedKind} kind */
const isMain = ({ name }) => MAIN_KINDS.includes(name);

/** @param {{ kinds: SizedKind[], conditions: Disturbance[], config: Walk, onDisturb: OnDisturb }} props */
const Sliders = ({ kinds, ...rest }) => html`
  <div class="sliders">${kinds.map((kind) => html`<${KindSlider} key=${kind.name} kind=${kind} ...${rest} />`)}</div>
`;

/** Panel of the disturbances of the training that runs. */
export function LiveWorld() {
  const run = liveTraining.value;
  if (!run) return null;
  /** @param {string[]} now */
  const words = (now) =>
    (now.length ? html`<b>Now:</b> ${now.join(", ")}` : "The robot is as it was built, on even ground.");
  return html`
    <section class="world-now" aria-label="Disturbances now">
      <${WorldControls} id="live" config=${run.config} conditions=${conditionsNow(run)} sentenceOf=${words}
        onDisturb=${(/** @type {Disturbance} */ disturbance) => disturb(run, disturbance)} />
      <${Problem} at="disturb" />
    </section>
  `;
}

// ---- a race that has been computed: it is disturbed, and raced on from the step that is shown

export const Branch = () => openRace.value && html`<${BranchOf} key=${openRace.value.id} race=${openRace.value} />`;

/** @param {{ race: Run }} props */
function BranchOf({ race }) {
  const [chosen, setChosen] = useState(/** @type {Disturbance[]} */ ([]));
  const { config } = race;
  // At the end nothing is left to walk: the middle is offered.
  const from = stepShown.value ?? Math.floor(config.steps / 2) + 1;
  const before = conditionsAt(disturbancesOf(race), from - 1, config.robot);
  const atOnce = [...before, ...chosen].map((disturbance) => ({ ...disturbance, at_step: 0 }));
  const conditions = conditionsAt(atOnce, 0, config.robot);
  /** @param {string[]} now */
  const words = (now) => {
    const pushes = chosen.some(({ kind }) => kindNamed(kind)?.lasts === false) ? ["a push"] : [];
    const all = [...now, ...pushes].join(", ") || "as it was";
    // A number that counts on would be read aloud at each step.
    return html`<b>From ${isMoving.value ? "the step shown" : `step ${from}`}:</b> ${all}`;
  };
  const choose = (/** @type {Disturbance} */ disturbance) => {
    if (isMoving.peek()) setStage({ playing: false });
    setChosen((all) => chosenWith(all, disturbance, before, config.robot));
  };
  const start = () => branchRace(race, from - 1, chosen);
  return html`
    <section class="branch" aria-label="Disturb this race">
      <${WorldControls} id="branch" config=${config} conditions=${conditions} sentenceOf=${words}
        onDisturb=${choose}>
        <button type="button" class="secondary" disabled=${!chosen.length || pending.value.branch} onClick=${start}>
          Race on from ${stepShown.value === null ? `step ${from}` : "here"}
        </button>
        ${" "}
        <button type="button" class="secondary" disabled=${!chosen.length} onClick=${() => setChosen([])}>
          Undo all
        </button>
      <//>
      <p class="sentence">
        Until then both races are the same. Hold the ${playbackName.value} elsewhere for another step.
      </p>
      <${Problem} at="branch" />
    </section>
  `;
}
