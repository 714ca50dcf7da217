// The page of a participant: the card, the own prediction, the own robot, and after the reveal its place in the class.
import { useEffect, useState } from "preact/hooks";
import { getCurve } from "../api.js";
import { DotStrip } from "../components/dot-strip.js";
import { html, ProgressBar } from "../components/elements.js";
import { count, metres, whole } from "../format.js";
import { Away, Door, Failure, Prose } from "./doors.js";
import { chosenSettings, givenInWords, May } from "./may.js";
import { CLOSER, closerLink, Picture, ReplayBar, replayed } from "./picture.js";
import { Answer, draftOf } from "./questions.js";
import { axisOf, scoreInWords } from "./scores.js";
import {
  answers, busy, go, goesOn, isRevealed, lastRunId, leave, lock, ownAnswer, ownEntry, ownRun, room, shownResults,
} from "./room.js";

/** @import { Ask, Classroom, LessonCard, Run, WhatIfAnswer } from "../types.js" */

export function Phone() {
  const known = /** @type {Classroom} */ (room.value);
  if (known.role !== "participant") return html`<${Door} />`;
  const me = /** @type {NonNullable<Classroom["me"]>} */ (known.me);
  return html`
    <header class="room-header">
      <p><b>${me.name}</b><span class="dim">seed ${me.seed}</span></p>
      <p class="dim">${known.title}</p>
    </header>
    <${Away} />
    ${known.state === "frozen" && html`
      <p class="strip-note" role="status">The teacher has stopped the class for a moment. Look to the front.</p>
    `}
    <main class="phone">
      ${known.state === "ended" ? html`<${Ended} />` : html`<${Present} key=${known.card} known=${known} />`}
    </main>
  `;
}

const Ended = () => html`
  <section class="phone-part">
    <h1>The lesson has ended</h1>
    <p>What your robots have learned stays with your teacher. Thank you.</p>
    ${lastRunId.value && html`<a class="secondary as-button" href=${closerLink("why")}>Look at your last robot</a>`}
    <button class="quiet" onClick=${leave}>Leave the room</button>
  </section>
`;

/** The card that is shown. @param {{ known: Classroom }} props */
function Present({ known }) {
  const { shown, html: texts, card, cards, state } = known;
  const isOpen = state === "open";
  return html`
    ${replayed.value && html`<${OwnRobot} card=${shown} />`}
    <article class="phone-part" aria-labelledby="card-title">
      <p class="dim">Card ${card + 1} of ${cards}</p>
      ${shown.title && html`<h1 id="card-title">${shown.title}</h1>`}
      <${Prose} text=${texts.text} />
    </article>
    ${!replayed.value && html`<${OwnRun} />`}
    ${isRevealed.value && html`<${Revealed} known=${known} />`}
    ${shown.ask && html`<${Question} card=${shown} number=${card} text=${texts.ask} />`}
    ${shown.go && Object.keys(shown.may ?? {}).length > 0 && html`
      <${May} card=${shown} number=${card} isDisabled=${!isOpen || goesOn(ownRun.value)} />
    `}
    ${answers.value[`${card}`] && html`<${WhatIfDots} answer=${answers.value[`${card}`]} />`}
    <${Closer} card=${shown} />
    <${Deeds} card=${shown} number=${card} isOpen=${isOpen} />
  `;
}

// ---- the question

/** @param {{ card: LessonCard, number: number, text: string }} props */
function Question({ card, number, text }) {
  const locked = ownAnswer.value;
  return html`
    <section class="phone-part question" aria-label="Question">
      <${Prose} text=${text} />
      ${locked === undefined && isRevealed.value
        ? html`<p class="dim">You gave no prediction before the reveal.</p>`
        : html`<${Answer} card=${card} number=${number} locked=${locked} actual=${useOwnCurve(card)} />`}
      ${locked !== undefined && html`<p class="lock-note" role="status">Locked. It cannot be changed any more.</p>`}
    </section>
  `;
}

