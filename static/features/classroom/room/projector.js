// The projector: code and QR, the card and its question, the robots, and the act that reveals what came of it.
import { computed, effect, signal } from "@preact/signals";
import { useEffect, useLayoutEffect, useRef } from "preact/hooks";
import { Away } from "../../../js/components/away.js";
import { DotStrip } from "../../../js/components/dot-strip.js";
import { html, Icon } from "../../../js/components/elements.js";
import { Slot } from "../../../js/features.js";
import { Prose } from "../components/prose.js";
import { codeInGroups, metres, shortAddress } from "../../../js/format.js";
import { actOf } from "./acts/index.js";
import { walkedRow } from "./acts/distances.js";
import { useBox } from "./acts/plot.js";
import { clockInWords } from "./clocks.js";
import { Picture } from "./picture.js";
import { earlyEndOf, isShownToEnd } from "../../../js/narrative/moment.js";
import { agentOf } from "../../../js/settings.js";
import { runs, scene } from "../../../js/store.js";
import { gain, isRevealed, refreshResults, room, shownResults } from "./room.js";
import { axisOf } from "./scores.js";

/** @import { Signal } from "@preact/signals" */
/** @import { Ask, Classroom } from "../../../js/types.js" */
/** @import { Act, Facts } from "./acts/index.js" */

/** Size of the type at which dots are as large as in a panel [px]. */
const PANEL_PX = 9;

/** For so long the end of a run is looked at. */
const FINISH_MS = 2500;

/** Ids of the runs that this page has shown to their end. @type {Signal<Set<string>>} */
const shownToEnd = signal(new Set());
/** Id of the run in the spotlight while its picture is at its end; null else. */
const atEnd = computed(() => {
  const id = room.value?.spotlight ?? null;
  return id !== null && isShownToEnd(scene.value, id) ? id : null;
});
effect(() => {
  const id = atEnd.value;
  if (id === null) return undefined;
  const timer = setTimeout(() => (shownToEnd.value = new Set(shownToEnd.peek()).add(id)), FINISH_MS);
  return () => clearTimeout(timer);
});

/** Whether a run on the stage is still on its way: neither shown to its end, nor lost. @param {string | null} id */
const isOnItsWay = (id) =>
  id !== null && !shownToEnd.value.has(id) && earlyEndOf(runs.value.get(id) ?? null) === null;

const AGAIN_MS = 2000;

/** Ask again for runs that phones still show: that one of them was closed is told by no event. */
function askAgain() {
  if (!shownResults.peek()?.on_their_way) return undefined;
  const timer = setTimeout(refreshResults, AGAIN_MS);
  return () => clearTimeout(timer);
}

/** Whether the class still gathers: nobody has done anything on the first card. @param {Classroom} classroom */
const isLobby = ({ card, predicted, started, revealed, state }) =>
  card === 0 && predicted === 0 && started === 0 && revealed.length === 0 && state === "open";

export function Projector() {
  const classroom = /** @type {Classroom} */ (room.value);
  const { state } = classroom;
  const facts = {
    classroom, results: shownResults.value, isRevealed: isRevealed.value, isOnItsWay: isOnItsWay(classroom.spotlight),
    colors: scene.value?.lanes.map(({ color }) => color) ?? [], gain: gain.value,
    clock: clockInWords(scene.value?.clock),
  };
  useEffect(askAgain, [shownResults.value]);
  const act = state === "ended" ? null : actOf(facts);
  return html`
    <main class=${`projector ${state}`}>
      <${Away} />
      ${state === "frozen" && html`<${Frozen} classroom=${classroom} />`}
      ${state === "ended" ? html`<${Ended} classroom=${classroom} />`
        : html`<${Layout} facts=${facts} act=${act} />`}
    </main>
  `;
}

/** @param {{ classroom: Classroom }} props */
const Ended = ({ classroom }) => html`
  <article class="shown-card lesson-end"><h1>${classroom.title}</h1><p>The lesson has ended.</p></article>
`;

/** The class is stopped: told so large that nobody looks at a phone to know. @param {{ classroom: Classroom }} props */
const Frozen = ({ classroom }) => html`
  <div class="frozen-note">
    <p role="status"><${Icon} name="pause" />Stop. Look to the front.</p>
    <p class="code">${codeInGroups(classroom.code)}</p>
  </div>
`;

/**
 * The parts that a layout places; the robots stay where they are in the page, as their picture would load anew.
 * @param {{ facts: Facts, act: Act | null }} props
 */
function Layout({ facts, act }) {
  const { classroom } = facts;
  const { shown } = classroom;
  const named = act && `act act-${act.name} ${shown.go ? "" : "no-run"}`;
  const layout = named ?? (isLobby(classroom) ? "lobby" : "asks");
  return html`
    <div class=${`layout ${layout}`}>
      ${act ? html`<${Head} classroom=${classroom} />` : html`<${Card} classroom=${classroom} key=${classroom.card} />`}
      <${Door} classroom=${classroom} />
      <section class="robots" aria-label="The robots"><${Picture} isProjected=${true} /></section>
      ${act
        ? html`<${Place} act=${act} facts=${facts} key=${act.name} />`
        : html`<${Counts} classroom=${classroom} key=${`counts ${classroom.card}`} />`}
      ${act && html`<${Revealed} classroom=${classroom} />`}
    </div>
  `;
}

