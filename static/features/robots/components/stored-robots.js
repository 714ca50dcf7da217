// The robots that are stored: renamed, hidden and deleted, and new ones taken in from files.
import { useState } from "preact/hooks";
import { robotsAreOpen } from "../dialogs.js";
import { isOperator } from "../../../js/selectors.js";
import {
  changeRobot, chooseStored, deleteRobot, dismissFile, fileOf, isChosen, refusals, storedRobots, taken,
  takeRestored,
} from "../stored-robots.js";
import { takeDropped, takeFolder, takeRobotFiles } from "../dropped-files.js";
import { openStored } from "../reading.js";
import { Deletions } from "../../../js/components/deletions.js";
import { contentsOf } from "../../../js/components/dropping.js";
import { Dialog, html, Icon } from "../../../js/components/elements.js";
import { Notes } from "./notes.js";

/** @import { Robot } from "../../../js/types.js" */
/** @import { TakenFile } from "../stored-robots.js" */

const ENDINGS = ".xml,.mjcf,.urdf,.xacro,.zip,.json";

export const StoredRobots = () => html`
  <${Dialog} id="stored-robots" labelledBy="robots-title" isOpen=${robotsAreOpen}>
    <div class="body-head">
      <h2 id="robots-title">Your robots</h2>
      <button class="quiet square" aria-label="Close" onClick=${() => (robotsAreOpen.value = false)}>✕</button>
    </div>
    <div class="robots-main">
      ${isOperator.value && html`<${FromFile} />`}
      ${taken.value.map((file) => html`<${Taken} key=${file.key} one=${file} />`)}
      <${Deletions} kind="robots" take=${takeRestored} />
      ${storedRobots.value.length
        ? html`<ul class="robots-list">
            ${storedRobots.value.map((robot) => html`<${Stored} key=${robot.id} robot=${robot} />`)}
          </ul>`
        : html`<p class="dim">None yet: edit a body and save it under a name, or take one in from a file.</p>`}
    </div>
  <//>
`;

/** A button and a place to drop files on. */
function FromFile() {
  const [isOver, setOver] = useState(false);
  /** @param {DragEvent} event */
  const onDrag = (event) => {
    event.preventDefault();
    setOver(event.type === "dragover");
  };
  /** @param {DragEvent} event */
  const onDrop = (event) => {
    event.preventDefault();
    setOver(false);
    event.stopPropagation();
    if (event.dataTransfer) takeDropped(contentsOf(event.dataTransfer));
  };
  /** @param {{ target: HTMLInputElement }} event */
  const onChange = ({ target }) => {
    takeRobotFiles([...target.files ?? []]);
    // So that the same file can be chosen again.
    target.value = "";
  };
  /** @param {{ target: HTMLInputElement }} event */
  const onFolder = ({ target }) => {
    robotsAreOpen.value = false;
    takeFolder([...target.files ?? []]);
    target.value = "";
  };
  return html`
    <div class=${`robots-drop ${isOver ? "over" : ""}`} onDragOver=${onDrag} onDragLeave=${onDrag} onDrop=${onDrop}>
      <label class="file-button">
        <${Icon} name="import" /><b>Robot from a file…</b>
        <input class="sr-only" type="file" multiple accept=${ENDINGS} onChange=${onChange} />
      </label>
      <label class="file-button">
        <${Icon} name="import" /><b>From a folder…</b>
        <input class="sr-only" type="file" webkitdirectory onChange=${onFolder} />
      </label>
      <span class="dim">
        Or drop it anywhere on the page, or paste it: MJCF, URDF or xacro, a zip, or the folder of its repository. Only
        its documents and the meshes that they name are sent.
      </span>
    </div>
  `;
}

/** What came of a file. @param {{ one: TakenFile }} props */
const Taken = ({ one: { key, name, state, words, robot } }) => html`
  <div class=${`notice taken ${state === "refused" ? "bad" : ""}`} role=${state === "refused" ? "alert" : "status"}>
    <p>
      ${state === "reading" && html`<span class="spinner" aria-hidden="true"></span>`} <b>${name}</b> ${words}
    </p>
    ${robot && html`
      <${Notes} title="Guessed" sentences=${robot.guesses} />
      <${Notes} title="Repaired" sentences=${robot.repairs} />
    `}
    ${state !== "reading" && html`
      <button class="quiet square small" aria-label=${`Dismiss ${name}`} onClick=${() => dismissFile(key)}>✕</button>
    `}
  </div>
`;

/** Show the robot with what was guessed of it. @type {(id: string, name: string) => void} */
function correct(id, name) {
  robotsAreOpen.value = false;
  openStored({ id, name });
}

/** @param {{ robot: Robot }} props */
function Stored({ robot }) {
  // A stored robot has its id as its name.
  const { name: id, title, description, hidden, body } = robot;
  const refused = refusals.value[id];
  /** @param {{ target: HTMLInputElement }} event */
  const onName = ({ target }) => {
    const name = target.value.trim();
    if (name && name !== title) changeRobot(id, { name });
    else target.value = title;
  };
  return html`
    <li class=${hidden ? "hidden-robot" : ""}>
      <div class="robots-row">
        <input type="text" aria-label=${`Name of ${title}`} value=${title} disabled=${!isOperator.value}
          onChange=${onName} aria-invalid=${refused ? "true" : undefined}
          aria-describedby=${refused ? `refused-${id}` : undefined} />
        <button class="secondary compact" aria-pressed=${isChosen(robot)} onClick=${() => chooseStored(id)}>
          ${isChosen(robot) ? "Chosen" : "Choose"}
        </button>
      </div>
      <div class="robots-row">
        <span class="dim">${hidden ? "Hidden; " : ""}${description}</span>
        <span class="space"></span>
        <a class="link" href=${fileOf(id)} download="" aria-label=${`Download ${title}`}>Download</a>
        <a class="link" href=${fileOf(id, "xml")} download="" aria-label=${`MJCF of ${title}`}>MJCF</a>
        <a class="link" href=${fileOf(id, "zip")} download="" aria-label=${`URDF of ${title}`}>URDF</a>
        ${isOperator.value && !body && html`
          <button class="link" aria-label=${`Correct ${title}`} onClick=${() => correct(id, title)}>Correct…</button>
        `}
        ${isOperator.value && html`
          <button class="link" aria-label=${`${hidden ? "Show" : "Hide"} ${title}`}
            onClick=${() => changeRobot(id, { hidden: !hidden })}>${hidden ? "Show" : "Hide"}</button>
          <button class="link" aria-label=${`Delete ${title}`} onClick=${() => deleteRobot(id)}>Delete</button>
        `}
      </div>
      ${refused && html`<p id=${`refused-${id}`} class="mistake" role="alert">${refused}</p>`}
    </li>
  `;
}