/** The learning curve of the own run, once it has ended, where the question is a chart. @param {LessonCard} card */
function useOwnCurve({ ask }) {
  const [curve, setCurve] = useState(/** @type {number[][]} */ ([]));
  const isChart = ask?.kind === "curve" || ask?.kind === "point";
  const id = isChart && ownRun.value?.state === "finished" ? ownRun.value.id : null;
  useEffect(() => {
    if (id === null) return;
    getCurve(id).then(({ evaluations }) =>
      setCurve(evaluations.map(({ step, distance_m }) => [step, /** @type {number} */ (distance_m)])), () => {});
  }, [id]);
  return curve;
}

// ---- what can be done: lock, and go

const GO = { "training": "Go: let it practise", "race": "Go: race", "what-if": "Go: try it on thirty robots" };

/** @param {{ card: LessonCard, number: number, isOpen: boolean }} props */
function Deeds({ card, number, isOpen }) {
  const needsAnswer = Boolean(card.ask) && ownAnswer.value === undefined && !isRevealed.value;
  const answer = draftOf(card, number);
  const settings = chosenSettings(card, number);
  const isBusy = busy.value.lock || busy.value.go;
  const canLock = isOpen && answer !== undefined && !isBusy;
  const given = JSON.stringify(ownEntry.value?.run?.given ?? null);
  const isSame = ownRun.value !== null && ownRun.value.state !== "failed" &&
    (Object.keys(card.may ?? {}).length === 0 || given === JSON.stringify(settings));
  const canGo = isOpen && settings !== null && !isBusy && !goesOn(ownRun.value) && !isSame;
  const lockAndGo = async () => (await lock(answer)) && go(settings ?? {});
  return html`
    <footer class="deeds">
      <${Failure} at="lock" /><${Failure} at="go" />
      ${needsAnswer && !card.go && html`
        <button class="primary" aria-disabled=${canLock ? undefined : "true"}
          onClick=${() => canLock && lock(answer)}>Lock my prediction</button>
      `}
      ${needsAnswer && card.go && html`
        <button class="primary" aria-disabled=${canLock && canGo ? undefined : "true"}
          onClick=${() => canLock && canGo && lockAndGo()}>Lock my prediction, and go</button>
        <button class="secondary" aria-disabled=${canLock ? undefined : "true"}
          onClick=${() => canLock && lock(answer)}>Lock my prediction</button>
      `}
      ${!needsAnswer && card.go && !(isSame && !Object.keys(card.may ?? {}).length) && !goesOn(ownRun.value) && html`
        <button class="primary" aria-disabled=${canGo ? undefined : "true"} onClick=${() => canGo && go(settings ?? {})}>
          ${ownRun.value ? "Go again with these settings" : GO[card.go]}
        </button>
      `}
      <${Next} card=${card} needsAnswer=${needsAnswer} />
    </footer>
  `;
}

/** What one waits for. @param {{ card: LessonCard, needsAnswer: boolean }} props */
function Next({ card, needsAnswer }) {
  if (needsAnswer || goesOn(ownRun.value)) return null;
  if (card.go && !ownRun.value && !answers.value[`${room.value?.card}`]) return null;
  const isLast = room.value?.card === (room.value?.cards ?? 0) - 1;
  const words = card.ask && !isRevealed.value
    ? "Wait for the reveal." : isLast ? "This is the last card." : "The next card comes from your teacher.";
  return html`<p class="dim waiting" role="status">${words}</p>`;
}

// ---- the own robot

/** @param {{ card: LessonCard }} props */
const OwnRobot = ({ card }) => html`
  <section class="own-robot" aria-label="Your robot">
    <${Picture} source="replay" />
    <${ReplayBar} />
    <${OwnRun} card=${card} />
  </section>
`;

/** How far the own run is, or what came of it. */
function OwnRun() {
  const run = ownRun.value;
  if (run === null) return null;
  if (run.state === "queued") {
    const place = run.queue_position ? ` Place ${run.queue_position} in the queue.` : "";
    return html`<p class="run-words" role="status"><span class="spinner" aria-hidden="true"></span>
      Your robot waits for its turn.${place}</p>`;
  }
  if (goesOn(run)) return html`<${Running} run=${run} />`;
  if (run.state !== "finished") {
    return html`<p class="run-words bad" role="alert">Your robot did not get to its end. Press Go again.</p>`;
  }
  const distance_m = ownEntry.value?.run?.distance_m ?? run.result?.distance_m ?? null;
  const given = ownEntry.value?.run?.given ?? {};
  return html`
    <div class="own-distance" role="status">
      <b class="num">${metres(distance_m)}</b>
      <span class="dim">${run.kind === "race" ? "your learner at time-out" : "in 50 steps, after its practice"}
        ${Object.keys(given).length > 0 && html`<br />with ${givenInWords(given, room.value?.shown ?? { text: "" })}`}</span>
    </div>
  `;
}

