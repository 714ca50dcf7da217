// A robot that the class teaches, beside one that the reward teaches: their steps, the presses, and how far both walk.
import { useEffect, useRef, useState } from "preact/hooks";
import { getTable } from "../../api.js";
import { html } from "../../../../js/components/elements.js";
import { count, inLanguage, metres } from "../../../../js/format.js";
import { playback, position } from "../../../../js/player.js";
import { playhead } from "../../../../js/store.js";
import { rivalTeacher } from "../lane-names.js";
import { PressStrip } from "../press-strip.js";
import { room } from "../room.js";
import { countsOf, isTold, teaching } from "../teaching.js";

/** @import { Act, Facts } from "./index.js" */
/** @import { ActionValue, QTable, TeachingState } from "../../../../js/types.js" */

const TELL_MS = 400;
const MESSAGE = "hexapods:beside";

/** @param {Facts} facts */
function Teach({ classroom, isRevealed }) {
  const now = /** @type {TeachingState} */ (teaching.value);
  const by = rivalTeacher(classroom.shown.teach);
  const isRaced = isRevealed && now.race_id !== null;
  return html`
    ${isRaced
      ? html`<${Tables} now=${now} by=${by} />`
      : html`<${RivalRobot} run_id=${now.rival?.run_id ?? null} by=${by} />`}
    <section class="teach-strip" aria-label="What you press">
      <p class="press-key"><b class="plus">+</b><b class="minus">−</b></p>
      <${PressStrip} presses=${now.presses} first=${0} steps=${now.steps} />
      ${isTold.value ? html`<${Outcome} now=${now} by=${by} />` : html`<${Count} now=${now} />`}
    </section>
  `;
}

/** @param {{ now: TeachingState }} props */
function Count({ now }) {
  const { praised, rebuked } = countsOf(now.presses);
  const step = Math.min(now.steps, Math.floor(position.value / now.step_s) + 1);
  const words = now.state === "ended" ? "It has learned." : `Step ${step} of ${now.steps}.`;
  return html`
    <p class="teach-count" role="status">
      <b class="num">${praised}</b> praised, <b class="num">${rebuked}</b> rebuked. ${words}
      ${" "}Of all who press for a step, the mean teaches.
    </p>
  `;
}

/** What was taught, and how far it goes. @param {{ now: TeachingState, by: string }} props */
function Outcome({ now: { presses, taught, rival }, by }) {
  const { praised, rebuked } = countsOf(presses);
  const rows = [["you", taught?.distance_m ?? 0], [by, rival?.distance_m ?? 0]];
  const far = Math.max(0.01, ...rows.map(([, distance_m]) => Math.abs(Number(distance_m))));
  return html`
    <div class="teach-outcome">
      <dl>
        ${rows.map(([name, distance_m]) => html`
          <div key=${name}>
            <dt>Taught by ${name}</dt>
            <dd><i style=${{ width: `${(100 * Math.max(0, Number(distance_m))) / far}%` }}></i>
              <b class="num">${metres(Number(distance_m))}</b></dd>
          </div>
        `)}
      </dl>
      <p>You praised ${count(praised, "step")} and rebuked ${rebuked}: it never saw the reward.</p>
    </div>
  `;
}

/** The other robot, at the same moment of its practice. @param {{ run_id: string | null, by: string }} props */
function RivalRobot({ run_id, by }) {
  const frame = useRef(/** @type {HTMLIFrameElement | null} */ (null));
  const [address] = useState(() => inLanguage(`${room.peek()?.code}?beside`));
  useEffect(() => {
    if (run_id === null) return undefined;
    const tell = () => frame.current?.contentWindow?.postMessage({
      type: MESSAGE, run_id, time_s: position.peek(), rate: playhead.peek()?.rate || 1,
      isPlaying: playback.peek()?.playing ?? false, name: `Taught by ${by}`,
      typePx: parseFloat(getComputedStyle(document.documentElement).fontSize),
    }, globalThis.origin);
    const timer = setInterval(tell, TELL_MS);
    return () => clearInterval(timer);
  }, [run_id, by]);
  return html`
    <section class="rival-robot" aria-label="The other robot">
      <iframe ref=${frame} src=${address} title=${`The robot that ${by} teaches, in 3D`} tabindex="-1"></iframe>
    </section>
  `;
}

/** What both have learned. @param {{ now: TeachingState, by: string }} props */
const Tables = ({ now, by }) => html`
  <section class="rival-robot tables" aria-label="What they have learned">
    ${[[now.taught, "you"], [now.rival, by]].map(([robot, name]) => robot && html`
      <${Learned} key=${name} run_id=${/** @type {any} */ (robot).run_id} name=${name} />
    `)}
  </section>
`;

/** A table: a row for each state, a square for each step from there. @param {{ run_id: string, name: any }} props */
function Learned({ run_id, name }) {
  const [table, setTable] = useState(/** @type {QTable | null} */ (null));
  useEffect(() => { getTable(run_id).then(setTable, () => {}); }, [run_id]);
  const values = /** @type {ActionValue[]} */ (table?.values ?? []);
  const rows = new Map(/** @type {[string, ActionValue[]][]} */ ([]));
  for (const entry of values) rows.set(`${entry.state}`, [...rows.get(`${entry.state}`) ?? [], entry]);
  const most = Math.max(1e-9, ...values.map(({ value }) => Math.abs(value)));
  const wide = Math.max(1, ...[...rows.values()].map((row) => row.length));
  const liked = values.filter(({ value }) => value > 0).length;
  return html`
    <figure class="taught-table">
      <figcaption>Taught by ${name}</figcaption>
      <svg viewBox=${`0 0 ${wide} ${Math.max(1, rows.size)}`} role="img"
        aria-label=${`Table of the robot taught by ${name}: ${liked} steps liked`}>
        ${[...rows.values()].flatMap((row, y) => row.map(({ value, visits }, x) => visits > 0 && html`
          <rect class=${value > 0 ? "plus" : value < 0 ? "minus" : ""} width="0.88" height="0.88"
            x=${x + 0.06} y=${y + 0.06} fill-opacity=${0.2 + 0.8 * Math.abs(value) / most} />
        `))}
      </svg>
    </figure>
  `;
}

/** @type {Act} */
export const TEACH = {
  name: "teach",
  isOn: ({ classroom }) => Boolean(classroom.shown.teach) && (teaching.value?.state ?? "ready") !== "ready",
  Show: Teach,
};
