// A card on a participant's phone on which the class teaches: the robot, two buttons, and what the class presses.
import { useEffect } from "preact/hooks";
import { html } from "../../../js/components/elements.js";
import { metres, t } from "../../../js/format.js";
import { position } from "../../../js/player.js";
import { rivalTeacher } from "./lane-names.js";
import { Picture } from "./picture.js";
import { PressStrip } from "./press-strip.js";
import { room } from "./room.js";
import { isTold, newestPress, ownPresses, press, pressProblem, teaching } from "./teaching.js";

/** @import { TeachingState } from "../../../js/types.js" */

/** Steps of the strip. */
const STEPS = 16;
const SAID = {
  ready: t("Your teacher starts the robot. Then press for what you see."),
  teaching: t("Press for the step that you see. You count once a step; the mean of the class teaches."),
  frozen: t("The robot waits."),
  ended: t("The robot has learned from you."),
};
/** @type {Record<string, 1 | -1>} */
const KEYS = { "+": 1, "=": 1, "-": -1, "\u2212": -1, "_": -1 };

/** @type {[1 | -1, string, string][]} */
const SIGNS = [[-1, "\u2212", t("Minus: that was bad")], [1, "+", t("Plus: that was good")]];

const pressNow = (/** @type {1 | -1} */ value) => press(value, position.peek());

export function TeachOnPhone() {
  const now = teaching.value;
  const isOn = now?.state === "teaching";
  useEffect(() => {
    if (!isOn) return undefined;
    const onKey = (/** @type {KeyboardEvent} */ event) => {
      const value = KEYS[event.key];
      if (value === undefined || event.repeat || event.ctrlKey || event.metaKey || event.altKey) return;
      event.preventDefault();
      pressNow(value);
    };
    addEventListener("keydown", onKey);
    return () => removeEventListener("keydown", onKey);
  }, [isOn]);
  return html`
    <section class="own-robot teach" aria-label="The robot of the class">
      <${Picture} />
      ${now && now.state !== "ready" && html`<${Moments} now=${now} />`}
      <p class="teach-said" role="status">${now ? SAID[now.state] : t("The robot comes…")}
        ${now?.state === "ended" && !isTold.value && ` ${t("Look to the front.")}`}</p>
      ${pressProblem.value && isOn && html`<p class="teach-said bad" role="alert">${pressProblem}</p>`}
      ${now?.taught && isTold.value && html`<${Walks} now=${now} />`}
    </section>
    ${now?.state !== "ended" && html`<${Buttons} isOn=${isOn} />`}
  `;
}

/** What was pressed for the newest steps. @param {{ now: TeachingState }} props */
function Moments({ now }) {
  const first = Math.max(0, Math.floor(position.value / now.step_s) - STEPS + 1);
  return html`<${PressStrip} presses=${now.presses} own=${ownPresses.value} steps=${STEPS} first=${first} />`;
}

/** @param {{ isOn: boolean }} props */
const Buttons = ({ isOn }) => html`
  <div class="deeds teach-buttons" role="group" aria-label="Judge the step that you see">
    ${SIGNS.map(([value, sign, name]) => html`
      <button key=${value} class=${value > 0 ? "teach-plus" : "teach-minus"} aria-label=${name}
        aria-disabled=${isOn ? undefined : "true"} onClick=${() => isOn && pressNow(value)}>
        <span aria-hidden="true">${sign}</span>
        ${newestPress.value?.value === value && html`
          <i class="teach-flash" key=${newestPress.value.number} aria-hidden="true"></i>
        `}
      </button>
    `)}
  </div>
`;

/** How far both robots walk, after the reveal. @param {{ now: TeachingState }} props */
const Walks = ({ now }) => html`
  <div class="own-distance" role="status">
    <b class="num">${metres(now.taught?.distance_m ?? null)}</b>
    <span class="dim">${t("walks your robot in 50 steps; the one that {teacher} taught {distance}", {
      teacher: rivalTeacher(room.value?.shown.teach), distance: metres(now.rival?.distance_m ?? null),
    })}</span>
  </div>
`;
