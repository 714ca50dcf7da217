// What can happen to the leg, the body or the ground that was picked in the picture, where it was picked.
import { useEffect, useLayoutEffect, useRef, useState } from "preact/hooks";
import { branchRace, pending } from "../actions.js";
import { chosenWith, conditionsAt, conditionsNow, disturbancesOf, kindNamed, pressed } from "../disturbances.js";
import { closeLegs, legPoints, legsOf, picked, pickLeg } from "../page.js";
import { disturb } from "../live-changes.js";
import { liveTraining, stepShown, work } from "../on-stage.js";
import { heldRace, openRace } from "../raced-on.js";
import { isOperator } from "../selectors.js";
import { isClosed } from "../settings.js";
import { isAway, scene } from "../store.js";
import { positionInWords, scale, toggleTime } from "../time.js";
import { openTab } from "../workspace.js";
import { html } from "./elements.js";
import { Restricted } from "./fields.js";
import { Problem } from "./foot.js";
import { firstWish, legKinds } from "./world-controls.js";

/** @import { Disturbance, Run } from "../types.js" */
/** @import { Pick } from "../page.js" */

export const Legs = () => html`<${LegMarks} /><${LegMenu} />`;

/** The numbers of the legs of the followed robot, to choose from. */
function LegMarks() {
  const group = useRef(/** @type {HTMLElement | null} */ (null));
  const lane = legsOf.value;
  useEffect(() => {
    // The first of them as soon as they are there.
    if (lane !== null && legPoints.value.length && !group.current?.contains(document.activeElement)) {
      /** @type {HTMLElement | null | undefined} */ (group.current?.querySelector("button"))?.focus();
    }
  }, [lane, legPoints.value.length]);
  if (lane === null) return null;
  /** @param {KeyboardEvent} event */
  const onKeyDown = (event) => {
    const step = { ArrowRight: 1, ArrowDown: 1, ArrowLeft: -1, ArrowUp: -1 }[event.key];
    if (!step) return;
    event.preventDefault();
    event.stopPropagation();
    const buttons = group.current?.querySelectorAll("button") ?? [];
    const all = /** @type {HTMLElement[]} */ ([...buttons]);
    const at = all.indexOf(/** @type {HTMLElement} */ (document.activeElement));
    all[(at + step + all.length) % all.length]?.focus();
  };
  const name = scene.value?.lanes[lane]?.name ?? "the robot";
  return html`
    <div class="leg-marks" role="group" aria-label=${`Legs of ${name}`} ref=${group} onKeyDown=${onKeyDown}>
      ${legPoints.value.map(({ leg, x, y }) => html`
        <button key=${leg} style=${{ left: `${x}px`, top: `${y}px` }} aria-label=${`Leg ${leg}`}
          aria-pressed=${picked.value?.leg === leg ? "true" : "false"} onClick=${() => pickLeg(leg)}>${leg}</button>
      `)}
    </div>
  `;
}

const EDGE_PX = 12;
const BESIDE_PX = 40;

function LegMenu() {
  const at = picked.value;
  return at && html`<${MenuAt} at=${at} key=${`${at.lane} ${at.what} ${at.leg}`} />`;
}

/** @param {{ at: Pick }} props */
function MenuAt({ at }) {
  const menu = useRef(/** @type {HTMLElement | null} */ (null));
  const [place, setPlace] = useState(/** @type {Record<string, string>} */ ({ visibility: "hidden" }));
  useLayoutEffect(() => {
    const element = /** @type {HTMLElement} */ (menu.current);
    const box = element.getBoundingClientRect();
    const picture = /** @type {HTMLElement} */ (element.parentElement).getBoundingClientRect();
    const within = (/** @type {number} */ start, /** @type {number} */ size, /** @type {number} */ room) =>
      `${Math.max(EDGE_PX, Math.min(start, room - size - EDGE_PX))}px`;
    // Beside the point, so that the robot can be seen: on its right where there is room, else on its left.
    const right = at.x + BESIDE_PX;
    const left = right + box.width > picture.width ? at.x - box.width - BESIDE_PX : right;
    setPlace({ left: within(left, box.width, picture.width), top: within(at.y - EDGE_PX, box.height, picture.height) });
  }, []);
  const isPlaced = !("visibility" in place);
  // A race that is shown to its end meanwhile offers what there was not when the menu was opened.
  const hasOffer = Boolean(liveTraining.value ?? heldRace.value);
  const wasFocused = useRef(false);
  useEffect(() => {
    // The body has it where the button that was pressed is gone.
    const isKept = document.activeElement === document.body || menu.current?.contains(document.activeElement);
    const isElsewhere = wasFocused.current && !isKept;
    if (!isPlaced || isElsewhere) return;
    /** @type {HTMLElement | null | undefined} */
    const first = menu.current?.querySelector(".kinds button, .primary") ?? menu.current?.querySelector("button");
    first?.focus({ preventScroll: true });
    wasFocused.current = true;
  }, [isPlaced, hasOffer]);
  const name = scene.value?.lanes[at.lane]?.name ?? "Robot";
  const title = { leg: `${name}, leg ${at.leg}`, body: `${name}, body`, ground: "Ground" }[at.what];
  return html`
    <section class="leg-menu" style=${place} aria-label=${title} ref=${menu}>
      <div class="leg-menu-head">
        <h2>${title}</h2>
        <button class="quiet square small" aria-label="Close" onClick=${closeLegs}>✕</button>
      </div>
      <${Offer} at=${at} />
    </section>
  `;
}

