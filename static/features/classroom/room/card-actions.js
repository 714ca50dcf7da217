// What a participant can do on the card: lock the prediction, let the robot go, and what one waits for.
import { t } from "../../../js/format.js";
import { html } from "../../../js/components/elements.js";
import { Failure } from "./join.js";
import { chosenSettings } from "./allowed-settings.js";
import { draftOf } from "./questions.js";
import {
  busy, go, goesOn, isRevealed, lock, ownAnswer, ownEntry, ownRun, ownWhatIf, room,
} from "./room.js";

/** @import { LessonCard } from "../../../js/types.js" */

const GO = {
  "training": t("Go: let it practise"), "race": t("Go: race"), "what-if": t("Go: try it on thirty robots"),
};

/** The words of the button that runs what a card runs. @param {LessonCard} card */
function wordsOf({ go: kind }) {
  if (busy.value.go) return kind === "what-if" ? t("Thirty robots practise…") : t("Your robot starts…");
  return ownRun.value || ownWhatIf.value ? t("Go again with these settings") : GO[kind ?? "training"];
}

/** Whether the card asks, and waits for the own answer. @param {LessonCard} card */
const needsAnswer = (card) => Boolean(card.ask) && ownAnswer.value === undefined && !isRevealed.value;

/** Whether the card runs what has been run already: the same settings give the same run. */
/** @type {(card: LessonCard, settings: Record<string, unknown> | null) => boolean} */
function isSameAgain({ may, go: kind }, settings) {
  const isAlike = (/** @type {Record<string, unknown>} */ settingsOfRun) =>
    Object.keys(may ?? {}).every((name) => settingsOfRun[name] === settings?.[name]);
  if (kind === "what-if") return ownWhatIf.value !== null && isAlike(ownEntry.value?.run?.given ?? {});
  if (ownRun.value === null || ownRun.value.state !== "finished") return false;
  const { id = null, given = {} } = ownEntry.value?.run ?? {};
  // What it was given comes with the results, soon after its end.
  if (id !== ownRun.value.id) return true;
  return isAlike(given);
}

/** @param {{ card: LessonCard, number: number, isOpen: boolean }} props */
export function CardActions({ card, number, isOpen }) {
  const settings = chosenSettings(card, number);
  const mayAct = isOpen && !busy.value.lock && !busy.value.go;
  const isAsked = needsAnswer(card);
  const isNew = Boolean(card.go) && !goesOn(ownRun.value) && !isSameAgain(card, settings);
  const canGo = mayAct && isNew && settings !== null;
  return html`
    <div class=${isAsked || isNew ? "deeds" : ""}>
      <${Failure} at="lock" /><${Failure} at="go" />
      ${isAsked && html`
        <${LockFirst} card=${card} number=${number} mayAct=${mayAct} canGo=${canGo} settings=${settings ?? {}} />
      `}
      ${!isAsked && isNew && html`
        <${Button} style="primary" canPress=${canGo} onPress=${() => go(settings ?? {})}
          words=${wordsOf(card)} />
      `}
    </div>
  `;
}

/**
 * A prediction that is not locked yet; where the card runs something, one press does both.
 * @param {object} props
 * @param {LessonCard} props.card
 * @param {number} props.number
 * @param {boolean} props.mayAct
 * @param {boolean} props.canGo
 * @param {Record<string, unknown>} props.settings
 */
function LockFirst({ card, number, mayAct, canGo, settings }) {
  const answer = draftOf(card, number);
  const canLock = mayAct && answer !== undefined;
  const lockAndGo = async () => (await lock(answer)) && go(settings);
  return html`
    ${card.go && html`
      <${Button} style="primary" canPress=${canLock && canGo} onPress=${lockAndGo} words="Lock my prediction, and go" />
    `}
    <${Button} style=${card.go ? "secondary" : "primary"} canPress=${canLock} onPress=${() => lock(answer)}
      words="Lock my prediction" />
  `;
}

/** @param {{ style: string, canPress: boolean, onPress: () => unknown, words: string }} props */
const Button = ({ style, canPress, onPress, words }) => html`
  <button class=${style} aria-disabled=${canPress ? undefined : "true"} onClick=${() => canPress && onPress()}>
    ${words}
  </button>
`;

/** What one waits for, once all is done. @param {{ card: LessonCard }} props */
export function Next({ card }) {
  const classroom = room.value;
  if (classroom === null || needsAnswer(card) || goesOn(ownRun.value)) return null;
  if (card.go && !ownRun.value && !ownWhatIf.value) return null;
  return html`<p class="dim waiting" role="status">${waitingFor(card, classroom.card === classroom.cards - 1)}</p>`;
}

/** @type {(card: LessonCard, isLast: boolean) => string} */
function waitingFor(card, isLast) {
  if (card.ask && !isRevealed.value) return t("Wait for the reveal.");
  return isLast ? t("This is the last card.") : t("The next card comes from your teacher.");
}
