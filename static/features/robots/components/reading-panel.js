// The panel beside the picture of a robot that is read: what was found, what is guessed, and the ways to correct it.
import { html, Icon } from "../../../js/components/elements.js";
import { sentence } from "../../../js/format.js";
import {
  chooseForward, clickMode, decisionProblem, feetChosen, groups, nextGroup, possibleFeet, shownNote, toggleFoot,
  wantedForward,
} from "../inspecting.js";
import { AXES, directionInWords, inTurn, offerInWords, withDocument, asDecision } from "../reading-choices.js";
import { lengthInWords } from "../quantities.js";
import { missingInWords, robotInWords, topicTitle } from "../reading-words.js";
import {
  canStore, canTrain, canUndo, choices, closeReading, corrected, decide, isStoring, keepRobot, opening, reading,
  readingAnnounced, refusal, robotName, trainRobot, undoDecision,
} from "../reading.js";
import { limitsOf } from "../../../js/settings.js";
import { FurtherChoices } from "./further-choices.js";

/** @import { FoundRobot, Reading, ReadingNote } from "../reading.js" */

export function ReadingPanel() {
  const read = reading.value;
  return html`
    <section class="reading" aria-label="Robot from a file">
      <header class="reading-head">
        <div>
          <h2>${read?.robot?.name ?? read?.file ?? opening.value ?? "Robot from a file"}</h2>
          <p class="dim">${read?.robot ? robotInWords(read.robot) : read ? "It cannot be stored yet." : ""}</p>
        </div>
        <button class="quiet square" aria-label="Leave this robot" onClick=${closeReading}>✕</button>
      </header>
      <div class="reading-body" tabindex="0" role="region" aria-label="What was found">
        ${read ? html`<${Found} read=${read} />` : html`<${Opening} />`}
      </div>
      ${read && html`<${Foot} read=${read} />`}
      <p class="sr-only" role="status">${readingAnnounced}</p>
    </section>
  `;
}

/** Until the server has read it, or why it cannot. */
const Opening = () => (refusal.value
  ? html`<div class="notice bad" role="alert"><p>${sentence(refusal.value)}</p></div>`
  : html`
    <p role="status"><span class="spinner" aria-hidden="true"></span> Reading ${opening.value ?? "the file"}…</p>
  `);

/** @param {{ read: Reading }} props */
const Found = ({ read }) => html`
  ${read.problem && html`
    <div class="notice bad" role="alert"><p>${sentence(read.problem)}</p></div>
    <p>${missingInWords(read)}</p>
  `}
  ${decisionProblem.value && html`<p class="mistake" role="alert">${decisionProblem.value}</p>`}
  ${read.documents.length > 1 && html`<${Documents} read=${read} />`}
  ${read.robot && html`<${Shape} robot=${read.robot} />`}
  ${(clickMode.value === "feet" || !read.robot) && html`
    <${FeetList} feet=${possibleFeet.value.map(({ name }) => name)} />
  `}
  <${Guesses} notes=${read.notes} />
  <${FurtherChoices} read=${read} />
  <${Repairs} notes=${read.notes} />
`;

/** @param {{ read: Reading }} props */
const Documents = ({ read }) => html`
  <div class="reading-row">
    <label for="reading-document">Document</label>
    <select id="reading-document" onChange=${(/** @type {{ target: HTMLSelectElement }} */ { target }) =>
      decide(withDocument(target.value))}>
      ${read.documents.toSorted().map((path) => html`
        <option key=${path} value=${path} selected=${path === read.document}>${path}</option>
      `)}
    </select>
  </div>
`;

/** Forward, groups and stance of what was read. @param {{ robot: FoundRobot }} props */
function Shape({ robot }) {
  const forward = inTurn(wantedForward.value);
  return html`
    <div class="reading-row" role="group" aria-labelledby="reading-forward">
      <span id="reading-forward">Forward <b>${directionInWords(forward)}</b></span>
      <div class="segments">
        ${AXES.map(([name, angle_deg, words]) => html`
          <button key=${name} aria-pressed=${inTurn(angle_deg) === forward ? "true" : "false"}
            aria-label=${`Forward along ${words}`} onClick=${() => chooseForward(angle_deg)}>${words}</button>
        `)}
      </div>
    </div>
    <div class="reading-row" role="group" aria-labelledby="reading-groups">
      <span id="reading-groups">Groups</span>
      <div class="reading-groups">
        ${groups.value.map((legs, number) => html`
          <span key=${number} class=${`pair-${(number % COLORS) + 1}`}>
            ${legs.map((leg) => html`
              <button key=${leg} title=${`Leg ${leg}: move it to the next group`} onClick=${() => nextGroup(leg)}
                aria-label=${`Leg ${leg} of group ${number + 1}: move it to the next`}>${leg}</button>
            `)}
          </span>
        `)}
      </div>
    </div>
    ${robot.body_heights_m && html`<${Height} robot=${robot} heights_m=${robot.body_heights_m} />`}
    ${robot.keyframes.length > 0 && html`
      <div class="reading-row">
        <label for="reading-stance">It stands as in</label>
        <select id="reading-stance" onChange=${(/** @type {{ target: HTMLSelectElement }} */ { target }) =>
          decide({ keyframe: target.value || null, body_height_m: null })}>
          <option value="" selected=${!choices.value.keyframe}>as found</option>
          ${robot.keyframes.map((name) => html`
            <option key=${name} value=${name} selected=${name === choices.value.keyframe}>${name}</option>
          `)}
        </select>
      </div>
    `}
  `;
}

