// The panel beside the stage: who leads and why, the tabs, what the open tab shows, and what can be done.
import { computed } from "@preact/signals";
import { useEffect, useLayoutEffect, useRef, useState } from "preact/hooks";
import { t } from "../format.js";
import { Loaded, Part, partsOf, Slot } from "../features.js";
import { moveTold, narrative } from "../headline.js";
import { phase, shownRun } from "../on-stage.js";
import { page } from "../page-state.js";
import { isCardFolded, isFootOpen, isPhone, isProjected } from "../page.js";
import { isOperator } from "../selectors.js";
import { scale } from "../time.js";
import {
  canPin, explainingTab, isAtLeast, isPanelHidden, openExplanation, openTab, pinnedTab, tab, tabAbout, tabs, tabTitle,
  togglePin,
} from "../workspace.js";
import { Board } from "./board.js";
import { html, Icon } from "./elements.js";
import { FoldedFoot, Foot, OtherStarts } from "./foot.js";

/** @import { FunctionComponent } from "preact" */

/** What a feature shows in place of the panel, by a field of the page's state; undefined where none does. */
export const replacement = computed(() => Object.entries(partsOf("panels")).find(([field, part]) =>
  /** @type {any} */ (page)[field].value && (part.for !== "operator" || isOperator.value))?.[1]);

export function Panel() {
  if (isPanelHidden.value) return null;
  if (replacement.value) {
    return html`<aside class="panel-column" aria-label="Panel"><${Part} part=${replacement.value} /></aside>`;
  }
  return html`
    <aside class=${`panel-column ${pinnedTab.value ? "two" : ""}`} aria-label="Panel">
      <${Reason} />
      ${isAtLeast("try") && !isPhone.value && html`<${Tabs} />`}
      <${Body} name=${tab.value} key=${tab.value} />
      ${pinnedTab.value && html`<${Pinned} name=${pinnedTab.value} key=${`pinned ${pinnedTab.value}`} />`}
      <div class=${`foot ${isPhone.value && !isFootOpen.value ? "folded" : ""}`} id="panel-foot">
        ${isProjected.value ? html`<${Slot} name="foot of what is projected" />` : html`<${Foot} />`}
      </div>
    </aside>
  `;
}

// ---- how it stands, and why; in the tab that explains a step, the move

/** Three lines at most, whatever they say: what is below never moves. */
function Reason() {
  const isOfMove = isMoveTold();
  const { title, words, color } = isOfMove ? ofMove() : ofRun();
  return html`
    <header class="reason" aria-label=${isOfMove ? t("The move") : t("How it stands")}>
      <div class="says" title=${words && `${title}. ${words}`}>
        <h2 style=${{ "--agent": color }}>
          ${color !== "transparent" && html`<span class="swatch" aria-hidden="true"></span>`}${title}
        </h2>
        ${!isPhone.value && html`<p>${words}</p>`}
      </div>
      ${isPhone.value && html`<div class="starts"><${FoldedFoot} /></div>`}
      ${!isPhone.value && !isAtLeast("try") && html`<div class="ways"><${Ways} isOfMove=${isOfMove} /></div>`}
    </header>
  `;
}

const isMoveTold = () => tab.value === explainingTab.value;

/** What the head says below its title, which on a phone the open tab begins with. */
const ReasonOnPhone = () => html`<p class="reason-on-phone">${(isMoveTold() ? ofMove() : ofRun()).words}</p>`;

/** In Watch, which has no tabs: from the board to the explanation of a step, and back. */
/** @param {{ isOfMove: boolean }} props */
function Ways({ isOfMove }) {
  if (isOfMove) return html`<button class="link" onClick=${() => openTab("board")}>‹ Back to the board</button>`;
  return canExplain() && html`
    <button class="link" onClick=${openExplanation}>
      ${phase.value === "ended" ? t("Explain the last step") : t("Explain this step")}
    </button>
  `;
}

/** @returns {{ title: string, words: string | null, color: string }} */
function ofMove() {
  const { title = t("Explain this step"), reason: words = "", color = "transparent" } = moveTold.value ?? {};
  return { title, words, color };
}

/** @returns {{ title: string, words: string | null, color: string }} */
function ofRun() {
  const { headline: title, reason: words, color } = narrative.value;
  return { title, words, color };
}

const canExplain = () =>
  explainingTab.value !== null && Boolean(shownRun.value?.progress.done) && scale.value !== null;

// ---- the tabs

/** Arrow keys go from tab to tab, as in every list of tabs. @param {KeyboardEvent} event */
function moveByKey(event) {
  const names = tabs.value;
  const at = names.indexOf(tab.value);
  const next = { ArrowRight: at + 1, ArrowLeft: at - 1, Home: 0, End: names.length - 1 }[event.key];
  if (next === undefined) return;
  event.preventDefault();
  event.stopPropagation();
  const name = names[(next + names.length) % names.length];
  openTab(name);
  requestAnimationFrame(() => document.getElementById(`tab-${name}`)?.focus());
}

const Tabs = () => html`
  <div class="tabs">
    <div role="tablist" aria-label="Panel" onKeyDown=${moveByKey}>
      ${tabs.value.map((name) => html`<${Tab} key=${name} name=${name} />`)}
    </div>
    ${canPin.value && html`
      <button class="quiet square small pin" aria-pressed=${pinnedTab.value ? "true" : "false"} onClick=${togglePin}
        title=${pinnedTab.value ? t("One tab") : t("Two tabs beside each other")} aria-label="Pin this tab">
        <${Icon} name="pin" />
      </button>
    `}
  </div>
`;

