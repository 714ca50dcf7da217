// The projector: code and QR, the card and its question, dots as they land, predictions beside results.
import { useEffect, useLayoutEffect, useRef, useState } from "preact/hooks";
import { getCurves } from "../../../js/api.js";
import { DotStrip } from "../../../js/components/dot-strip.js";
import { html, Icon, Slot } from "../../../js/components/elements.js";
import { Prose } from "../components/prose.js";
import { codeInGroups, count, metres, shortAddress } from "../../../js/format.js";
import { Away } from "./join.js";
import { Axes, lineOf, stepsOf } from "./chart.js";
import { Picture } from "./picture.js";
import { KINDS } from "./questions.js";
import { isShownToEnd } from "../../../js/narrative/states.js";
import { agentOf } from "../../../js/settings.js";
import { scene } from "../../../js/store.js";
import { isRevealed, room, shownResults } from "./room.js";
import { axisOf } from "./scores.js";

/** @import { Ask, CardResults, Classroom, LessonCard, ResultEntry } from "../../../js/types.js" */

/** Size of the dots, against those of a strip in a panel. */
const DOTS = 4;

/** Whether the class still gathers: nobody has done anything on the first card. @param {Classroom} known */
const isLobby = ({ card, predicted, started, revealed, state }) =>
  card === 0 && predicted === 0 && started === 0 && revealed.length === 0 && state === "open";

export function Projector() {
  const known = /** @type {Classroom} */ (room.value);
  const isBefore = isLobby(known);
  return html`
    <main class=${`projector ${isBefore ? "lobby" : known.state}`}>
      <${Away} />
      ${known.state === "frozen" && html`<${Frozen} />`}
      <${Door} known=${known} />
      ${known.state === "ended"
        ? html`<article class="shown-card"><h1>${known.title}</h1><p>The lesson has ended.</p></article>`
        : html`<${Shown} known=${known} />`}
      ${!isBefore && known.state !== "ended" && html`<${Side} known=${known} key=${known.card} />`}
    </main>
  `;
}

/** The class is stopped: told so large that nobody looks at a phone to know. */
const Frozen = () => html`
  <p class="frozen-note" role="status"><${Icon} name="pause" />Stop. Look to the front.</p>
`;

/** Where to join: large while the class gathers, small from then on. @param {{ known: Classroom }} props */
const Door = ({ known }) => html`
  <section class="join-here" aria-label="How to join">
    ${known.qr_code && html`
      <img class="qr-code" src=${known.qr_code} alt=${`QR code of ${known.address}`} />
    `}
    <div>
      <p class="code">${codeInGroups(known.code)}</p>
      <p class="join-address">${known.qr_code ? shortAddress(known.address) : "On this computer alone"}</p>
      <p class="joined" role="status">
        <b class="num">${known.participants}</b> ${known.participants === 1 ? "is" : "are"} in
      </p>
      ${known.tournaments.length > 0 && html`<${Slot} name="projector of a room" room=${known} />`}
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

/** @param {{ known: Classroom }} props */
const Shown = ({ known }) => html`
  <article class="shown-card" aria-labelledby="shown-title" ref=${useFit()}>
    <p class="where">${known.title} · ${known.card + 1} of ${known.cards}</p>
    ${known.shown.title && html`<h1 id="shown-title">${known.shown.title}</h1>`}
    ${known.spotlight !== null && html`<${Lit} known=${known} />`}
    <${Prose} text=${isRevealed.value && known.html.reveal ? known.html.reveal : known.html.text} />
    ${known.shown.ask && html`<${Asked} known=${known} ask=${known.shown.ask} />`}
  </article>
`;

/** The question, and how many have locked an answer. @param {{ known: Classroom, ask: Ask }} props */
function Asked({ known, ask }) {
  const values = (shownResults.value?.entries ?? []).map(({ prediction }) => prediction).filter((one) => one !== null);
  const { tally } = KINDS[ask.kind];
  const most = Math.max(1, values.length);
  return html`
    <section class="asked" aria-label="Question">
      <${Prose} text=${known.html.ask} />
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

/** @param {{ known: Classroom }} props */
function Side({ known }) {
  const { shown, predicted, participants, started } = known;
  const found = shownResults.value;
  if (isRevealed.value && shown.ask && KINDS[shown.ask.kind].onChart) {
    return html`<${Beside}><${Lines} card=${shown} entries=${found?.entries ?? []} /><//>`;
  }
  const hasDots = (found?.distances_m ?? []).length > 0;
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

/** The run of a participant that the teacher shows to all. @param {{ known: Classroom }} props */
function Lit({ known }) {
  const entry = shownResults.value?.entries.find(({ run }) => run?.id === known.spotlight);
  // Not before its picture is there.
  const distance_m = isShownToEnd(scene.value, known.spotlight) ? entry?.run?.distance_m ?? null : null;
  return html`
    <div class="lit">
      <${Picture} source="stage" key=${known.spotlight} />
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
  const values = entries.map(({ prediction }) => prediction).filter((one) => one !== null);
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
    getCurves(ids).then(({ curves: found }) => setCurves(found.map(({ steps: xs, distances_m }) =>
      xs.map((x, n) => [x, distances_m[n] ?? 0]))), () => {});
  }, [ids.join()]);
  const steps = stepsOf(card);
  const predicted = entries.map(({ prediction }) => prediction).filter(Array.isArray);
  const { onChart } = KINDS[/** @type {Ask} */ (card.ask).kind];
  return html`
    <svg class="draw-chart lines" viewBox="0 0 340 200" role="img"
      aria-label=${`${predicted.length} predictions over ${curves.length} learning curves`}>
      <${Axes} steps=${steps} />
      ${curves.filter((one) => one.length > 1).map((one) => html`
        <path class="actual" d=${`M${lineOf(one, steps)}`} />
      `)}
      ${predicted.map((one) => onChart?.(one, steps))}
    </svg>
    <p class="key"><span class="predicted-key">predicted</span><span class="actual-key">learned</span></p>
  `;
}
