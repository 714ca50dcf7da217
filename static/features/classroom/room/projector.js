// The projector: code and QR, the card and its question, dots as they land, predictions beside results.
import { useEffect, useLayoutEffect, useRef, useState } from "preact/hooks";
import { getCurves } from "../../../js/api.js";
import { DotStrip } from "../../../js/components/dot-strip.js";
import { html, Icon } from "../../../js/components/elements.js";
import { Slot } from "../../../js/features.js";
import { Prose } from "../components/prose.js";
import { codeInGroups, count, metres, shortAddress } from "../../../js/format.js";
import { Away } from "./join.js";
import { Axes, lineOf, stepsOf } from "./chart.js";
import { Picture } from "./picture.js";
import { KINDS } from "./questions.js";
import { isShownToEnd } from "../../../js/narrative/moment.js";
import { agentOf } from "../../../js/settings.js";
import { scene } from "../../../js/store.js";
import { isRevealed, room, shownResults } from "./room.js";
import { axisOf } from "./scores.js";

/** @import { Ask, CardResults, Classroom, LessonCard, ResultEntry } from "../../../js/types.js" */

/** Size of the dots, against those of a strip in a panel. */
const DOTS = 4;

/** Whether the class still gathers: nobody has done anything on the first card. @param {Classroom} classroom */
const isLobby = ({ card, predicted, started, revealed, state }) =>
  card === 0 && predicted === 0 && started === 0 && revealed.length === 0 && state === "open";

export function Projector() {
  const classroom = /** @type {Classroom} */ (room.value);
  const isBefore = isLobby(classroom);
  return html`
    <main class=${`projector ${isBefore ? "lobby" : classroom.state}`}>
      <${Away} />
      ${classroom.state === "frozen" && html`<${Frozen} />`}
      <${Door} classroom=${classroom} />
      ${classroom.state === "ended"
        ? html`<article class="shown-card"><h1>${classroom.title}</h1><p>The lesson has ended.</p></article>`
        : html`<${Shown} classroom=${classroom} />`}
      ${!isBefore && classroom.state !== "ended" && html`<${Side} classroom=${classroom} key=${classroom.card} />`}
    </main>
  `;
}

/** The class is stopped: told so large that nobody looks at a phone to know. */
const Frozen = () => html`
  <p class="frozen-note" role="status"><${Icon} name="pause" />Stop. Look to the front.</p>
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
const Shown = ({ classroom }) => html`
  <article class="shown-card" aria-labelledby="shown-title" ref=${useFit()}>
    <p class="where">${classroom.title} · ${classroom.card + 1} of ${classroom.cards}</p>
    ${classroom.shown.title && html`<h1 id="shown-title">${classroom.shown.title}</h1>`}
    ${classroom.spotlight !== null && html`<${Lit} classroom=${classroom} />`}
    <${Prose} text=${isRevealed.value && classroom.html.reveal ? classroom.html.reveal : classroom.html.text} />
    ${classroom.shown.ask && html`<${Asked} classroom=${classroom} ask=${classroom.shown.ask} />`}
  </article>
`;

/** The question, and how many have locked an answer. @param {{ classroom: Classroom, ask: Ask }} props */
function Asked({ classroom, ask }) {
  const values = (shownResults.value?.entries ?? [])
    .map(({ prediction }) => prediction).filter((value) => value !== null);
  const { tally } = KINDS[ask.kind];
  const most = Math.max(1, values.length);
  return html`
    <section class="asked" aria-label="Question">
      <${Prose} text=${classroom.html.ask} />
      ${tally && html`
        <ul class=${`asked-choices ${isRevealed.value ? "counted" : ""}`}>
          ${tally(ask, isRevealed.value ? values : []).map(([choice, number]) => html`
            <li key=${choice} class=${isRevealed.value && shownResults.value?.answer === choice ? "right" : ""}
              style=${{ "--share": `${(100 * number) / most}%` }}>
              <span>${agentOf(choice).title}</span>${isRevealed.value && html`<b class="num">${number}</b>`}
            </li>
          `)}
        </ul>
      `}
    </section>
  `;
}

// ---- beside the card: counts, dots, the run in the spotlight

/** @param {{ classroom: Classroom }} props */
function Side({ classroom }) {
  const { shown, predicted, participants, started } = classroom;
  const results = shownResults.value;
  if (isRevealed.value && shown.ask && KINDS[shown.ask.kind].onChart) {
    return html`<${Beside}><${Lines} card=${shown} entries=${results?.entries ?? []} /><//>`;
  }
  const hasDots = (results?.distances_m ?? []).length > 0;
  const parts = [];
  if (shown.ask && !isRevealed.value) parts.push(html`<${Of} number=${predicted} all=${participants} word="locked" />`);
  if (hasDots) parts.push(html`<${Landing} card=${shown} />`);
  else if (shown.go) {
    parts.push(html`<${Of} number=${started} all=${participants} word="started" />`);
  }
  return parts.length > 0 && html`<${Beside}>${parts}<//>`;
}

