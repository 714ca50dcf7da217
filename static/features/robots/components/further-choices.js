// Decisions about a robot from a file that few need: units, arguments of xacro, servos, angles.
import { useState } from "preact/hooks";
import { html } from "../../../js/components/elements.js";
import { choices, decide } from "../reading.js";

/** @import { Reading, ReadingChoices } from "../reading.js" */

const UPS = [["", "as found"], ["z", "z"], ["y", "y"], ["x", "x"], ["-z", "−z"], ["-y", "−y"], ["-x", "−x"]];
const UNITS = [["", "as found"], ["rad", "radians"], ["deg", "degrees"]];
/** The lengths of a file in metres, by the scale. */
const LENGTHS = [["", "as found"], ["0.001", "millimetres"], ["0.01", "centimetres"], ["0.0254", "inches"]];
/** @typedef {"scale" | "mass_kg" | "servo_torque_nm" | "servo_kp" | "servo_kv"} NumberName */
/** Name, title, least and most. @type {[NumberName, string, number, number][]} */
const NUMBERS = [
  ["scale", "Scale", 0.001, 1000], ["mass_kg", "Mass, kg", 0.001, 10_000],
  ["servo_torque_nm", "Largest torque, N·m", 0.001, 10_000],
  ["servo_kp", "Stiffness, N·m/rad", 0.01, 1e6], ["servo_kv", "Damping, N·m·s/rad", 0.0001, 1e5],
];

/** A number that was typed; null for none. @param {string} text */
const numberIn = (text) => (text.trim() ? Number(text.trim().replace("−", "-")) : null);

/** @param {{ read: Reading }} props */
export const FurtherChoices = ({ read }) => html`
  ${Object.keys(read.arguments).length > 0 && html`<${Arguments} defaults=${read.arguments} />`}
  <details class="reading-further" open=${!read.robot || undefined}>
    <summary>Units and servos</summary>
    <div class="reading-fields">
      <${Choice} name="scale" title="Lengths are in" values=${LENGTHS} asValue=${Number} />
      <${Choice} name="up" title="Up" values=${UPS} />
      <${Choice} name="angle_unit" title="Angles in its limits" values=${UNITS} />
      ${NUMBERS.map(([name, title, least, most]) => html`
        <${NumberChoice} key=${name} name=${name} title=${title} least=${least} most=${most} />
      `)}
      <${Angles} />
    </div>
  </details>
`;

/**
 * A choice of a few. `asValue`: what a decision has, of its text.
 * @typedef {{
 *   name: "up" | "angle_unit" | "scale", title: string, values: string[][], asValue?: (text: string) => unknown,
 * }} ChoiceProps
 */
/** @param {ChoiceProps} props */
const Choice = ({ name, title, values, asValue = (text) => text }) => html`
  <label class="field">${title}
    <select onChange=${(/** @type {{ target: HTMLSelectElement }} */ { target }) =>
      decide({ [name]: target.value ? asValue(target.value) : null })}>
      ${values.map(([value, words]) => html`
        <option key=${value} value=${value} selected=${value === String(choices.value[name] ?? "")}>${words}</option>
      `)}
    </select>
  </label>
`;

/** @param {{ name: NumberName, title: string, least: number, most: number }} props */
function NumberChoice({ name, title, least, most }) {
  const [wrong, setWrong] = useState("");
  const id = `reading-${name}`;
  /** @param {{ target: HTMLInputElement }} event */
  const onChange = ({ target }) => {
    const value = numberIn(target.value);
    const isValid = value === null || (value >= least && value <= most);
    setWrong(isValid ? "" : `A number from ${least} to ${most.toLocaleString("en")}.`);
    if (isValid) decide({ [name]: value });
  };
  return html`
    <div class="field">
      <label for=${id}>${title}</label>
      <input type="text" inputmode="decimal" id=${id} value=${choices.value[name] ?? ""} placeholder="as found"
        aria-invalid=${wrong ? "true" : undefined} aria-describedby=${wrong ? `${id}-wrong` : undefined}
        onChange=${onChange} />
      ${wrong && html`<span class="mistake" role="alert" id=${`${id}-wrong`}>${wrong}</span>`}
    </div>
  `;
}

/** The angles of joints that are written as "hip=0.3, knee=-1"; a text that is not so is told. @param {string} text */
export function anglesIn(text) {
  const assignments = text.split(/[,;]/).map((assignment) => assignment.trim()).filter(Boolean);
  return Object.fromEntries(assignments.map((assignment) => {
    const [joint, angle, ...more] = assignment.split("=").map((word) => word.trim());
    const value = Number((angle ?? "").replace("−", "-"));
    if (!joint || !angle || more.length || !Number.isFinite(value)) {
      throw new Error(`An angle is written as joint=radians, not “${assignment}”.`);
    }
    return [joint, value];
  }));
}

function Angles() {
  const [wrong, setWrong] = useState("");
  const text = Object.entries(choices.value.home_rad ?? {}).map(([joint, angle]) => `${joint}=${angle}`).join(", ");
  /** @param {{ target: HTMLInputElement }} event */
  const onChange = ({ target }) => {
    try {
      /** @type {ReadingChoices["home_rad"]} */
      const angles = anglesIn(target.value);
      setWrong("");
      decide({ home_rad: Object.keys(angles ?? {}).length ? angles : null });
    } catch (error) {
      setWrong(/** @type {Error} */ (error).message);
    }
  };
  return html`
    <div class="field wide">
      <label for="reading-angles">Angles when it stands, rad</label>
      <input type="text" id="reading-angles" value=${text} placeholder="joint=angle, …" onChange=${onChange}
        aria-invalid=${wrong ? "true" : undefined} aria-describedby=${wrong ? "reading-angles-wrong" : undefined} />
      ${wrong && html`<span class="mistake" role="alert" id="reading-angles-wrong">${wrong}</span>`}
    </div>
  `;
}

/** Arguments of a xacro, with their defaults. @param {{ defaults: Record<string, string> }} props */
const Arguments = ({ defaults }) => html`
  <h3>Arguments of the document</h3>
  <div class="reading-fields">
    ${Object.entries(defaults).map(([name, byDefault]) => html`
      <label class="field" key=${name}>${name}
        <input type="text" value=${choices.value.arguments?.[name] ?? ""} placeholder=${byDefault}
          onChange=${(/** @type {{ target: HTMLInputElement }} */ { target }) => {
            const { [name]: _, ...rest } = choices.peek().arguments ?? {};
            decide({ arguments: target.value ? { ...rest, [name]: target.value } : rest });
          }} />
      </label>
    `)}
  </div>
`;
