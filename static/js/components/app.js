// The page: header, the views and messages.
import { t } from "../format.js";
import { announcement } from "../headline.js";
import { computed, effect } from "@preact/signals";
import { useEffect, useState } from "preact/hooks";
import {
  Loaded, loaded, loadPart, menuRows, Part, partsOf, runRow, Slot, wantedDialogs, withStyle,
} from "../features.js";
import { share } from "../actions.js";
import { page } from "../page-state.js";
import {
  clickedCell, helpIsOpen, isCardFolded, isPhone, isProjected, isStill, toastMessage,
} from "../page.js";
import { connection, isLockedOut, options, viewers } from "../store.js";
import { depth, DEPTH_KINDS, isAtLeast, isPanelHidden, openTab, setDepth } from "../workspace.js";
import { DropTarget } from "./dropping.js";
import { html, Icon } from "./elements.js";
import { Panel, replacement, ThumbTabs } from "./panel.js";
import { Stage } from "./stage.js";
import { TimeBar } from "./time-bar.js";

/** @import { FunctionComponent } from "preact" */
/** @import { Toggled } from "../types.js" */

export const App = () => html`
  <a class="skip" href="#main" onClick=${focusMain}>Skip to the page</a>
  <${Header} />
  <main id="main" tabindex="-1"><${Main} /></main>
  <${Help} />
  <${Dialogs} />
  <${Toast} />
  <${DropTarget} />
  <p class="sr-only" role="status">${announcement}</p>
`;

function Main() {
  if (isLockedOut.value) return html`<${LockedOut} />`;
  if (options.value === null) return html`<${Loading} />`;
  return html`
    <${Workspace} isHidden=${page.view.value !== "race"} />
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

// ---- the view of the race: the stage, its time, what features put below them, and the panel beside them

/**
 * Hidden, not removed, while another view is open, so that the stage does not load again.
 * @param {{ isHidden: boolean }} props
 */
function Workspace({ isHidden }) {
  useEffect(() => effect(() => {
    // A click on a foot grid is answered in the table of those who study.
    if (clickedCell.value && isAtLeast("study")) openTab("table");
  }), []);
  const states = { alone: isPanelHidden.value, still: isStill.value, "card-folded": isCardFolded.value };
  const names = Object.entries(states).flatMap(([name, isSo]) => (isSo ? [name] : [])).join(" ");
  return html`
    <div class=${`workspace ${names}`} hidden=${isHidden}>
      <${Stage} />
      ${!isStill.value && html`<${TimeBar} />`}
      ${isProjected.value && html`<${Slot} name="controls while projected" />`}
      ${!isProjected.value && !replacement.value && html`<${Slot} name="card" />`}
      <${Panel} />
      ${isPhone.value && !replacement.value && html`<${ThumbTabs} />`}
    </div>
  `;
}

const loadHelp = () => import("./help.js").then(({ HelpDialog }) => HelpDialog);

/** Loaded when it is first opened, and there since then. */
const Help = () => (helpIsOpen.value || loaded.value.help) && html`<${Loaded} name="help" load=${loadHelp} />`;

/** Of features, those that were wanted. */
const Dialogs = () => Object.entries(partsOf("dialogs"))
  .filter(([name]) => wantedDialogs.value.includes(name))
  .map(([name, part]) => html`<${Part} key=${name} part=${part} />`);

// ---- the views that are loaded when they are first opened: most visits do not

/** With the style that no other view needs. @type {Record<string, () => Promise<FunctionComponent>>} */
const LOADERS = {
  runs: () => withStyle("style/runs.css", import("./runs/runs.js")).then((module) => module.Runs),
  compare: () => withStyle("style/runs.css", import("./compare/compare.js")).then((module) => module.Compare),
};

/** @param {{ name: string }} props */
function LoadedView({ name }) {
  const shown = html`<${Loaded} name=${name} load=${LOADERS[name] ?? (() => loadPart(partsOf("views")[name]))} />`;
  return loaded.value[name] ? shown : html`<section class="panel locked">${shown}</section>`;
}

// ---- the header: navigation, depth, connection state, sharing and the menu

/** The views to which the header leads: [name, title, address]. */
const headerViews = computed(() => [
  ["race", t("Race"), "#"], ["runs", t("Runs"), "#runs"],
  ...Object.entries(partsOf("views")).filter(([, { isInHeader }]) => isInHeader)
    .map(([name, { title }]) => [name, title, `#${name}`]),
]);

