// The workspace around the stage: its depths and tabs, and the panel. What a depth leaves out is hidden, not undone.
import { computed, effect } from "@preact/signals";
import { t } from "./format.js";
import { chartDepth } from "./chart.js";
import { features, partsOf } from "./features.js";
import { phase } from "./on-stage.js";
import { change, DEPTHS, page } from "./page-state.js";
import { isPhone, isWide, storedText } from "./page.js";

/** "watch", "try" or "study". @typedef {string} Depth */
/** @import { TabKind } from "./types.js" */

/** The tabs that are always there. @type {Record<string, TabKind>} */
const OWN_KINDS = {
  board: { title: t("Board"), depth: "watch", order: 10, about: t("Ranks, distances and times") },
  train: { title: t("Train"), depth: "try", order: 20, about: t("The next training and race") },
  world: { title: t("World"), depth: "try", order: 30, about: t("The ground, and what happens to the robots") },
};

/** Tab → its kind, in the order of the panel. */
const kinds = computed(() => /** @type {Record<string, TabKind>} */ (Object.fromEntries(
  Object.entries({ ...OWN_KINDS, ...partsOf("tabs") }).sort(([, a], [, b]) => a.order - b.order))));

/** The names of all tabs, in their order. */
export const allTabs = computed(() => Object.keys(kinds.value));

/** Depth → its title, and what it shows. @type {Record<Depth, { title: string, about: string }>} */
export const DEPTH_KINDS = {
  watch: { title: t("Watch"), about: t("The race, who leads, and why") },
  try: { title: t("Try"), about: t("Change one thing, and see what it does") },
  study: { title: t("Study"), about: t("Every setting, figure and table") },
};

const FIRST_TAB = "board";

const keptDepth = storedText("depth", DEPTHS[0]);

/** @param {Depth} name */
const rankOf = (name) => DEPTHS.indexOf(name);

/** The name of a tab that is there: a link, a card or a key may name one whose feature is left out. */
/** @type {(name: string | null) => string | null} */
const existing = (name) => (name !== null && name in kinds.value ? name : null);

/** Whether a feature hides a tab at present. @param {string} name */
const isHidden = (name) => features.value.some(({ hidesTab }) => hidesTab?.(name));

/** The tab that explains a step, which Watch shows, too; null without one, and while a feature hides it. */
export const explainingTab = computed(() =>
  allTabs.value.find((name) => kinds.value[name].isInWatch && (name === page.tab.value || !isHidden(name))) ?? null);

/** The least depth that shows a tab. @param {string} tab */
const neededFor = (tab) => (kinds.value[tab].isInWatch ? DEPTHS[0] : kinds.value[tab].depth);

const chosenDepth = computed(() =>
  page.depth.value ?? (DEPTHS.includes(keptDepth.value) ? keptDepth.value : DEPTHS[0]));

/** How much of the page is shown: what the link says, or the browser has kept; as much as the open tab needs. */
export const depth = computed(() => {
  const needed = [page.tab.value, page.pinned.value].map(existing)
    .map((name) => (name === null ? DEPTHS[0] : neededFor(name)));
  return [chosenDepth.value, ...needed].reduce((most, name) => (rankOf(name) > rankOf(most) ? name : most));
});

/** Keep charts at the depth of the workspace; outside the view of the race they offer all. */
export const followChartDepth = () => effect(() => {
  chartDepth.value = page.view.value === "race" ? depth.value : "study";
});

/** Whether at least so much is shown. @param {Depth} name */
export const isAtLeast = (name) => rankOf(depth.value) >= rankOf(name);

/** The tabs that the present depth offers, by name, and no feature hides. */
export const tabs = computed(() => (isAtLeast("try")
  ? allTabs.value.filter((name) => isAtLeast(kinds.value[name].depth) && (name === page.tab.value || !isHidden(name)))
  : [FIRST_TAB]));

/** @param {string} tab */
export const tabTitle = (tab) => kinds.value[tab].title;
/** @param {string} tab */
export const tabAbout = (tab) => kinds.value[tab].about;

/** The open tab: before the first run of those who try, the one in which it is set. */
export const tab = computed(() =>
  existing(page.tab.value) ?? (isAtLeast("try") && phase.value === "empty" ? "train" : FIRST_TAB));

/** Whether a second tab can be pinned beside the first. */
export const canPin = computed(() => isWide.value && isAtLeast("study"));
/** The pinned tab, where there is room for it. */
export const pinnedTab = computed(() =>
  (canPin.value && page.pinned.value !== tab.value ? existing(page.pinned.value) : null));

/** Open a tab of the panel, in the depth that offers it. @param {string} name */
export const openTab = (name) => {
  if (existing(name) === null) return;
  change({
    tab: name, hidden: page.hidden.peek().filter((field) => field !== "panel"),
    // The tab that was pinned is the open one now.
    ...(page.pinned.peek() === name ? { pinned: null } : {}),
  });
};

/** Open the tab that explains a step, where there is one. */
export const openExplanation = () => {
  if (explainingTab.peek() !== null) openTab(/** @type {string} */ (explainingTab.peek()));
};

/** Pin the open tab, and open another beside it; or let the pinned one go. */
export const togglePin = () => {
  const pinned = page.pinned.peek();
  if (pinned !== null) change({ pinned: null });
  else change({ pinned: tab.peek(), tab: tabs.peek().find((other) => other !== tab.peek()) ?? null });
};

/**
 * Choose a depth, which this browser keeps; a tab that it does not offer gives way to the board.
 * @param {Depth} level
 */
export function setDepth(level) {
  keptDepth.value = level;
  const isOffered = (/** @type {string | null} */ name) =>
    name === null || rankOf(kinds.value[name]?.depth ?? DEPTHS[0]) <= rankOf(level);
  change({
    depth: level,
    tab: isOffered(page.tab.peek()) ? page.tab.peek() : null,
    pinned: isOffered(page.pinned.peek()) ? page.pinned.peek() : null,
  });
}

/** Go on to the next depth, and from the last to the first. */
export const nextDepth = () => setDepth(DEPTHS[(rankOf(depth.peek()) + 1) % DEPTHS.length]);

/** Whether the panel is hidden; on a phone it is below the stage, and never is. */
export const isPanelHidden = computed(() => page.hidden.value.includes("panel") && !isPhone.value);

/** Hide a part of the page, or show it again. @param {string} part */
export const toggleHidden = (part) => {
  const hidden = page.hidden.peek();
  page.hidden.value = hidden.includes(part) ? hidden.filter((other) => other !== part) : [...hidden, part];
};