/** @param {{ act: Act, facts: Facts }} props */
const Place = ({ act, facts }) => html`
  <section class="act-place" aria-label="What came of it"><${act.Show} ...${facts} /></section>
`;

/** Where to join: large while the class gathers, small from then on. @param {{ classroom: Classroom }} props */
const Door = ({ classroom }) => html`
  <section class="join-here" aria-label="How to join">
    ${classroom.qr_code && html`
      <img class="qr-code" src=${classroom.qr_code} alt=${`QR code of ${classroom.address}`} />
    `}
    <div>
      <p class="code">${codeInGroups(classroom.code)}</p>
      <p class="join-address">${classroom.qr_code ? shortAddress(classroom.address) : "On this computer alone"}</p>
      <p class="joined" role="status">
        <b class="num">${classroom.participants}</b> ${classroom.participants === 1 ? "is" : "are"} in
      </p>
      ${classroom.tournaments.length > 0 && html`<${Slot} name="projector of a room" room=${classroom} />`}
    </div>
  </section>
`;

/** Sizes of a card's type, largest first, as style/room-projector.css has them. */
const FITS = ["0", "1", "2", "3"];

/** An element with the largest type in which nothing of it is cut off. */
function useFit() {
  const element = useRef(/** @type {HTMLElement | null} */ (null));
  const fit = () => {
    const { current } = element;
    if (current === null) return;
    FITS.find((size) => {
      current.dataset.fit = size;
      return current.scrollHeight <= current.clientHeight;
    });
  };
  useLayoutEffect(fit);
  useEffect(() => {
    addEventListener("resize", fit);
    return () => removeEventListener("resize", fit);
  }, []);
  return element;
}

/** @param {{ classroom: Classroom }} props */
const Where = ({ classroom }) => html`
  <p class="where">${classroom.title} · ${classroom.card + 1} of ${classroom.cards}</p>
`;

/** The card before its reveal. @param {{ classroom: Classroom }} props */
const Card = ({ classroom }) => html`
  <article class="shown-card" aria-labelledby="shown-title" ref=${useFit()}>
    <${Where} classroom=${classroom} />
    ${classroom.shown.title && html`<h1 id="shown-title">${classroom.shown.title}</h1>`}
    <${Prose} text=${isRevealed.value && classroom.html.reveal ? classroom.html.reveal : classroom.html.text} />
    ${classroom.shown.ask && html`<${Asked} classroom=${classroom} ask=${classroom.shown.ask} />`}
  </article>
`;

/** @param {{ classroom: Classroom, ask: Ask }} props */
const Asked = ({ classroom, ask }) => html`
  <section class="asked" aria-label="Question">
    <${Prose} text=${classroom.html.ask} />
    ${(ask.choices ?? []).length > 0 && html`
      <ul class="asked-choices">
        ${(ask.choices ?? []).map((choice) => html`<li key=${choice}>${agentOf(choice).title}</li>`)}
      </ul>
    `}
  </section>
`;

/** Above an act: the card's title and its question. @param {{ classroom: Classroom }} props */
const Head = ({ classroom }) => html`
  <header class="act-head">
    <${Where} classroom=${classroom} />
    ${classroom.shown.title && html`<h1>${classroom.shown.title}</h1>`}
    ${classroom.html.ask && html`<${Prose} text=${classroom.html.ask} />`}
  </header>
`;

/** Beside an act: what the lesson says to it. @param {{ classroom: Classroom }} props */
const Revealed = ({ classroom }) => html`
  <aside class="reveal-text" aria-label="What it means" ref=${useFit()}>
    ${isRevealed.value && classroom.html.reveal && html`<${Prose} text=${classroom.html.reveal} />`}
  </aside>
`;

/** Below the robots: who has locked and started, and the dots that have landed. */
/** @param {{ classroom: Classroom }} props */
function Counts({ classroom }) {
  const { shown, predicted, participants, started } = classroom;
  const hasDots = (shownResults.value?.distances_m ?? []).length > 0;
  const parts = [];
  if (shown.ask && !isRevealed.value) parts.push(html`<${Of} number=${predicted} all=${participants} word="locked" />`);
  if (shown.go && !hasDots) parts.push(html`<${Of} number=${started} all=${participants} word="started" />`);
  if (hasDots) parts.push(html`<${Landing} classroom=${classroom} />`);
  return parts.length > 0 && html`<section class="beside" aria-label="The class">${parts}</section>`;
}

/** @param {{ number: number, all: number, word: string }} props */
const Of = ({ number, all, word }) => html`
  <p class="locked-count" role="status"><b class="num">${number}</b> of ${all} ${word}</p>
`;

/** The distances as they land. @param {{ classroom: Classroom }} props */
function Landing({ classroom }) {
  const { title, values, typical } = /** @type {NonNullable<ReturnType<typeof walkedRow>>} */ (
    walkedRow(classroom, shownResults.value));
  const [host, { em }] = useBox();
  return html`
    <div class="landing" ref=${host}>
      <p>${title}</p>
      <${DotStrip} ...${axisOf(values)} size=${Math.max(1, em / PANEL_PX)} label=${title} points=${values}
        typical=${typical} axis=${metres} />
    </div>
  `;
}
