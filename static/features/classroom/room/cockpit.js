// The teacher's cockpit: the code, the card and the next one, what all may do, who is in and how far.
import { signal } from "@preact/signals";
import { Away } from "../../../js/components/away.js";
import { DotStrip } from "../../../js/components/dot-strip.js";
import { Dialog, html, Icon } from "../../../js/components/elements.js";
import { Loaded, Slot } from "../../../js/features.js";
import { Prose } from "../components/prose.js";
import { resultsFile } from "../api.js";
import { PupilsWindow, Sharing } from "../components/sharing.js";
import { codeInGroups, count, inLanguage, metres, shortAddress } from "../../../js/format.js";
import { copy, isPhone, nextTheme, theme, toastMessage } from "../../../js/page.js";
import { runs, stage } from "../../../js/store.js";
import { Failure } from "./join.js";
import { gainInWords } from "./acts/gain-words.js";
import { ClockChoice } from "./clocks.js";
import { People } from "./people.js";
import {
  busy, end, freeze, gain, isRevealed, remove, reveal, room, setStageClock, showCard, shownResults, spotlight,
} from "./room.js";
import { axisOf } from "./scores.js";

/** @import { Classroom, LessonCard } from "../../../js/types.js" */

const codeIsOpen = signal(false);
/** Whether the end of the room, and its removal, were asked for once. */
const [willEnd, willDelete] = [signal(false), signal(false)];

export function Cockpit() {
  const classroom = /** @type {Classroom} */ (room.value);
  return html`
    <${Header} classroom=${classroom} />
    <${Away} />
    <main class="cockpit">
      <div class="cockpit-main">
        <${Act} classroom=${classroom} />
        <${Counts} classroom=${classroom} />
        <${Actions} classroom=${classroom} />
        <${Dots} />
        ${gain.value && html`
          <section class="panel" aria-label="Gain"><h2>Gain of the class</h2><p>${gainInWords(gain.value)}</p></section>
        `}
      </div>
      <${People} classroom=${classroom} />
      <${Slot} name="cockpit of a room" room=${classroom} />
      <${Ways} classroom=${classroom} />
    </main>
    <${Code} classroom=${classroom} />
    <div class="toast" role="status">${toastMessage.value && html`<p>${toastMessage.value.words}</p>`}</div>
  `;
}

const loadTeaching = () => import("./teach-cockpit.js").then(({ TeachInCockpit }) => TeachInCockpit);

const STATES = { open: "You teach", frozen: "All stand still", ended: "The room has ended" };

/** @param {{ classroom: Classroom }} props */
const Header = ({ classroom }) => html`
  <header class="room-header cockpit-header">
    <button class="code-button" onClick=${() => (codeIsOpen.value = true)} title="Show it large">
      <b class="code">${codeInGroups(classroom.code)}</b>
      ${classroom.qr_code && html`<img src=${classroom.qr_code} alt="" />`}
      <span class="sr-only">Code in large</span>
    </button>
    <p><b>${classroom.title}</b><span class="dim">${STATES[classroom.state]}</span></p>
    <button class="quiet square" onClick=${nextTheme} aria-label=${`Theme: ${theme.value}`}
      title=${`Theme: ${theme.value}`}><${Icon} name=${theme.value} /></button>
  </header>
`;

/** The code in large, to be held up. @param {{ classroom: Classroom }} props */
const Code = ({ classroom }) => html`
  <${Dialog} isOpen=${codeIsOpen} id="code-dialog" labelledBy="code-title" style="code-dialog">
    ${classroom.qr_code ? html`
      <h2 id="code-title">Join at</h2>
      <p class="join-address">${shortAddress(classroom.address)}</p>
      <img class="large-qr" src=${classroom.qr_code} alt=${`QR code of ${classroom.address}`} />
      <p class="code large-code">${codeInGroups(classroom.code)}</p>
      <button class="secondary" onClick=${() => copy(classroom.address, "Link copied.")}>Copy the link</button>
    ` : html`
      <h2 id="code-title">On this computer alone</h2>
      <${Sharing} />
      <${PupilsWindow} address=${classroom.address} />
    `}
    <button class="quiet" onClick=${() => (codeIsOpen.value = false)}>Close</button>
  <//>
`;

// ---- the card, and the way through the lesson

/** @param {LessonCard | undefined} card @param {number} number */
const titleOf = (card, number) => card?.title ?? `Card ${number + 1}`;

/** @param {{ classroom: Classroom }} props */
function Act({ classroom }) {
  const { card, cards, shown, html: texts, lesson } = classroom;
  const all = lesson?.cards ?? [];
  const isStill = classroom.state === "ended" || busy.value.card;
  const isLast = card === cards - 1;
  return html`
    <article class="panel act-now" aria-labelledby="act-title">
      <p class="dim">Card ${card + 1} of ${cards}${isRevealed.value && " · revealed"}</p>
      <h1 id="act-title">${titleOf(shown, card)}</h1>
      <details open=${!isPhone.peek()}><summary>What they read</summary>
        <${Prose} text=${texts.text} />
        ${shown.ask && html`<p class="dim">Asked (${shown.ask.kind}):</p><${Prose} text=${texts.ask} />`}
        ${shown.go && html`<p class="dim">Go starts: ${shown.go}${mayInWords(shown)}</p>`}
      </details>
      ${texts.reveal && html`
        <details><summary>What is revealed</summary><${Prose} text=${texts.reveal} /></details>
      `}
      <div class="row">
        <button class="secondary" disabled=${card === 0 || isStill}
          onClick=${() => showCard(card - 1)}>Previous</button>
        ${waitsForReveal(classroom) && html`
          <button class="primary" disabled=${isStill || busy.value.reveal} onClick=${reveal}>Reveal</button>
        `}
        <button class=${waitsForReveal(classroom) ? "secondary" : "primary"} disabled=${isLast || isStill}
          onClick=${() => showCard(card + 1)}>
          ${isLast ? "This is the last card" : `Next: ${titleOf(all[card + 1], card + 1)}`}
        </button>
      </div>
      <${Failure} at="card" /><${Failure} at="reveal" />
    </article>
  `;
}