/** Of groups. */
const COLORS = 6;
const HEIGHT_STEPS = 60;

/** @param {{ robot: FoundRobot, heights_m: [number, number] }} props */
function Height({ robot, heights_m: [lowest, highest] }) {
  const height_m = choices.value.body_height_m ?? robot.body_height_m;
  const share = highest > lowest ? (height_m - lowest) / (highest - lowest) : 0;
  return html`
    <div class="reading-row wide">
      <label for="reading-height">Height <b>${lengthInWords(height_m)}</b></label>
      <input type="range" id="reading-height" min=${lowest} max=${highest}
        step=${(highest - lowest) / HEIGHT_STEPS || "any"} value=${height_m}
        style=${{ "--share": `${100 * share}%` }} aria-valuetext=${lengthInWords(height_m)}
        onInput=${(/** @type {{ target: HTMLInputElement }} */ { target }) =>
          decide({ body_height_m: Number(Number(target.value).toPrecision(4)) })} />
    </div>
  `;
}

/** @param {{ feet: string[] }} props */
const FeetList = ({ feet }) => feet.length > 0 && html`
  <fieldset class="reading-feet-list">
    <legend>Feet: a leg for each that is chosen</legend>
    <div class="checks">
      ${feet.map((foot) => html`
        <label class="check" key=${foot}>
          <input type="checkbox" checked=${feetChosen.value.includes(foot)} onChange=${() => toggleFoot(foot)} />${foot}
        </label>
      `)}
    </div>
  </fieldset>
`;

// ---- guesses and repairs

/** @param {{ notes: ReadingNote[] }} props */
function Guesses({ notes }) {
  const isOffer = (/** @type {ReadingNote} */ { offer }) => Number(offer !== null);
  const guesses = notes.map((note, index) => ({ note, index })).filter(({ note }) => note.kind === "guess")
    .toSorted((a, b) => isOffer(b.note) - isOffer(a.note));
  return guesses.length > 0 && html`
    <h3>Guessed</h3>
    <ul class="reading-notes">
      ${guesses.map(({ note, index }) => html`
        <li key=${index} id=${`reading-note-${index}`} tabindex="-1" class=${shownNote.value === index ? "shown" : ""}>
          <p><b>${topicTitle(note.topic)}</b> ${sentence(note.text)}</p>
          ${note.offer && html`
            <button class="secondary compact" onClick=${() => note.offer && decide(asDecision(note.offer))}>
              ${offerInWords(note.offer)}
            </button>
          `}
        </li>
      `)}
    </ul>
  `;
}

/** @param {{ notes: ReadingNote[] }} props */
function Repairs({ notes }) {
  const repairs = notes.filter(({ kind }) => kind === "repair");
  return repairs.length > 0 && html`
    <details class="told">
      <summary>Repaired: ${repairs.length}</summary>
      <ul>${repairs.map(({ text }) => html`<li key=${text}>${sentence(text)}</li>`)}</ul>
    </details>
  `;
}

// ---- storing

/** @param {{ read: Reading }} props */
const Foot = ({ read }) => html`
  <div class="reading-foot">
    ${read.robot && html`
      <div class="reading-row">
        <label for="reading-name">Name</label>
        <input type="text" id="reading-name" value=${robotName.value} autocomplete="off"
          maxlength=${limitsOf("name").maximum}
          onInput=${(/** @type {{ target: HTMLInputElement }} */ { target }) => (robotName.value = target.value)} />
      </div>
    `}
    <div class="reading-actions">
      <button class="quiet" aria-disabled=${canUndo.value ? undefined : "true"} onClick=${undoDecision}>
        <${Icon} name="undo" />Undo
      </button>
      <span class="space"></span>
      <button class="secondary" aria-disabled=${canStore.value ? undefined : "true"}
        onClick=${() => canStore.peek() && keepRobot()}>${corrected.value ? "Save" : "Keep"}</button>
      <button class="primary" aria-disabled=${canTrain.value ? undefined : "true"} onClick=${trainRobot}>
        ${isStoring.value ? html`<span class="spinner" aria-hidden="true"></span>` : html`<${Icon} name="play" />`}Train
      </button>
    </div>
  </div>
`;
