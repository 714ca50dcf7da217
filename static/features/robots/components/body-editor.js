// The editor of the robot's body: a plan from above, the numbers of its legs and its torso, and what is known of it.
import { useEffect, useRef } from "preact/hooks";
import {
  addOne, body, cancel, canUndo, canUse, chooseLeg, chosenLeg, consequences, followBody, followerOf, goToMistake,
  isMirrored, isRefused, mistakes, noFewerLegs, noMoreLegs, objectionsAt, openingError, part, placeInWords,
  removeChosen, takeBetter, previewAnswer, undo, useBody,
} from "../body-editor.js";
import { bodyName, canSave, followSaving, saveBody, unsaved } from "../body-saving.js";
import { reachInWords } from "../body-words.js";
import { bodyIsOpen } from "../dialogs.js";
import { count } from "../../../js/format.js";
import { inWords } from "../../../js/preview.js";
import { isOperator } from "../../../js/selectors.js";
import { limitsOf } from "../../../js/settings.js";
import { BodyFields } from "./body-fields.js";
import { BodyPicture } from "./body-picture.js";
import { BodyPlan } from "./body-plan.js";
import { Dialog, html, Icon } from "../../../js/components/elements.js";
import { Held } from "../../../js/components/foot.js";

const TEXT = "input[type=text]";

export function BodyEditor() {
  useEffect(followBody, []);
  useEffect(followSaving, []);
  /** A text that is typed has its own undo. @param {KeyboardEvent & { target: Element }} event */
  const onKeyDown = (event) => {
    const isUndo = event.key.toLowerCase() === "z" && (event.ctrlKey || event.metaKey) && !event.shiftKey;
    if (!isUndo || event.target.matches(TEXT)) return;
    event.preventDefault();
    undo();
  };
  return html`
    <${Dialog} id="body-editor" labelledBy="edit-body" isOpen=${bodyIsOpen}>
      <div class="body-head">
        <h2 id="edit-body">Edit the body</h2>
        <button class="quiet square" aria-label="Close" onClick=${cancel}>✕</button>
      </div>
      ${body.value
        ? html`<div class="body-main" onKeyDown=${onKeyDown}><${PlanSide} /><${FieldSide} /></div>`
        : html`<div class="body-main"><${Opening} /></div>`}
      <div class="body-foot">
        <${Mistakes} />
        ${bodyName.value !== null && html`<${Naming} />`}
        <div class="body-actions">
          <button class="quiet" aria-disabled=${canUndo.value ? undefined : "true"} onClick=${undo}
            title="Undo the last change (Ctrl Z)"><${Icon} name="undo" />Undo</button>
          <span class="space"></span>
          ${isOperator.value && bodyName.value === null && html`
            <button class="secondary" aria-disabled=${canUse.value ? undefined : "true"}
              onClick=${() => canUse.value && (bodyName.value = "")}>Save as…</button>
          `}
          <button class="quiet" onClick=${cancel}>Cancel</button>
          <button class="primary" aria-disabled=${canUse.value ? undefined : "true"} onClick=${useBody}
            aria-describedby=${Object.keys(mistakes.value).length ? "held-body" : undefined}>Use this body</button>
        </div>
      </div>
    <//>
  `;
}

/** The name under which the body is saved. */
function Naming() {
  const field = useRef(/** @type {HTMLInputElement | null} */ (null));
  useEffect(() => field.current?.focus(), []);
  /** @param {Event} event */
  const onSubmit = (event) => {
    event.preventDefault();
    saveBody();
  };
  return html`
    <form class="body-naming" onSubmit=${onSubmit}>
      <label for="body-name">Name</label>
      <input type="text" id="body-name" ref=${field} value=${bodyName.value} autocomplete="off"
        maxlength=${limitsOf("name").maximum} aria-invalid=${unsaved.value ? "true" : undefined}
        aria-describedby=${unsaved.value ? "unsaved" : undefined}
        onInput=${(/** @type {{ target: HTMLInputElement }} */ { target }) => (bodyName.value = target.value)} />
      <button class="secondary" aria-disabled=${canSave.value ? undefined : "true"}>Save</button>
      ${unsaved.value && html`<p id="unsaved" class="mistake" role="alert">${unsaved.value}</p>`}
    </form>
  `;
}