/** @param {{ name: string }} props */
function Tab({ name }) {
  const isOpen = tab.value === name;
  const button = useRef(/** @type {HTMLElement | null} */ (null));
  // A row that is wider than the panel scrolls, and nothing around it.
  useEffect(() => {
    const row = button.current?.parentElement;
    if (!isOpen || !button.current || !row) return;
    const { offsetLeft, offsetWidth } = button.current;
    row.scrollLeft = Math.max(offsetLeft + offsetWidth - row.clientWidth, Math.min(row.scrollLeft, offsetLeft));
  }, [isOpen]);
  return html`
    <button ref=${button} id=${`tab-${name}`} role="tab" aria-selected=${isOpen ? "true" : "false"}
      tabindex=${isOpen ? "0" : "-1"} aria-controls=${isOpen ? "panel-body" : undefined} title=${tabAbout(name)}
      onClick=${() => openTab(name)}>
      ${tabTitle(name)}
    </button>
  `;
}

/**
 * On a phone the tabs are at the thumb: those of its depth, and of who watches the two that explain; before them what
 * folds the card below the stage, where there is one.
 */
export function ThumbTabs() {
  const names = isAtLeast("try") ? tabs.value : ["board", ...(explainingTab.value ? [explainingTab.value] : [])];
  const fold = () => (isCardFolded.value = !isCardFolded.value);
  return html`
    <div class="thumb-bar">
      <button class="card-fold" aria-expanded=${isCardFolded.value ? "false" : "true"} onClick=${fold}>Card</button>
      <div class="thumb-tabs" role="tablist" aria-label="Panel" onKeyDown=${moveByKey}
        onClick=${() => (isCardFolded.value = true)}>
        ${names.map((name) => html`<${Tab} key=${name} name=${name} />`)}
      </div>
    </div>
  `;
}

// ---- what the open tab shows

const loadTrain = () => import("./train-tab.js").then(({ TrainTab }) => TrainTab);
const loadWorld = () => import("./world-tab.js").then(({ WorldTab }) => WorldTab);

/** The tabs that are always there. @type {Record<string, FunctionComponent>} */
const CONTENTS = {
  board: Board,
  train: () => html`<${Loaded} name="training settings" load=${loadTrain} />`,
  world: () => html`<${Loaded} name="world" load=${loadWorld} />`,
};

/** What a tab shows. @param {{ name: string }} props */
const Contents = ({ name }) =>
  (name in CONTENTS ? html`<${CONTENTS[name]} />` : html`<${Part} part=${partsOf("tabs")[name]} />`);

/** @param {{ name: string }} props */
function Body({ name }) {
  const hasTabs = isAtLeast("try") || isPhone.value;
  const body = useRef(/** @type {HTMLElement | null} */ (null));
  const { isScrollable, follows } = useScrolling(body);
  const attributes = hasTabs
    ? { "role": "tabpanel", "aria-labelledby": `tab-${name}` }
    : { "role": "region", "aria-label": tabTitle(name) };
  return html`
    <div class=${`body ${follows ? "follows" : ""}`} id="panel-body" ref=${body}
      tabindex=${isScrollable ? 0 : undefined} ...${attributes}>
      ${isPhone.value && html`<${ReasonOnPhone} />`}
      <${Contents} name=${name} />
      ${isPhone.value && name === "train" && html`<${OtherStarts} />`}
    </div>
  `;
}

/** The tab that is pinned beside the open one. @param {{ name: string }} props */
const Pinned = ({ name }) => html`
  <section class="pinned" aria-label=${t("Pinned: {tab}", { tab: tabTitle(name) })} tabindex="0">
    <div class="pinned-head">
      <h2>${tabTitle(name)}</h2>
      <button class="quiet square small" aria-label=${t("Unpin {tab}", { tab: tabTitle(name) })}
        onClick=${togglePin}>✕</button>
    </div>
    <${Contents} name=${name} />
  </section>
`;

/** Less than this of it is no more to read. */
const FOLLOWS_PX = 8;

/**
 * Whether an element can be scrolled, by keys too then, and whether more of it follows below. What it has grows without
 * a change of its own size: its children are measured as well.
 * @param {{ current: HTMLElement | null }} host
 */
function useScrolling(host) {
  const [left, setLeft] = useState({ isScrollable: false, follows: false });
  const measure = () => {
    const { scrollTop = 0, clientHeight = 0, scrollHeight = 0 } = host.current ?? {};
    const [isScrollable, follows] = [0, scrollTop + FOLLOWS_PX].map((above) => scrollHeight - clientHeight > above);
    setLeft((before) => (before.isScrollable === isScrollable && before.follows === follows
      ? before : { isScrollable, follows }));
  };
  useLayoutEffect(measure);
  useEffect(() => {
    const element = /** @type {HTMLElement} */ (host.current);
    const sizes = new ResizeObserver(measure);
    const observe = () => {
      sizes.disconnect();
      for (const each of [element, ...element.children]) sizes.observe(each);
    };
    const children = new MutationObserver(observe);
    observe();
    children.observe(element, { childList: true });
    element.addEventListener("scroll", measure, { passive: true });
    return () => {
      sizes.disconnect();
      children.disconnect();
    };
  }, []);
  return left;
}
