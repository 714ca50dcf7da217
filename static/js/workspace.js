// The workspace around the stage: its depths and tabs, and the panel. What a depth leaves out is hidden, not undone.
import { computed } from "@preact/signals";
import { isShown } from "./lesson.js";
import { phase } from "./on-stage.js";
import { change, DEPTHS, page, TABS } from "./page-state.js";
import { isPhone, isWide, storedText } from "./page.js";

/** "watch", "try" or "study". @typedef {string} Depth */
/** @typedef {{ title: string, depth: Depth, about: string }} TabKind */

/** Tab → its title, the least depth that offers it, and what it is for. @type {Record<string, TabKind>} */
const KINDS = {
  "board": { title: "Board", depth: "watch", about: "Ranks, distances and times" },
  "train": { title: "Train", depth: "try", about: "The next training and race" },
  "world": { title: "World", depth: "try", about: "The ground, and what happens to the robots" },
  "why": { title: "Why", depth: "try", about: "Each step, explained" },
  "gait": { title: "Gait", depth: "study", about: "When each foot is on the ground" },
  "table": { title: "Table", depth: "study", about: "The values of every state" },
  "what-if": { title: "What if", depth: "study", about: "Thirty ideal robots, at once" },
};

/** Depth → its title, and what it shows. @type {Record<Depth, { title: string, about: string }>} */
export const DEPTH_KINDS = {
  watch: { title: "Watch", about: "The race, who leads, and why" },
  try: { title: "Try", about: "Change one thing, and see what it does" },
  study: { title: "Study", about: "Every setting, figure and table" },
};

/** A tab that a shallower depth shows too, with a way back. */
const SHOWN_IN_WATCH = "why";

const keptDepth = storedText("depth", DEPTHS[0]);

/** @param {Depth} one */
const rankOf = (one) => DEPTHS.indexOf(one);

/** The least depth that shows a tab. @param {string} tab */
const neededFor = (tab) => (tab === SHOWN_IN_WATCH ? DEPTHS[0] : KINDS[tab].depth);

const chosenDepth = computed(() =>
  page.depth.value ?? (DEPTHS.includes(keptDepth.value) ? keptDepth.value : DEPTHS[0]));

/** How much of the page is shown: what the link says, or the browser has kept; as much as the open tab needs. */
export const depth = computed(() => {
  const needed = [page.tab.value, page.pinned.value].map((one) => (one === null ? DEPTHS[0] : neededFor(one)));
  return [chosenDepth.value, ...needed].reduce((most, one) => (rankOf(one) > rankOf(most) ? one : most));
});

/** Whether at least so much is shown. @param {Depth} one */
export const isAtLeast = (one) => rankOf(depth.value) >= rankOf(one);

/** The tabs that the present depth offers, by name, and the card of a lesson does not hide. */
export const tabs = computed(() => (isAtLeast("try")
  ? TABS.filter((one) => isAtLeast(KINDS[one].depth) && (isShown(one) || one === page.tab.value)) : [TABS[0]]));

/** @param {string} tab */
export const tabTitle = (tab) => KINDS[tab].title;
/** @param {string} tab */
export const tabAbout = (tab) => KINDS[tab].about;

/** The open tab: before the first run of those who try, the one in which it is set. */
export const tab = computed(() =>
  page.tab.value ?? (isAtLeast("try") && phase.value === "empty" ? "train" : TABS[0]));

/** Whether a second tab can be pinned beside the first. */
export const canPin = computed(() => isWide.value && isAtLeast("study"));
/** The pinned tab, where there is room for it. */
export const pinnedTab = computed(() =>
  (canPin.value && page.pinned.value !== tab.value ? page.pinned.value : null));

/** Open a tab of the panel, in the depth that offers it. @param {string} name */
export const openTab = (name) => change({
  tab: name, hidden: page.hidden.peek().filter((one) => one !== "panel"),
  // The tab that was pinned is the open one now.
  ...(page.pinned.peek() === name ? { pinned: null } : {}),
});

/** Pin the open tab, and open another beside it; or let the pinned one go. */
export const togglePin = () => {
  const pinned = page.pinned.peek();
  if (pinned !== null) change({ pinned: null });
  else change({ pinned: tab.peek(), tab: tabs.peek().find((one) => one !== tab.peek()) ?? null });
};

/** Choose a depth, which this browser keeps; a tab that it does not offer gives way to the board. @param {Depth} one */
export function setDepth(one) {
  keptDepth.value = one;
  const isOffered = (/** @type {string | null} */ name) => name === null || rankOf(KINDS[name].depth) <= rankOf(one);
  change({
    depth: one,
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
  page.hidden.value = hidden.includes(part) ? hidden.filter((one) => one !== part) : [...hidden, part];
};