/** Whether the reveal is the next act: there is something to reveal, and it was not. @param {Classroom} classroom */
const waitsForReveal = ({ shown, html: texts, knowledge }) =>
  !isRevealed.value && knowledge !== "before" && Boolean(shown.ask || shown.go || shown.teach || texts.reveal);

/** @param {LessonCard} card */
const mayInWords = ({ may = {} }) => (Object.keys(may).length ? `; open: ${Object.keys(may).join(", ")}` : "");

/** @param {{ classroom: Classroom }} props */
function Counts({ classroom }) {
  const { participants, predicted, started, shown } = classroom;
  const finished = shownResults.value?.finished ?? 0;
  const figures = [
    [participants, "joined"],
    ...(shown.ask ? [[predicted, "locked"]] : []),
    ...(shown.go ? [[started, "started"], [finished, "finished"]] : []),
  ];
  return html`
    <dl class="counts" aria-label="How far the class is">
      ${figures.map(([number, word]) => html`<div key=${word}><dt>${word}</dt><dd class="num">${number}</dd></div>`)}
    </dl>
  `;
}

/** @param {{ classroom: Classroom }} props */
function Actions({ classroom }) {
  const { state, spotlight: lit } = classroom;
  const isOver = state === "ended";
  const isRaced = runs.value.get(lit ?? "")?.kind === "race";
  const isRace = lit !== null && lit === shownResults.value?.race?.run_id;
  return html`
    <div class="row deeds-of-all">
      <button class="secondary" aria-pressed=${state === "frozen" ? "true" : "false"}
        disabled=${isOver || busy.value.freeze} onClick=${() => freeze(state !== "frozen")}>
        ${state === "frozen" ? "Let them go on" : "Freeze all"}
      </button>
      ${lit && html`
        <button class="secondary" onClick=${() => spotlight(null)}>${isRace ? "End the race" : "Spotlight off"}</button>
      `}
    </div>
    ${classroom.shown.teach && html`<${Loaded} name="teaching" load=${loadTeaching} isOver=${isOver} />`}
    ${lit && isRaced && html`<${ClockChoice} clock=${stage.value?.clock ?? "paper"} onClock=${setStageClock} />`}
    <${Failure} at="freeze" /><${Failure} at="spotlight" />
  `;
}

function Dots() {
  const results = shownResults.value;
  if (!results || results.distances_m.length === 0) return null;
  const { distances_m, interval } = results;
  const { low, high } = axisOf(distances_m);
  const typical = interval && { iqm: interval.iqm_m, low: interval.low_m, high: interval.high_m };
  const words = `${count(distances_m.length, "robot")}, typically ${metres(interval?.iqm_m)}`;
  return html`
    <section class="panel" aria-label="Distances">
      <h2>${words}</h2>
      <${DotStrip} label=${words} points=${distances_m} low=${low} high=${high} typical=${typical} axis=${metres}
        size=${1.3} />
    </section>
  `;
}

// ---- the projector, the results, the end

/** @param {{ classroom: Classroom }} props */
const Ways = ({ classroom }) => html`
  <footer class="ways">
    <a class="secondary as-button" href=${inLanguage(`${classroom.code}?projector`)} target="_blank">
      <${Icon} name="present" />Projector
    </a>
    <a class="secondary as-button" href=${resultsFile(classroom.code)} download="">
      <${Icon} name="import" />Results (CSV)
    </a>
    <a class="secondary as-button" href="../">Dashboard</a>
    ${classroom.state === "ended" ? html`<${Removal} />` : html`<${End} />`}
    <${Failure} at="end" />
  </footer>
`;

/** The end of the room, which is asked once more. */
const End = () => (willEnd.value
  ? html`
    <button class="danger" disabled=${busy.value.end} onClick=${end}>End it for everybody</button>
    <button class="quiet" onClick=${() => (willEnd.value = false)}>No, go on</button>
  `
  : html`<button class="quiet" onClick=${() => (willEnd.value = true)}>End the room</button>`);

/** The removal of a room that has ended, and of its runs. */
const Removal = () => (willDelete.value
  ? html`
    <p class="dim">Names, answers and results are deleted. Save the results before.</p>
    <button class="danger" disabled=${busy.value.end} onClick=${() => remove(true)}>Delete it with its runs</button>
    <button class="secondary" disabled=${busy.value.end} onClick=${() => remove(false)}>
      Delete it; the runs stay in the list
    </button>
    <button class="quiet" onClick=${() => (willDelete.value = false)}>No, keep it</button>
  `
  : html`<button class="quiet" onClick=${() => (willDelete.value = true)}>Delete the room</button>`);