/** @param {{ at: Pick }} props */
function Offer({ at }) {
  const training = liveTraining.value;
  const race = heldRace.value;
  if (!isOperator.value) return html`<p class="dim">The operator disturbs the robots.</p>`;
  if (isAway.value) return html`<p class="dim">Nothing can be disturbed until the server is back.</p>`;
  if (isClosed("disturb")) return html`<${Restricted} what="what happens to the robots" />`;
  if (training) return html`<${OfTraining} run=${training} at=${at} />`;
  if (race) return html`<${OfRace} race=${race} at=${at} />`;
  if (openRace.value) return html`<${OfPlaying} />`;
  return html`<p class="dim">${wantingInWords()}</p>`;
}

/** Of a race that plays: which of its steps is meant is known once it is paused. */
const OfPlaying = () => html`
  <p>A race is disturbed at the step where it is paused.</p>
  <button class="primary" onClick=${toggleTime}>Pause</button>
`;

/** What is to be done before the robots can be disturbed. */
const wantingInWords = () => (work.value
  ? "Something is being computed: once it is done, a race that has finished can be disturbed at any of its steps."
  : "Start a practice, or show a race that has finished: then this can be disturbed.");

/** The kinds that can happen to what was picked. @type {Record<Pick["what"], () => string[]>} */
const KINDS = {
  leg: () => legKinds().map(({ name }) => name), body: () => ["payload", "push"], ground: () => ["friction", "slope"],
};
/** @param {Pick} at */
const kindsFor = ({ what }) => KINDS[what]().filter(kindNamed);

/** @param {{ at: Pick, value: string, onValue: (kind: string) => void }} props */
const Kinds = ({ at, value, onValue }) => html`
  <div class="kinds" role="group" aria-label="What happens">
    ${kindsFor(at).map((name) => html`
      <button key=${name} aria-pressed=${name === value ? "true" : "false"} onClick=${() => onValue(name)}>
        ${shortTitle(name)}
      </button>
    `)}
  </div>
`;

/** "Limp" of "Limp legs". @param {string} name */
const shortTitle = (name) => (kindNamed(name)?.title ?? name).replace(/ (legs?|joint)$/, "");

/**
 * What a press does, as a disturbance without its step.
 * @type {(at: Pick, kind: string, conditions: Disturbance[], robot: Run["config"]["robot"]) => Disturbance}
 */
const meant = (at, kind, conditions, robot) => /** @type {Disturbance} */ (at.what === "leg"
  ? pressed(conditions, at.leg ?? 1, firstWish(kind, robot, at.leg ?? 1)) : { ...firstWish(kind), kind });

/** @param {{ run: Run, at: Pick }} props */
function OfTraining({ run, at }) {
  const [kind, setKind] = useState(kindsFor(at)[0]);
  const next = (run.progress?.done ?? 0) + 1;
  const act = async () => {
    await disturb(run, meant(at, kind, conditionsNow(run), run.config.robot));
    closeLegs();
  };
  return html`
    <${Kinds} at=${at} value=${kind} onValue=${setKind} />
    <p class="acts"><b>Acts from step ${next}</b>, the computed one.</p>
    <button class="primary" onClick=${act}>Let it happen</button>
    <${Problem} at="disturb" />
    <${Further} />
  `;
}

/** @param {{ race: Run, at: Pick }} props */
function OfRace({ race, at }) {
  const [kind, setKind] = useState(kindsFor(at)[0]);
  const { config } = race;
  const from = stepShown.value ?? Math.floor(config.steps / 2) + 1;
  const before = conditionsAt(disturbancesOf(race), from - 1, config.robot);
  const scaleNow = stepShown.value === null ? null : scale.value;
  const moment = scaleNow ? positionInWords(scaleNow, scaleNow.picture) : `step ${from}`;
  const act = async () => {
    const chosen = chosenWith([], meant(at, kind, before, config.robot), before, config.robot);
    if (await branchRace(race, from - 1, chosen)) closeLegs();
  };
  return html`
    <${Kinds} at=${at} value=${kind} onValue=${setKind} />
    <p class="acts"><b>Acts from ${moment}</b>, as a new race. The old race is kept.</p>
    <button class="primary" disabled=${pending.value.branch} onClick=${act}>Race on from ${moment}</button>
    <${Problem} at="branch" />
    <${Further} />
  `;
}

const Further = () => html`
  <button class="link" onClick=${() => {
    closeLegs();
    openTab("world");
  }}>More: angles, sizes, several at once</button>
`;
