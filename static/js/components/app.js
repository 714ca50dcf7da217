// The page: header, the views, the first lesson, keyboard shortcuts, the help dialog and messages.
import { effect } from "@preact/signals";
import { useEffect, useRef, useState } from "preact/hooks";
import { primaryAction, runPrimaryAction, togglePause } from "../actions.js";
import { page } from "../page-state.js";
import {
  camera, clickedCell, closeLesson, helpIsOpen, isNarrow, keepInView, leavePresenter, lesson, nextTheme, openLesson,
  present, share, shortcuts, theme, toastMessage,
} from "../page.js";
import { announcement } from "../headline.js";
import { stepReplay } from "../replay.js";
import { isOperator } from "../selectors.js";
import { connection, isLockedOut, options, viewers } from "../store.js";
import { Controls } from "./controls.js";
import { Dialog, html, Icon, LazyPanel, Loaded, loaded } from "./elements.js";
import { ActionValues, LearningChart } from "./learning.js";
import { RaceChart, Scoreboard } from "./race.js";
import { Stage } from "./stage.js";
import { SharedChoices } from "./transport.js";
import { WhatIf } from "./what-if.js";

/** @import { FunctionComponent } from "preact" */
/** @import { Changed } from "../types.js" */

export const App = () => html`
  <a class="skip" href="#main" onClick=${focusMain}>Skip to the page</a>
  <${Header} />
  <main id="main" tabindex="-1"><${Main} /></main>
  <${HelpDialog} />
  <${Toast} />
  <p class="sr-only" role="status">${announcement}</p>
`;

function Main() {
  if (isLockedOut.value) return html`<${LockedOut} />`;
  if (options.value === null) return html`<${Loading} />`;
  return html`
    <${RaceView} isHidden=${page.view.value !== "race"} />
    ${page.view.value !== "race" && html`<${LoadedView} name=${page.view.value} key=${page.view.value} />`}
  `;
}

const LockedOut = () => html`
  <section class="panel locked">
    <h2>This page needs a link</h2>
    <p>This server shows the page only to those who have its link. Open that link once; the page remembers it.</p>
  </section>
`;

const Loading = () => html`
  <section class="panel locked">
    <p role="status"><span class="spinner" aria-hidden="true"></span> Loading gaits, robots, agents and settings…</p>
  </section>
`;

/** The hash names the view, so a link cannot move the focus by itself. @param {Event} event */
function focusMain(event) {
  event.preventDefault();
  document.getElementById("main")?.focus();
}

// ---- the race view

/**
 * Hidden, not removed, while another view is open, so that the stage does not load again.
 * @param {{ isHidden: boolean }} props
 */
const RaceView = ({ isHidden }) => html`
  <div class="race-view" hidden=${isHidden}>
    <${Stage} />
    ${isNarrow.value && isOperator.value && html`<div class="shared-choices"><${SharedChoices} /></div>`}
    <div class="side">
      ${isNarrow.value && html`<${Lesson} />`}
      <div class="work">
        <${Controls} />
        <${Scoreboard} />
      </div>
      <${WhatIf} />
    </div>
    <div class="below">
      ${!isNarrow.value && html`<${Lesson} />`}
      <${LearningChart} />
      <${RaceChart} />
      <${LazyPanel} title="Gait analysis" style="gait-analysis" load=${loadGait} />
      <${ActionValues} />
      <${StepsPanel} />
    </div>
    ${page.isPresenting.value && html`<${Loaded} name="address for others" load=${loadAudience} />`}
  </div>
`;

const loadAudience = () => import("./audience.js").then(({ Audience }) => Audience);
const loadGait = () => import("./gait.js").then(({ Gait }) => Gait);

// ---- the views that are loaded when they are first opened: most visits do not

/** @type {Record<string, () => Promise<FunctionComponent>>} */
const LOADERS = {
  experiments: () => import("./experiments/experiments.js").then(({ Experiments }) => Experiments),
  runs: () => import("./runs/runs.js").then(({ Runs }) => Runs),
  compare: () => import("./compare/compare.js").then(({ Compare }) => Compare),
};

/** @param {{ name: string }} props */
function LoadedView({ name }) {
  const shown = html`<${Loaded} name=${name} load=${LOADERS[name]} />`;
  return loaded.value[name] ? shown : html`<section class="panel locked">${shown}</section>`;
}

const loadSteps = () => import("./steps/steps.js").then(({ Steps }) => Steps);

function StepsPanel() {
  const panel = useRef(/** @type {HTMLElement | null} */ (null));
  const isOpen = page.isExplaining.value;
  useEffect(() => effect(() => {
    if (!clickedCell.value) return;
    page.isExplaining.value = true;
    if (panel.current) keepInView(panel.current, "start");
  }), []);
  return html`
    <section class="panel steps" aria-labelledby="steps-title" ref=${panel}>
      <div class="steps-head">
        <h2 id="steps-title">Step by step</h2>
        <p class="dim">Why it took each step, how its values changed, and its whole table</p>
        <button class="secondary compact" aria-expanded=${isOpen ? "true" : "false"}
          onClick=${() => (page.isExplaining.value = !isOpen)}>${isOpen ? "Close" : "Explain this step"}</button>
      </div>
      ${isOpen && html`<${Loaded} name="steps" load=${loadSteps} />`}
    </section>
  `;
}

