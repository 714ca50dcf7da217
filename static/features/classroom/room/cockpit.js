// The teacher's cockpit: the code, the card and the next one, what all may do, who is in and how far.
import { signal } from "@preact/signals";
import { DotStrip } from "../../../js/components/dot-strip.js";
import { Dialog, html, Icon, Slot } from "../../../js/components/elements.js";
import { Prose } from "../components/prose.js";
import { resultsFile } from "../api.js";
import { PupilsWindow, Sharing } from "../components/sharing.js";
import { codeInGroups, count, metres, shortAddress } from "../../../js/format.js";
import { copy, isPhone, nextTheme, theme, toastMessage } from "../../../js/page.js";
import { Away, Failure } from "./join.js";
import { People } from "./people.js";
import { busy, end, freeze, isRevealed, remove, reveal, room, showCard, shownResults, spotlight } from "./room.js";
import { axisOf } from "./scores.js";

/** @import { Classroom, LessonCard } from "../../../js/types.js" */

const codeIsOpen = signal(false);
/** Whether the end of the room, and its removal, were asked for once. */
const [willEnd, willDelete] = [signal(false), signal(false)];

export function Cockpit() {
  const known = /** @type {Classroom} */ (room.value);
  return html`
    <${Header} known=${known} />
    <${Away} />
    <main class="cockpit">
      <div class="cockpit-main">
        <${Act} known=${known} />
        <${Counts} known=${known} />
        <${Deeds} known=${known} />
        <${Dots} />
      </div>
      <${People} known=${known} />
      <${Slot} name="cockpit of a room" room=${known} />
      <${Ways} known=${known} />
    </main>
    <${Code} known=${known} />
    <div class="toast" role="status">${toastMessage.value && html`<p>${toastMessage.value}</p>`}</div>
  `;
}

const STATES = { open: "You teach", frozen: "All stand still", ended: "The room has ended" };

/** @param {{ known: Classroom }} props */
const Header = ({ known }) => html`
  <header class="room-header cockpit-header">
    <button class="code-button" onClick=${() => (codeIsOpen.value = true)} title="Show it large">
      <b class="code">${codeInGroups(known.code)}</b>${known.qr_code && html`<img src=${known.qr_code} alt="" />`}
      <span class="sr-only">Code in large</span>
    </button>
    <p><b>${known.title}</b><span class="dim">${STATES[known.state]}</span></p>
    <button class="quiet square" onClick=${nextTheme} aria-label=${`Theme: ${theme.value}`}
      title=${`Theme: ${theme.value}`}><${Icon} name=${theme.value} /></button>
  </header>
`;

/** The code in large, to be held up. @param {{ known: Classroom }} props */
const Code = ({ known }) => html`
  <${Dialog} isOpen=${codeIsOpen} id="code-dialog" labelledBy="code-title" style="code-dialog">
    ${known.qr_code ? html`
      <h2 id="code-title">Join at</h2>
      <p class="join-address">${shortAddress(known.address)}</p>
      <img class="large-qr" src=${known.qr_code} alt=${`QR code of ${known.address}`} />
      <p class="code large-code">${codeInGroups(known.code)}</p>
      <button class="secondary" onClick=${() => copy(known.address, "Link copied.")}>Copy the link</button>
    ` : html`
      <h2 id="code-title">On this computer alone</h2>
      <${Sharing} />
      <${PupilsWindow} address=${known.address} />
    `}
    <button class="quiet" onClick=${() => (codeIsOpen.value = false)}>Close</button>
  <//>
`;

// ---- the card, and the way through the lesson

/** @param {LessonCard | undefined} card @param {number} number */
const titleOf = (card, number) => card?.title ?? `Card ${number + 1}`;

/** @param {{ known: Classroom }} props */
function Act({ known }) {
  const { card, cards, shown, html: texts, lesson } = known;
  const all = lesson?.cards ?? [];
  const isStill = known.state === "ended" || busy.value.card;
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
        <button class="primary" disabled=${isLast || isStill} onClick=${() => showCard(card + 1)}>
          ${isLast ? "This is the last card" : `Next: ${titleOf(all[card + 1], card + 1)}`}
        </button>
      </div>
      <${Failure} at="card" />
    </article>
  `;
}

/** @param {LessonCard} card */
const mayInWords = ({ may = {} }) => (Object.keys(may).length ? `; open: ${Object.keys(may).join(", ")}` : "");

/** @param {{ known: Classroom }} props */
function Counts({ known }) {
  const { participants, predicted, started, shown } = known;
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

/** @param {{ known: Classroom }} props */
function Deeds({ known }) {
  const { state, spotlight: lit, shown } = known;
  const isOver = state === "ended";
  const hasReveal = Boolean(shown.ask || shown.go || known.html.reveal);
  return html`
    <div class="row deeds-of-all">
      <button class="secondary" aria-pressed=${state === "frozen" ? "true" : "false"}
        disabled=${isOver || busy.value.freeze} onClick=${() => freeze(state !== "frozen")}>
        ${state === "frozen" ? "Let them go on" : "Freeze all"}
      </button>
      <button class="secondary" disabled=${isOver || isRevealed.value || !hasReveal || busy.value.reveal}
        onClick=${reveal}>${isRevealed.value ? "Revealed" : "Reveal"}</button>
      ${lit && html`<button class="secondary" onClick=${() => spotlight(null)}>Spotlight off</button>`}
    </div>
    <${Failure} at="freeze" /><${Failure} at="reveal" /><${Failure} at="spotlight" />
  `;
}

function Dots() {
  const found = shownResults.value;
  if (!found || found.distances_m.length === 0) return null;
  const { distances_m, interval } = found;
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

/** @param {{ known: Classroom }} props */
const Ways = ({ known }) => html`
  <footer class="ways">
    <a class="secondary as-button" href=${`${known.code}?projector`} target="_blank">
      <${Icon} name="present" />Projector
    </a>
    <a class="secondary as-button" href=${resultsFile(known.code)} download="">
      <${Icon} name="import" />Results (CSV)
    </a>
    <a class="secondary as-button" href="../">Dashboard</a>
    ${known.state === "ended" ? html`<${Removal} />` : html`<${End} />`}
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
