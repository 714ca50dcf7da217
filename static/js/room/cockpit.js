// The teacher's cockpit: the code, the card and the next one, what all may do, who is in and how far.
import { signal } from "@preact/signals";
import { DotStrip } from "../components/dot-strip.js";
import { Dialog, html, Icon } from "../components/elements.js";
import { resultsFile } from "../classroom-api.js";
import { count, metres } from "../format.js";
import { copy, nextTheme, theme, toastMessage } from "../page.js";
import { connection } from "../store.js";
import { Failure, Prose, shortAddress } from "./doors.js";
import { answerInWords } from "./questions.js";
import {
  busy, changeParticipant, end, freeze, goesOn, isRevealed, reveal, room, showCard, shownResults, spotlight,
} from "./room.js";
import { axisOf } from "./scores.js";

/** @import { Ask, Classroom, LessonCard, Person, ResultEntry } from "../types.js" */

const codeIsOpen = signal(false);
/** Whether the next press ends the room. */
const willEnd = signal(false);

export function Cockpit() {
  const known = /** @type {Classroom} */ (room.value);
  return html`
    <${Header} known=${known} />
    ${connection.value === "reconnecting" && html`
      <p class="strip-note warn" role="status"><span class="spinner" aria-hidden="true"></span> Reconnecting…</p>
    `}
    <main class="cockpit">
      <div class="cockpit-main">
        <${Act} known=${known} />
        <${Counts} known=${known} />
        <${Deeds} known=${known} />
        <${Dots} />
      </div>
      <${People} known=${known} />
      <${Ways} known=${known} />
    </main>
    <${Code} known=${known} />
    <div class="toast" role="status">${toastMessage.value && html`<p>${toastMessage.value}</p>`}</div>
  `;
}

/** @param {{ known: Classroom }} props */
const Header = ({ known }) => html`
  <header class="room-header cockpit-header">
    <button class="code-button" onClick=${() => (codeIsOpen.value = true)} aria-label=${`Code ${known.code}: show it large`}>
      <b class="code">${known.code}</b><img src=${known.qr_code} alt="" />
    </button>
    <p><b>${known.title}</b><span class="dim">${known.state === "open" ? "You teach" : known.state}</span></p>
    <button class="quiet square" onClick=${nextTheme} aria-label=${`Theme: ${theme.value}`} title=${`Theme: ${theme.value}`}>
      <${Icon} name=${theme.value} /></button>
  </header>
`;

