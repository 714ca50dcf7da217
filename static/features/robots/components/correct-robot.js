// Fields that correct what was guessed of a robot from a file, before it walks.
import { correct, fields, isReading, readAgain, setCorrection, whole, wrongChoice } from "../correction.js";
import { html } from "../../../js/components/elements.js";
import { Notes } from "./notes.js";

/** @import { Fields } from "../correction.js" */
/** @import { Found } from "../../../js/types.js" */

const FORWARD = [["x", "x of its torso"], ["-x", "−x"], ["y", "y"], ["-y", "−y"]];

export function CorrectRobot() {
  const [now, robot] = [fields.value, whole.value];
  if (!now || !robot) {
    return wrongChoice.value
      ? html`<p class="mistake" role="alert">${wrongChoice.value}</p>`
      : html`<p class="dim" role="status">Asking what was found…</p>`;
  }
  const { found } = robot;
  if (!found) return html`<p class="dim">Its file is not here: it was saved elsewhere, without it.</p>`;
  /** @param {Event} event */
  const onSubmit = (event) => {
    event.preventDefault();
    readAgain();
  };
  return html`
    <form class="robots-correct" onSubmit=${onSubmit}>
      <${Notes} title="Guessed" sentences=${robot.guesses} isOpen=${true} />
      <${Notes} title="Repaired" sentences=${robot.repairs} />
      <${Forward} found=${found} forward=${now.forward} />
      <div class="field">
        <label for="correct-groups">Groups of legs</label>
        <input type="text" id="correct-groups" value=${now.groups} onInput=${onText("groups")} />
      </div>
      <${Feet} found=${found} feet=${now.feet} />
      <${Stance} found=${found} keyframe=${now.keyframe} angles=${now.angles} />
      <${Servo} id="correct-torque" label="Largest torque, N·m" name="torque" value=${now.torque} />
      <${Servo} id="correct-gain" label="Stiffness, N·m/rad" name="gain" value=${now.gain} />
      ${wrongChoice.value && html`<p class="mistake" role="alert">${wrongChoice.value}</p>`}
      <div class="robots-row">
        <button class="secondary" aria-disabled=${isReading.value ? "true" : undefined}>
          ${isReading.value ? "Reading…" : "Read it again"}
        </button>
        <button type="button" class="quiet" onClick=${() => correct(null)}>Done</button>
      </div>
    </form>
  `;
}

/** @param {{ found: Found, forward: string }} props */
function Forward({ found, forward }) {
  const isOther = !FORWARD.some(([value]) => value === forward) && forward !== "";
  return html`
    <div class="field">
      <label for="correct-forward">Forward</label>
      <select id="correct-forward" onChange=${onText("forward")}>
        <option value="" selected=${forward === ""}>as found: ${Math.round(found.forward_deg)}° from x</option>
        ${FORWARD.map(([value, words]) => html`
          <option value=${value} selected=${value === forward}>${words}</option>
        `)}
        ${isOther && html`<option value=${forward} selected>${forward}° from x</option>`}
      </select>
    </div>
  `;
}

/** @param {{ found: Found, feet: string[] }} props */
const Feet = ({ found, feet }) => html`
  <fieldset class="field wide">
    <legend>Feet: a leg for each that is chosen</legend>
    <div class="checks">
      ${found.feet.map((foot) => html`
        <label class="check" key=${foot}>
          <input type="checkbox" checked=${feet.includes(foot)} onChange=${() => toggleFoot(foot)} />${foot}
        </label>
      `)}
    </div>
  </fieldset>
`;

/** @param {{ found: Found, keyframe: string, angles: string }} props */
const Stance = ({ found, keyframe, angles }) => html`
  ${found.keyframes.length > 0 && html`
    <div class="field">
      <label for="correct-stance">It stands as in</label>
      <select id="correct-stance" onChange=${onText("keyframe")}>
        <option value="" selected=${keyframe === ""}>as found</option>
        ${found.keyframes.map((name) => html`<option value=${name} selected=${name === keyframe}>${name}</option>`)}
      </select>
    </div>
  `}
  <div class="field">
    <label for="correct-angles">Angles when it stands, rad</label>
    <input type="text" id="correct-angles" value=${angles} placeholder="joint=angle, …" onInput=${onText("angles")} />
  </div>
`;

/** @param {{ id: string, label: string, name: "torque" | "gain", value: string }} props */
const Servo = ({ id, label, name, value }) => html`
  <div class="field">
    <label for=${id}>${label}</label>
    <input type="text" inputmode="decimal" id=${id} value=${value} placeholder="as found" onInput=${onText(name)} />
  </div>
`;

/** @param {Exclude<keyof Fields, "feet">} name */
const onText = (name) => (/** @type {{ target: HTMLInputElement }} */ { target }) => setCorrection(name, target.value);

/** In the order of the file. @param {string} foot */
function toggleFoot(foot) {
  const [chosen, feet] = [fields.peek()?.feet ?? [], whole.peek()?.found?.feet ?? []];
  setCorrection("feet", feet.filter((name) => chosen.includes(name) !== (name === foot)));
}