// ---- a first lesson: open on the first visit until it is done or skipped, and again from the help

/** [title, words]; the last is for those who can start a run. */
const lessonSteps = () => [
  ["Moves", "In each step a robot puts one pair of its legs in another place. Some moves carry it forward, some " +
    "back, and some nowhere: it has to find an order of moves that walks."],
  ["Colours on the feet", "The squares below a learner’s feet are the places that a foot can go to. " +
    "Dark: the learner expects little from that move. Light: it expects much."],
  ["Trial and error", "At first it moves at random. After each step it measures how far that took it, and " +
    "corrects the value of that move in its table. The more it has practised, the more often it makes the best move."],
  ["First change", `Press “${primaryAction.value.label}” and watch. Then change one thing, the practice ` +
    "or the learning rate α, and race again. “What if?” tries the settings with thirty robots at once."],
];

function Lesson() {
  return lesson.value ? html`<${LessonCard} />` : null;
}

function LessonCard() {
  const [at, setAt] = useState(0);
  const card = useRef(/** @type {HTMLElement | null} */ (null));
  useEffect(() => {
    // After the dialog that opened it has given the focus back.
    if (lesson.peek() === "again") setTimeout(() => card.current?.focus());
  }, []);
  const all = isOperator.value ? lessonSteps() : lessonSteps().slice(0, -1);
  const [title, words] = all[at];
  const isLast = at === all.length - 1;
  const close = () => {
    closeLesson();
    document.getElementById("main")?.focus({ preventScroll: true });
  };
  return html`
    <section class="panel lesson" aria-labelledby="lesson-title" tabindex="-1" ref=${card}>
      <div class="lesson-head">
        <h2 id="lesson-title">A first lesson</h2>
        <span class="dim">${at + 1} of ${all.length}<span class="wide-only">, two minutes in all</span></span>
        <button class="quiet" onClick=${close}>Skip the lesson</button>
      </div>
      <p aria-live="polite"><b>${title}.</b> ${words}</p>
      <div class="row">
        <button class="secondary compact" disabled=${at === 0} onClick=${() => setAt(at - 1)}>Back</button>
        <button class="secondary compact" onClick=${isLast ? close : () => setAt(at + 1)}>
          ${isLast ? "Done" : "Next"}
        </button>
      </div>
    </section>
  `;
}

// ---- the header: navigation, connection state, sharing, theme and help

const VIEWS = [["race", "Race", "#"], ["experiments", "Experiments", "#experiments"], ["runs", "Runs", "#runs"]];

/** Runs are compared from their list. @param {string} name */
const currentOf = (name) => {
  if (page.view.value === "compare" && name === "runs") return "true";
  return page.view.value === name ? "page" : undefined;
};

const Header = () => html`
  <header class="header">
    <h1 class="brand"><img src="static/favicon.svg" alt="" width="24" height="24" />Racing Hexapods</h1>
    <nav class="nav" aria-label="Views">
      ${VIEWS.map(([name, title, href]) => html`
        <a href=${href} aria-current=${currentOf(name)}>${title}</a>
      `)}
    </nav>
    <${Connection} />
    <div class="switches">
      <button class="quiet" onClick=${share} title="Copy a link that opens the page as it is">
        <${Icon} name="link" /><span class="wide-only">Share</span>
        <span class="sr-only narrow-only">Share</span>
      </button>
      <button class="quiet wide-only" onClick=${present} title="Full screen and large type, for a class">
        <${Icon} name="present" />Present
      </button>
      <button class="quiet square" onClick=${nextTheme} title="Light, dark, or the system's theme"
        aria-label=${`Theme: ${theme.value}. Change it`}>
        <${Icon} name=${theme.value} />
      </button>
      <button class="quiet square" onClick=${toggleHelp}
        title="Keys and help" aria-label="Keys and help">?</button>
    </div>
  </header>
`;

function Connection() {
  // A page without access is not about to be connected.
  const state = isLockedOut.value ? "no access" : connection.value;
  const watching = viewers.value ? html` · ${viewers.value}<span class="roomy"> watching</span>` : "";
  return html`
    <p class=${`live ${state.replace(" ", "-")}`} role="group" aria-label="Connection">
      <span class="dot" aria-hidden="true"></span>
      <span>${state === "live" ? html`live${watching}` : state}</span>
    </p>
  `;
}

// ---- keyboard shortcuts, pressed on the page or forwarded by the stage's frame

/** [key, what it does] */
const KEYS = [
  ["Space", "pause and resume the training on stage, else the replay"],
  ["R", "press the main button: train and race"],
  ["1 – 8", "follow the robot in that lane"],
  ["0", "free the camera"],
  [", .", "in your own replay: one robot step back or on"],
  ["P", "present: full screen and large type, until Escape"],
  ["?", "show this list"],
];