/** The code in large, to be held up. @param {{ known: Classroom }} props */
const Code = ({ known }) => html`
  <${Dialog} isOpen=${codeIsOpen} id="code-dialog" labelledBy="code-title" style="code-dialog">
    <h2 id="code-title">Join at</h2>
    <p class="join-address">${shortAddress(known.address)}</p>
    <img class="large-qr" src=${known.qr_code} alt=${`QR code of ${known.address}`} />
    <p class="code large-code">${known.code}</p>
    <button class="secondary" onClick=${() => copy(known.address, "Link copied.")}>Copy the link</button>
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
  const isOver = known.state === "ended";
  const isLast = card === cards - 1;
  return html`
    <article class="panel act-now" aria-labelledby="act-title">
      <p class="dim">Card ${card + 1} of ${cards}${isRevealed.value && " · revealed"}</p>
      <h1 id="act-title">${titleOf(shown, card)}</h1>
      <details open><summary>What they read</summary>
        <${Prose} text=${texts.text} />
        ${shown.ask && html`<p class="dim">Asked (${shown.ask.kind}):</p><${Prose} text=${texts.ask} />`}
        ${shown.go && html`<p class="dim">Go starts: ${shown.go}${mayInWords(shown)}</p>`}
      </details>
      ${texts.reveal && html`<details><summary>What is revealed</summary><${Prose} text=${texts.reveal} /></details>`}
      <div class="row">
        <button class="secondary" disabled=${card === 0 || isOver || busy.value.card} onClick=${() => showCard(card - 1)}>
          Previous</button>
        <button class="primary" disabled=${isLast || isOver || busy.value.card} onClick=${() => showCard(card + 1)}>
          ${isLast ? "That was the last card" : `Next: ${titleOf(all[card + 1], card + 1)}`}</button>
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
    ...(shown.go && shown.go !== "what-if" ? [[started, "started"], [finished, "finished"]] : []),
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
      <button class="secondary" aria-pressed=${state === "frozen" ? "true" : "false"} disabled=${isOver || busy.value.freeze}
        onClick=${() => freeze(state !== "frozen")}>${state === "frozen" ? "Let them go on" : "Freeze all"}</button>
      <button class="secondary" disabled=${isOver || isRevealed.value || !hasReveal || busy.value.reveal} onClick=${reveal}>
        ${isRevealed.value ? "Revealed" : "Reveal"}</button>
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
      <${DotStrip} label=${words} points=${distances_m} low=${low} high=${high} typical=${typical} axis=${metres} size=${1.3} />
    </section>
  `;
}

// ---- who is in

/** @param {{ known: Classroom }} props */
function People({ known }) {
  const people = known.people.filter(({ is_present, run_id, has_predicted }) => is_present || run_id || has_predicted);
  const entries = new Map((shownResults.value?.entries ?? []).map((entry) => [entry.seed, entry]));
  return html`
    <section class="panel people" aria-labelledby="people-title">
      <h2 id="people-title">Who is in</h2>
      ${people.length === 0 && html`<p class="dim">Nobody yet. They open the address, or scan the code, and press Join.</p>`}
      <ul>
        ${people.map((person) => html`
          <${One} key=${person.seed} person=${person} entry=${entries.get(person.seed)} known=${known} />
        `)}
      </ul>
    </section>
  `;
}

/** @param {{ person: Person, entry: ResultEntry | undefined, known: Classroom }} props */
function One({ person, entry, known }) {
  const { seed, name, is_name_hidden, is_approved, run_id } = person;
  const isLit = run_id !== null && known.spotlight === run_id;
  return html`
    <li>
      <p><b class=${is_name_hidden ? "hidden-name" : ""}>${name}</b><span class="dim">${howFar(person, entry, known)}</span></p>
      <span class="person-deeds">
        ${!is_approved && html`
          <button class="secondary compact" onClick=${() => changeParticipant(seed, { is_approved: true })}>Approve</button>
        `}
        ${run_id && html`
          <button class="quiet square" aria-pressed=${isLit ? "true" : "false"} title="Show on the projector"
            aria-label=${`Spotlight ${name}`} onClick=${() => spotlight(isLit ? null : run_id)}>
            <${Icon} name="present" /></button>
        `}
        <button class="quiet compact" onClick=${() => changeParticipant(seed, { is_name_hidden: !is_name_hidden })}
          aria-label=${`${is_name_hidden ? "Show" : "Hide"} the name ${name}`}>${is_name_hidden ? "Show name" : "Hide name"}</button>
      </span>
      <${Failure} at=${`participant ${seed}`} />
    </li>
  `;
}

/** How far a participant is on the card. @type {(person: Person, entry: ResultEntry | undefined, known: Classroom) => string} */
function howFar({ seed, has_predicted, run_state, is_present }, entry, { shown }) {
  const parts = [`seed ${seed}`];
  if (!is_present) parts.push("left");
  if (shown.ask) {
    const answer = entry?.prediction ?? null;
    parts.push(!has_predicted ? "no prediction" : answer === null ? "locked" : `said ${answerInWords(/** @type {Ask} */ (shown.ask), answer)}`);
  }
  if (run_state && goesOn({ state: run_state })) parts.push(run_state);
  else if (run_state) parts.push(entry?.run?.distance_m === null || !entry?.run ? run_state : `went ${metres(entry.run.distance_m)}`);
  return parts.join(" · ");
}

// ---- the projector, the results, the end

/** @param {{ known: Classroom }} props */
function Ways({ known }) {
  const isOver = known.state === "ended";
  const press = () => {
    if (willEnd.peek()) end();
    willEnd.value = !willEnd.peek();
  };
  return html`
    <footer class="ways">
      <a class="secondary as-button" href=${`${known.code}?projector`} target="_blank"><${Icon} name="present" />Projector</a>
      <a class="secondary as-button" href=${resultsFile(known.code)} download><${Icon} name="import" />Results (CSV)</a>
      <a class="secondary as-button" href="../">Dashboard</a>
      <button class=${willEnd.value ? "danger" : "quiet"} disabled=${isOver} onClick=${press}>
        ${isOver ? "The room has ended" : willEnd.value ? "End it for everybody?" : "End the room"}</button>
      ${willEnd.value && html`<button class="quiet" onClick=${() => (willEnd.value = false)}>No, go on</button>`}
      <${Failure} at="end" />
    </footer>
  `;
}
