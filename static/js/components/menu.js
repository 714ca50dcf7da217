// The menu of the page, in groups: what is seldom wanted, and on small screens the views.
import { useEffect, useRef } from "preact/hooks";
import { share } from "../actions.js";
import { menuRows, runRow } from "../features.js";
import { t } from "../format.js";
import { LANGUAGES, linkIn } from "../page-state.js";
import { nextTheme, theme } from "../page.js";
import { isOperator } from "../selectors.js";
import { isPanelHidden, toggleHidden } from "../workspace.js";
import { html, Icon } from "./elements.js";
import { toggleHelp } from "./keyboard.js";

/** @import { MenuRow } from "../types.js" */

/** The groups, from the top: their titles by their names. */
export const MENU_GROUPS = {
  views: t("Views"), share: t("Share"), class: t("With a class"), page: t("This page"), language: t("Language"),
  help: t("Help"),
};

/** @type {Record<string, string>} */
const THEME_TITLES = { auto: t("Theme: auto"), light: t("Theme: light"), dark: t("Theme: dark") };

/** Where a row is, if it is not everywhere: its class. */
const [PHONE, WIDE] = /** @type {const} */ (["phone-only", "wide-only"]);

/** A row of the menu. `stays`: it is pressed several times. @typedef {MenuRow & {
 *   feature?: string, where?: string, stays?: boolean,
 * }} ShownRow */

/** A view: its name, title and address. @typedef {string[]} ShownView */

/** The core's rows; views stand in the header where there is room. @type {(views: ShownView[]) => ShownRow[]} */
const coreRows = (views) => [
  ...views.map(([, title, href]) => ({ title, href, group: "views", where: PHONE })),
  { title: t("Copy a link to this"), icon: "link", group: "share", order: 0, run: share },
  {
    title: isPanelHidden.value ? t("Show the panel") : t("Hide the panel"), icon: "panel", group: "page", where: WIDE,
    run: () => toggleHidden("panel"),
  },
  { title: THEME_TITLES[theme.value], icon: theme.value, group: "page", run: nextTheme, stays: true },
  ...Object.entries(LANGUAGES).map(([code, title]) => ({ title, href: linkIn(code), group: "language" })),
  { title: t("Keys and help"), group: "help", order: 50, run: toggleHelp },
];

/** It is drawn while it is open. @param {{ views: ShownView[] }} props */
export function Menu({ views }) {
  const menu = useRef(/** @type {HTMLElement | null} */ (null));
  useEffect(() => { if (menu.current) itemsOf(menu.current)[0]?.focus(); }, []);
  const rows = [...coreRows(views), ...menuRows.value.filter((row) => !row.for || isOperator.value)]
    .sort((a, b) => (a.order ?? 0) - (b.order ?? 0));
  return html`
    <div role="menu" aria-label="Menu" ref=${menu} onKeyDown=${moveByKey}>
      ${Object.entries(MENU_GROUPS).map(([group, title]) => html`
        <${Group} key=${group} title=${title} rows=${rows.filter((row) => (row.group ?? "page") === group)} />
      `)}
    </div>
  `;
}

/** @param {{ title: string, rows: ShownRow[] }} props */
const Group = ({ title, rows }) => rows.length > 0 && html`
  <div class=${`menu-group ${rows.every(({ where }) => where === PHONE) ? PHONE : ""}`} role="group"
    aria-label=${title}>
    <span class="menu-title" aria-hidden="true">${title}</span>
    ${rows.map((row) => html`<${Row} row=${row} />`)}
  </div>
`;

/** @param {{ row: ShownRow }} props */
function Row({ row: { where = "", stays = false, ...row } }) {
  const title = typeof row.title === "function" ? row.title() : row.title;
  /** Close the menu, before what was chosen moves the focus. */
  const choose = (/** @type {Event & { currentTarget: HTMLElement }} */ { currentTarget }) => {
    if (!stays) currentTarget.closest("details")?.removeAttribute("open");
    if (!row.href) runRow({ feature: "", ...row });
  };
  const common = { role: "menuitem", tabIndex: -1, class: where, onClick: choose };
  return row.href
    ? html`<a ...${common} href=${row.href}>${title}</a>`
    : html`<button ...${common}>${row.icon && html`<${Icon} name=${row.icon} />`}${title}</button>`;
}

// ---- by keys: arrows, Home and End, and the letter with which an item begins

/** The items of a menu that can be seen, from the top. @param {HTMLElement} menu @returns {HTMLElement[]} */
const itemsOf = (menu) =>
  /** @type {HTMLElement[]} */ ([...menu.querySelectorAll("[role=menuitem]")]).filter((item) => item.offsetParent);

/** @param {KeyboardEvent & { currentTarget: HTMLElement }} event */
function moveByKey(event) {
  if (event.ctrlKey || event.altKey || event.metaKey) return;
  const items = itemsOf(event.currentTarget);
  const titles = items.map(({ textContent }) => textContent ?? "");
  const next = nextItem(titles, event.key, items.indexOf(/** @type {HTMLElement} */ (document.activeElement)));
  if (next === null) return;
  event.preventDefault();
  event.stopPropagation();
  items[next]?.focus();
}

/**
 * The number of the item to which a key moves, round the ends of the menu; null for other keys.
 * @param {string[]} titles
 * @param {string} key
 * @param {number} at the number of the item that has the focus, −1 without one
 */
export function nextItem(titles, key, at) {
  const { length } = titles;
  if (key === "Home") return 0;
  if (key === "End") return length - 1;
  if (key === "ArrowDown") return (at + 1) % length;
  if (key === "ArrowUp") return (Math.max(at, 0) - 1 + length) % length;
  if (key.length !== 1 || key === " ") return null;
  const after = titles.map((_, n) => (at + 1 + n) % length);
  return after.find((n) => titles[n].trim().toLowerCase().startsWith(key.toLowerCase())) ?? Math.max(at, 0);
}