/** @param {{ run: Run }} props */
function Running({ run }) {
  const { done, total } = run.progress;
  const what = run.kind === "race" ? "It races" : "It practises";
  return html`
    <div class="run-words" role="status">
      <p>${what}: step ${whole(done)} of ${whole(total)}</p>
      <${ProgressBar} label="Progress of your robot" share=${total ? done / total : 0} />
    </div>
  `;
}

/** Thirty ideal robots with these settings, beside the defaults. @param {{ answer: WhatIfAnswer }} props */
function WhatIfDots({ answer }) {
  const far = 1.06 * Math.max(answer.greedy_m, ...answer.chosen.distances_m, ...answer.default.distances_m);
  return html`
    <section class="phone-part" aria-label="Thirty robots">
      ${[["With these settings", answer.chosen], ["With the defaults", answer.default]].map(([title, half]) => {
        const { distances_m, iqm_m } = /** @type {WhatIfAnswer["chosen"]} */ (half);
        return html`
          <p><b>${title}</b>: typically ${metres(iqm_m)}</p>
          <${DotStrip} label=${`${title}: typically ${metres(iqm_m)}`} points=${distances_m} high=${far}
            low=${Math.min(0, ...distances_m)} typical=${{ iqm: iqm_m }} axis=${metres} />
        `;
      })}
    </section>
  `;
}

/** Ways to the tabs of the dashboard that the card shows, with the own run. @param {{ card: LessonCard }} props */
function Closer({ card }) {
  const tabs = [...new Set([...(card.show ?? []), card.state?.tab ?? ""])].filter((tab) => tab in CLOSER);
  if (!lastRunId.value || tabs.length === 0) return null;
  return html`
    <nav class="closer" aria-label="Look closer">
      ${tabs.map((tab) => html`<a key=${tab} class="secondary as-button" href=${closerLink(tab)} target="_blank">
        ${CLOSER[tab]}</a>`)}
    </nav>
  `;
}

// ---- after the reveal

/** @param {{ known: Classroom }} props */
function Revealed({ known }) {
  const found = shownResults.value;
  const own = ownEntry.value;
  return html`
    <section class="phone-part revealed" aria-label="The class">
      ${found && found.distances_m.length > 0 && html`<${ClassDots} />`}
      ${own?.score && html`<p class="score" role="status">${scoreInWords(own, /** @type {Ask} */ (known.shown.ask))}</p>`}
      ${known.html.reveal && html`<${Prose} text=${known.html.reveal} />`}
    </section>
  `;
}

function ClassDots() {
  const { distances_m, interval } = /** @type {NonNullable<typeof shownResults.value>} */ (shownResults.value);
  const own = ownEntry.value?.run ?? null;
  const { low, high } = axisOf(distances_m);
  const typical = interval && { iqm: interval.iqm_m, low: interval.low_m, high: interval.high_m };
  const rank = own?.rank ? `Rank ${own.rank} of ${distances_m.length} seeds` : count(distances_m.length, "seed");
  return html`
    <h2>${rank}</h2>
    <${DotStrip} label=${`${rank}, from ${metres(distances_m[0])} to ${metres(distances_m.at(-1))}`} size=${1.6}
      points=${distances_m} low=${low} high=${high} typical=${typical} axis=${metres} own=${own?.distance_m ?? null} />
    <p class="dim">
      ${own && html`<span class="own-key">your robot</span>, `}typically ${metres(interval?.iqm_m)}
      ${interval && interval.low_m !== null && html` (95 %: ${metres(interval.low_m)} to ${metres(interval.high_m)})`}
    </p>
  `;
}