/** Of a chart that has the focus. */
const CHART_KEYS = [
  ["← →", "read the values, in all charts over the same axis; or point, or touch"],
  ["Enter", "show that moment on stage, for those who may; or click"],
  ["+ −", "zoom in and out; or drag, or move two fingers"],
  ["0", "show all; or click twice"],
];

const TEXT = "input:not([type=range], [type=radio], [type=checkbox]), textarea, select, [contenteditable]";
const PRESSED_BY_SPACE = "button:not([aria-disabled=true]), a, summary, input:not([type=range])";

/**
 * Perform the action of a key; false if it has none.
 * @param {string} key
 */
function press(key) {
  // All but the help act on the race, which a reader of another view does not see.
  if (page.view.value !== "race" && key !== "?") return false;
  if (key === " ") togglePause();
  else if (key === "r" || key === "R") runPrimaryAction();
  else if (/^[1-8]$/.test(key)) camera.value = key;
  else if (key === "0") camera.value = "free";
  else if (page.run.value !== null && (key === "," || key === ".")) stepReplay(key === "." ? 1 : -1);
  else if (key === "p" || key === "P") (page.isPresenting.value ? leavePresenter : present)();
  else if (key === "?") toggleHelp();
  else return false;
  return true;
}

/** Open the help, or close it. The dialog itself is asked: it tells of its end only later. */
function toggleHelp() {
  const wasOpen = document.querySelector("#help[open]") !== null;
  helpIsOpen.value = false;
  helpIsOpen.value = !wasOpen;
}

/** Close the open menus in which a target is not. @param {EventTarget | null} target */
const closeOtherMenus = (target) => {
  for (const menu of document.querySelectorAll("details.menu[open]")) {
    if (!(target instanceof Node && menu.contains(target))) menu.removeAttribute("open");
  }
};

/** Close the open menu, and give the focus back to what opened it; false if there is none. */
function leaveMenu() {
  const menu = document.querySelector("details.menu[open]");
  if (!menu) return false;
  menu.removeAttribute("open");
  menu.querySelector("summary")?.focus();
  return true;
}

/** Menus close with Escape, and when a click or the focus goes elsewhere. */
export function listenForMenus() {
  addEventListener("keydown", (event) => {
    if (event.key === "Escape" && leaveMenu()) event.preventDefault();
  });
  for (const type of ["pointerdown", "focusin"]) addEventListener(type, ({ target }) => closeOtherMenus(target));
}

const leaveIfPresenting = () => page.isPresenting.value && leavePresenter();

export function listenForKeys() {
  addEventListener("keydown", (event) => {
    const { key, target, repeat } = event;
    // The dialog itself, since it tells of its end only later.
    const isInDialog = document.querySelector("dialog[open]") !== null;
    if (key === "Escape" && !event.defaultPrevented && !isInDialog) leaveIfPresenting();
    if (event.ctrlKey || event.altKey || event.metaKey || repeat || shortcuts.value === "off") return;
    const isIn = (/** @type {string} */ selector) => target instanceof Element && target.closest(selector);
    if (isIn(TEXT)) return;
    if (key === " " && isIn(PRESSED_BY_SPACE)) return;
    if (isInDialog && key !== "?") return;
    if (press(key)) event.preventDefault();
  });
  addEventListener("message", ({ origin, data }) => {
    if (origin !== location.origin || data?.type !== "hexapods:key") return;
    if (data.key === "Escape") leaveIfPresenting();
    else if (shortcuts.value === "on") press(data.key);
  });
}

// ---- the help dialog: keys, and what the page shows

const HelpDialog = () => html`
  <${Dialog} id="help" labelledBy="help-title" isOpen=${helpIsOpen}>
    <h2 id="help-title">Keys</h2>
    <dl class="keys">
      ${KEYS.map(([key, does]) => html`<div><dt><kbd>${key}</kbd></dt><dd>${does}</dd></div>`)}
    </dl>
    <label class="check">
      <input type="checkbox" checked=${shortcuts.value === "on"}
        onChange=${(/** @type {Changed} */ { target }) => (shortcuts.value = target.checked ? "on" : "off")} />
      Use single keys
    </label>
    <h2>Charts</h2>
    <dl class="keys">
      ${CHART_KEYS.map(([key, does]) => html`<div><dt><kbd>${key}</kbd></dt><dd>${does}</dd></div>`)}
    </dl>
    <h2>Learning and racing</h2>
    <p>
      A hexapod learns by trial and error: it moves two legs at a time, measures how far that took it, and
      keeps in a table what each move is worth. Then it races against two robots that simulate their moves
      before they make one: greedy looks one step ahead, two-step looks two. Thinking costs time. At time-out,
      when the first robot has used its steps, the one that is farthest wins. The red line is the finish line;
      a flag shows who crossed it.
    </p>
    <form method="dialog">
      <button type="button" class="secondary" onClick=${openLesson}>Show the first lesson</button>
      <button class="secondary" autofocus>Close</button>
    </form>
  <//>
`;

/** A message that disappears by itself. */
const Toast = () => html`
  <div class="toast" role="status">${toastMessage.value && html`<p>${toastMessage.value}</p>`}</div>
`;
