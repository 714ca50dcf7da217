// Who is in the room and how far, for the teacher; and what others see of each.
import { signal } from "@preact/signals";
import { useRef } from "preact/hooks";
import { Dialog, html, Icon } from "../../../js/components/elements.js";
import { metres } from "../../../js/format.js";
import { toast } from "../../../js/page.js";
import { Failure } from "./join.js";
import { answerInWords } from "./questions.js";
import { busy, changeParticipant, goesOn, removeParticipant, shownResults, spotlight } from "./room.js";

/** @import { Ask, Classroom, Person, ResultEntry } from "../../../js/types.js" */

/** Who is to be removed, which is asked once more. @type {import("@preact/signals").Signal<Person | null>} */
const chosen = signal(null);
const removalIsOpen = signal(false);

/** @param {{ classroom: Classroom }} props */
export function People({ classroom }) {
  const people = classroom.people.filter(({ is_present, run_id, has_predicted }) =>
    is_present || run_id || has_predicted);
  const entries = new Map((shownResults.value?.entries ?? []).map((entry) => [entry.seed, entry]));
  const head = useRef(/** @type {HTMLElement | null} */ (null));
  return html`
    <section class="panel people" aria-labelledby="people-title">
      <h2 id="people-title" ref=${head} tabindex="-1">Who is in</h2>
      ${people.length === 0 && html`
        <p class="dim">Nobody yet. They open the address, or scan the code, and press Join.</p>
      `}
      <ul>
        ${people.map((person) => html`
          <${PersonRow} key=${person.seed} person=${person} entry=${entries.get(person.seed)} classroom=${classroom} />
        `)}
      </ul>
    </section>
    <${Removal} onRemoved=${() => head.current?.focus()} />
  `;
}

/** Asks before a participant is removed. @param {{ onRemoved: () => void }} props */
function Removal({ onRemoved }) {
  const { seed = 0, name = "" } = chosen.value ?? {};
  const remove = async () => {
    const isDone = await removeParticipant(seed);
    removalIsOpen.value = false;
    // The button that has opened the dialog went with its row.
    if (isDone) setTimeout(onRemoved);
    if (isDone) toast(`${name} was removed.`);
  };
  return html`
    <${Dialog} isOpen=${removalIsOpen} id="removal" labelledBy="removal-title" style="removal-dialog">
      <h2 id="removal-title">Remove ${name}?</h2>
      <p>
        The seat and the name become free, the answers leave the results, and a run that waits or goes on is stopped.
        The phone says so. Who holds it can join again, as somebody else.
      </p>
      <div class="row">
        <button class="danger" disabled=${busy.value[`participant ${seed}`]} onClick=${remove}>Remove ${name}</button>
        <button class="quiet" autofocus onClick=${() => (removalIsOpen.value = false)}>No, keep</button>
      </div>
    <//>
  `;
}

/** @param {Person} person */
function askToRemove(person) {
  chosen.value = person;
  removalIsOpen.value = true;
}

/** @param {{ person: Person, entry: ResultEntry | undefined, classroom: Classroom }} props */
function PersonRow({ person, entry, classroom }) {
  const { seed, name, is_name_hidden, is_approved, run_id } = person;
  const isLit = run_id !== null && classroom.spotlight === run_id;
  const hideWords = is_name_hidden ? "Show name" : "Hide name";
  return html`
    <li>
      <p>
        <b class=${is_name_hidden ? "hidden-name" : ""}>${name}</b>
        <span class="dim">${howFar(person, entry, classroom)}</span>
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
        ${classroom.state !== "ended" && html`
          <button class="quiet square" title="Remove" aria-label=${`Remove ${name}…`}
            onClick=${() => askToRemove(person)}>✕</button>
        `}
      </span>
      <${Failure} at=${`participant ${seed}`} />
    </li>
  `;
}

/** How far a participant is on the card. */
/** @type {(person: Person, entry: ResultEntry | undefined, classroom: Classroom) => string} */
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