const Opening = () => (openingError.value
  ? html`<p class="mistake" role="alert">This robot cannot be edited: ${openingError.value}</p>`
  : html`<p class="dim" role="status">Asking how the robot is built…</p>`);

const Mistakes = () => Object.keys(mistakes.value).length > 0 && html`
  <${Held} id="held-body" mistakes=${mistakes.value} nameOf=${placeInWords} onField=${goToMistake} />
`;

const PlanSide = () => html`
  <div class="body-plan-side">
    <${BodyPlan} />
    <div class="body-legs">
      <label class="check">
        <input type="checkbox" checked=${isMirrored.value}
          onChange=${() => (isMirrored.value = !isMirrored.value)} />Mirrored
      </label>
      <span class="space"></span>
      <${LegButton} words="Add a leg" why=${noMoreLegs.value} onClick=${addOne} />
      <${LegButton} words=${`Remove ${goingLegs()}`} why=${noFewerLegs.value} onClick=${removeChosen} />
    </div>
    <p class="sentence">
      Drag a number.${" "}
      <span class="wide-only">
        Or choose it: arrow keys move it, Page Up and Page Down turn it, with Shift by less.
      </span>
    </p>
  </div>
`;

/** The chosen leg and the one that goes with it, in words. */
function goingLegs() {
  const [leg, follower] = [chosenLeg.value, followerOf(chosenLeg.value)];
  if (follower === null || follower === leg) return `leg ${leg}`;
  return `legs ${Math.min(leg, follower)} and ${Math.max(leg, follower)}`;
}

/** @param {{ words: string, why: string, onClick: () => void }} props */
const LegButton = ({ words, why, onClick }) => html`
  <button class="secondary compact" aria-disabled=${why ? "true" : undefined} title=${why || undefined}
    onClick=${onClick}>${words}</button>
`;

const FieldSide = () => html`
  <div class="body-field-side">
    <${BodyFields} />
    <${Known} />
    <${BodyPicture} />
  </div>
`;

/** What is known of the body beforehand, and what the editor changes besides. */
function Known() {
  const answer = previewAnswer.value;
  return html`
    <div class="body-known" role="group" aria-label="Known before it walks">
      <p role="status">
        ${answer && !isRefused.value
          ? html`<b>${count(answer.preview.legs.length, "leg")}:</b> ${inWords(answer.preview)}`
          : "Not known."}
      </p>
      ${objectionsAt.value.filter(({ legs }) => !isSaidAtFields(legs)).map(({ legs, words }) => html`
        <${Objection} key=${words} legs=${legs} words=${words} />
      `)}
      ${answer?.preview.better && !isRefused.value && html`
        <button class="link" onClick=${takeBetter}>Take groups with which it stands</button>
      `}
      ${answer && !isRefused.value && html`<p class="dim">${reachInWords(answer.preview)}</p>`}
      ${consequences.value.map((words) => html`<p key=${words} class="dim">${words}</p>`)}
    </div>
  `;
}

/** Whether what is wrong with legs is said where the chosen one's numbers are. @param {number[]} legs */
const isSaidAtFields = (legs) => part.value === "leg" && legs.includes(chosenLeg.value);

/** @param {{ legs: number[], words: string }} props */
const Objection = ({ legs, words }) => html`
  <div class=${`notice ${legs.length ? "bad" : ""}`} role="status">
    <p>${words}</p>
    ${legs.length > 0 && html`
      <button class="link" onClick=${() => chooseLeg(legs[0])}>Show leg ${legs[0]}</button>
    `}
  </div>
`;