/** @param {{ children: import("preact").ComponentChildren }} props */
const Beside = ({ children }) => html`<section class="beside" aria-label="The class">${children}</section>`;

/** @param {{ number: number, all: number, word: string }} props */
const Of = ({ number, all, word }) => html`
  <p class="locked-count" role="status"><b class="num">${number}</b> of ${all} ${word}</p>
`;

/** The run of a participant that the teacher shows to all. @param {{ classroom: Classroom }} props */
function Lit({ classroom }) {
  const entry = shownResults.value?.entries.find(({ run }) => run?.id === classroom.spotlight);
  // Not before its picture is there.
  const distance_m = isShownToEnd(scene.value, classroom.spotlight) ? entry?.run?.distance_m ?? null : null;
  return html`
    <div class="lit">
      <${Picture} isProjected=${true} key=${classroom.spotlight} />
      <p>
        <b>${entry?.name ?? "One of you"}</b>
        ${distance_m !== null && html`<span class="num">${metres(distance_m)}</span>`}
      </p>
    </div>
  `;
}

/**
 * The distances as they land, and after the reveal what was predicted on the same axis.
 * @param {{ card: LessonCard }} props
 */
function Landing({ card: { ask = null, go } }) {
  const { distances_m, interval, entries } = /** @type {CardResults} */ (shownResults.value);
  const values = entries.map(({ prediction }) => prediction).filter((prediction) => prediction !== null);
  const predicted = (isRevealed.value && ask && KINDS[ask.kind].metresOf?.(ask, values)) || null;
  const { low, high } = axisOf([...distances_m, ...(predicted ?? [])]);
  const typical = interval && { iqm: interval.iqm_m, low: interval.low_m, high: interval.high_m };
  const greatest = { low, high, size: DOTS };
  return html`
    <div class="landing">
      <p class="typical-figure">
        <b class="num">${metres(interval?.iqm_m)}</b>
        <span>
          typical of ${count(distances_m.length, go === "what-if" ? "class of thirty robots" : "robot")}
          ${interval && interval.low_m !== null && html`
            <br />95 %: ${interval.low_m.toFixed(2)} to ${metres(interval.high_m)}
          `}
        </span>
      </p>
      ${predicted && predicted.length > 0 && html`
        <h2>Predicted</h2>
        <${DotStrip} ...${greatest} label=${`${predicted.length} predictions`} points=${predicted} height=${24}
          color="var(--warn)" />
        <h2>Walked</h2>
      `}
      <${DotStrip} ...${greatest} label=${`${distances_m.length} distances, typically ${metres(interval?.iqm_m)}`}
        points=${distances_m} typical=${typical} axis=${metres} />
    </div>
  `;
}

/**
 * Predicted points and curves over the learning curves of the class.
 * @param {{ card: LessonCard, entries: ResultEntry[] }} props
 */
function Lines({ card, entries }) {
  const [curves, setCurves] = useState(/** @type {number[][][]} */ ([]));
  const ids = entries.flatMap(({ run }) =>
    (run?.state === "finished" && run.kind === "training" ? [run.id] : []));
  useEffect(() => {
    if (ids.length === 0) return;
    getCurves(ids).then(({ curves: loaded }) => setCurves(loaded.map(({ steps: xs, distances_m }) =>
      xs.map((x, n) => [x, distances_m[n] ?? 0]))), () => {});
  }, [ids.join()]);
  const steps = stepsOf(card);
  const predicted = entries.map(({ prediction }) => prediction).filter(Array.isArray);
  const { onChart } = KINDS[/** @type {Ask} */ (card.ask).kind];
  return html`
    <svg class="draw-chart lines" viewBox="0 0 340 200" role="img"
      aria-label=${`${predicted.length} predictions over ${curves.length} learning curves`}>
      <${Axes} steps=${steps} />
      ${curves.filter((curve) => curve.length > 1).map((curve) => html`
        <path class="actual" d=${`M${lineOf(curve, steps)}`} />
      `)}
      ${predicted.map((prediction) => onChart?.(prediction, steps))}
    </svg>
    <p class="key"><span class="predicted-key">predicted</span><span class="actual-key">learned</span></p>
  `;
}
