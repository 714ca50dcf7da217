// The help dialog: keys, what the page shows, and where to read on.
import { t } from "../format.js";
import { helpOfKeys, Slot } from "../features.js";
import { helpIsOpen, shortcuts } from "../page.js";
import { Dialog, html } from "./elements.js";
import { explainingTab } from "../workspace.js";

/** @import { Changed } from "../types.js" */

/** [key, what it does] */
const pageKeys = () => [
  [t("Space"), t("play and pause; the training on the stage too")],
  [", .", t("one robot step back or on, in your replay")],
  ["[ ]", t("to what happened before or next")],
  [t("Home End"), t("to the start, and to what is computed")],
  ...(explainingTab.value ? [["E", t("explain this step")]] : []),
  ["1 – 8", t("follow the robot in that lane; 0 frees the camera")],
  ["C", t("directed camera: all robots, as the race goes")],
  ["V", t("the same from another side")],
  ["← →", t("in the picture: turn it, with ↑ ↓ too; + − nearer and away")],
  ["L", t("the legs of the robot that is followed; arrows choose, Enter opens")],
  ["R", t("press the main button")],
  ["D", t("show more: Watch, Try, Study")],
  ["\\", t("hide the panel, or show it")],
  ...helpOfKeys(),
  ["?", t("show this list; Escape closes what is on top")],
];

/** Of a chart that has the focus. */
const CHART_KEYS = [
  ["← →", t("read the values, in all charts over the same axis; or point, or touch")],
  [t("Enter"), t("show that moment on the stage, for those who may; or click")],
  ["+ −", t("zoom in and out; or drag, or move two fingers")],
  ["0", t("show all; or click twice")],
];

/** @param {{ keys: string[][] }} props */
const Keys = ({ keys }) => html`
  <dl class="keys">
    ${keys.map(([key, does]) => html`<div><dt><kbd>${key}</kbd></dt><dd>${does}</dd></div>`)}
  </dl>
`;

export const HelpDialog = () => html`
  <${Dialog} id="help" labelledBy="help-title" isOpen=${helpIsOpen}>
    <h2 id="help-title" tabindex="-1" autofocus>Keys</h2>
    <${Keys} keys=${pageKeys()} />
    <label class="check">
      <input type="checkbox" checked=${shortcuts.value === "on"}
        onChange=${(/** @type {Changed} */ { target }) => (shortcuts.value = target.checked ? "on" : "off")} />
      Use single keys
    </label>
    <h2>Charts</h2>
    <${Keys} keys=${CHART_KEYS} />
    <h2>Learning and racing</h2>
    <p>
      A hexapod learns by trial and error: it moves two legs at a time, measures how far that took it, and
      keeps in a table what each move is worth. Then it races against two robots that simulate their moves
      before they make one: greedy looks one step ahead, two-step looks two. Thinking costs time. At time-out,
      when the first robot has used its steps, the one that is farthest wins. The chequered line is the
      finish line; who crossed it has a flag there, and the time in the label.
    </p>
    <${Reading} />
    <${Slot} name="sections of the help" />
    <form method="dialog">
      <${Slot} name="buttons of the help" />
      <button class="secondary">Close</button>
    </form>
  <//>
`;

const Reading = () => html`
  <h2>To read on</h2>
  <ul class="reading">
    <${Slot} name="reading" />
    <li><a href="docs">The REST API</a>, with every request and answer</li>
  </ul>
`;
