// What happens to a robot and its ground: a drawn hexapod whose legs are clicked, and sliders; for the training that
// runs, and for a race that is held, which is raced on from there.
import { signal } from "@preact/signals";
import { useState } from "preact/hooks";
import { branchRace, disturb, pending } from "../actions.js";
import {
  conditionsAt, conditionsInWords, conditionsNow, happeningsOf, isSimulated, legStates, mainField, PUSH, toggled,
  withUnit,
} from "../disturbances.js";
import { listed } from "../format.js";
import { azimuthsOf } from "../robots.js";
import { heldRace, liveTraining, stepShown } from "../selectors.js";
import { sliderOf } from "../settings.js";
import { served } from "../store.js";
import { html, pointAt, Problem } from "./elements.js";

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
 */
export function LegPicker({ azimuths, states, onLeg, isDisabled = false, describedBy }) {
  const legs = azimuths.map((azimuth, n) => ({ azimuth, leg: n + 1, state: states.get(n + 1) }));
  return html`
    <div class="leg-picker" role="group" aria-label="Legs of the robot, seen from above"
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
        const words = state ? `Leg ${leg}, ${state}: repair it` : `Make leg ${leg} limp`;
        return html`
          <button key=${leg} type="button" style=${{ left: x, top: y }} aria-pressed=${state ? "true" : "false"}
            aria-disabled=${isDisabled ? "true" : undefined} title=${words}
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

/** It takes effect when the slider is let go: a run has only so many disturbances. */
function KindSlider({ one: { kind, name, field }, conditions, simulator, onHappen }) {
  const [draft, setDraft] = useState(/** @type {number | null} */ (null));
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
        onChange=${({ target }) => !isPush && send(Number(target.value))} />
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
    <section class="world-now" aria-label="What happens to the robot that practises">
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