/** Runs are compared from their list. @param {string} name */
const currentOf = (name) => {
  if (page.view.value === "compare" && name === "runs") return "true";
  return page.view.value === name ? "page" : undefined;
};

const Header = () => html`
  <header class="header">
    <h1 class="brand"><img src="static/favicon.svg" alt="" width="24" height="24" />Racing Hexapods</h1>
    <nav class="nav" aria-label="Views">
      ${headerViews.value.map(([name, title, href]) => html`
        <a href=${href} aria-current=${currentOf(name)}>${title}</a>
      `)}
    </nav>
    <span class="space"></span>
    ${page.view.value === "race" && options.value !== null && html`<${DepthChoice} />`}
    <${Connection} />
    ${isAtLeast("try") && html`
      <button class="quiet roomy" onClick=${share} title="Copy a link that opens the page as it is">
        <${Icon} name="link" />Share
      </button>
      ${menuRows.value.filter(({ headerHint }) => headerHint).map((row) => html`
        <button key=${row.order} class="quiet roomy" onClick=${() => runRow(row)} title=${row.headerHint}>
          ${row.icon && html`<${Icon} name=${row.icon} />`}${row.title}
        </button>
      `)}
    `}
    <${More} />
  </header>
`;

const DepthChoice = () => html`
  <div class="segments depth" role="group" aria-label="Depth">
    ${Object.entries(DEPTH_KINDS).map(([name, { title, about }]) => html`
      <button key=${name} aria-pressed=${depth.value === name ? "true" : "false"} title=${about}
        onClick=${() => setDepth(name)}>${title}</button>
    `)}
  </div>
`;

const loadMenu = () => import("./menu.js").then(({ Menu }) => Menu);

/** What is seldom wanted: loaded when it is first opened. */
function More() {
  // How often it was opened, or 0: it is drawn anew each time, also if it is closed and opened at once, of which
  // browsers tell by one event.
  const [opening, setOpening] = useState(0);
  const onToggle = (/** @type {Toggled} */ { target }) => setOpening((number) => (target.open ? number + 1 : 0));
  return html`
    <details class="menu more-menu" onToggle=${onToggle}>
      <summary class="quiet square" aria-label="More" aria-haspopup="menu" title="More">⋯</summary>
      ${opening > 0 && html`
        <div class="menu-body" key=${opening}>
          <${Loaded} name="menu" load=${loadMenu} views=${headerViews.value} />
        </div>
      `}
    </details>
  `;
}

/** @type {Record<string, string>} */
const CONNECTIONS = {
  "connecting": t("connecting"), "reconnecting": t("reconnecting"), "no access": t("no access"),
};

function Connection() {
  // A page without access is not about to be connected.
  const state = isLockedOut.value ? "no access" : connection.value;
  const watching = viewers.value ? html`${viewers.value}<span class="roomy"> watching</span>` : t("connected");
  return html`
    <p class=${`live ${state.replace(" ", "-")}`} role="group" aria-label="Connection">
      <span class="dot" aria-hidden="true"></span>
      ${state === "live"
        ? html`<span><span class="sr-only">connected, </span>${watching}</span>`
        // On a phone it would push the menu over the edge; what is lost is told where it is shown.
        : html`<span class=${isPhone.value && !isLockedOut.value ? "sr-only" : ""}>${CONNECTIONS[state]}</span>`}
    </p>
  `;
}

/** A message that disappears by itself. */
function Toast() {
  const { words, action } = toastMessage.value ?? {};
  return html`
    <div class="toast" role="status">
      ${words && html`
        <p>
          ${words}
          ${action && html`<button class="link" onClick=${() => { toastMessage.value = null; action.run(); }}>
            ${action.label}
          </button>`}
        </p>
      `}
    </div>
  `;
}
