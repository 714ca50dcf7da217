// Who is in the room and how far, for the teacher; and what others see of each.
import { html, Icon } from "../components/elements.js";
import { metres } from "../format.js";
import { Failure } from "./doors.js";
import { answerInWords } from "./questions.js";
import { changeParticipant, goesOn, shownResults, spotlight } from "./room.js";

/** @import { Ask, Classroom, Person, ResultEntry } from "../types.js" */

/** @param {{ known: Classroom }} props */
export function People({ known }) {
  const people = known.people.filter(({ is_present, run_id, has_predicted }) =>
    is_present || run_id || has_predicted);
  const entries = new Map((shownResults.value?.entries ?? []).map((entry) => [entry.seed, entry]));
  return html`
    <section class="panel people" aria-labelledby="people-title">
      <h2 id="people-title">Who is in</h2>
      ${people.length === 0 && html`
        <p class="dim">Nobody yet. They open the address, or scan the code, and press Join.</p>
      `}
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
  const hideWords = is_name_hidden ? "Show name" : "Hide name";
  return html`
    <li>
      <p>
        <b class=${is_name_hidden ? "hidden-name" : ""}>${name}</b>
        <span class="dim">${howFar(person, entry, known)}</span>
      </p>
      <span class="person-deeds">
        ${!is_approved && html`
          <button class="secondary compact" aria-label=${`Approve ${name}`}
            onClick=${() => changeParticipant(seed, { is_approved: true })}>Approve</button>
        `}
        ${run_id && html`
          <button class="quiet square" aria-pressed=${isLit ? "true" : "false"} title="Show on the projector"
            aria-label=${`Spotlight ${name}`} onClick=${() => spotlight(isLit ? null : run_id)}>
            <${Icon} name="present" />
          </button>
        `}
        <button class="quiet compact" aria-label=${`${hideWords}: ${name}`}
          onClick=${() => changeParticipant(seed, { is_name_hidden: !is_name_hidden })}>${hideWords}</button>
      </span>
      <${Failure} at=${`participant ${seed}`} />
    </li>
  `;
}

/** How far a participant is on the card. */
/** @type {(person: Person, entry: ResultEntry | undefined, known: Classroom) => string} */
function howFar(person, entry, { shown }) {
  const parts = [`seed ${person.seed}`];
  if (!person.is_present) parts.push("left");
  if (shown.ask) parts.push(person.has_predicted ? saidBy(entry, shown.ask) : "no prediction");
  if (person.run_state) parts.push(runOf(person.run_state, entry?.run?.distance_m ?? null));
  return parts.join(" · ");
}

/** @type {(entry: ResultEntry | undefined, ask: Ask) => string} */
const saidBy = (entry, ask) =>
  (entry === undefined || entry.prediction === null ? "locked" : `said ${answerInWords(ask, entry.prediction)}`);

/** @type {(state: string, distance_m: number | null) => string} */
const runOf = (state, distance_m) =>
  (goesOn({ state }) || distance_m === null ? state : `went ${metres(distance_m)}`);
