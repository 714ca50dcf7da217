// How much of the page is shown: its depths, its tabs, the pinned one, and what is hidden.
import assert from "node:assert/strict";
import { beforeEach, test } from "node:test";
import { install } from "../../static/js/features.js";
import { change, page, read, write } from "../../static/js/page-state.js";
import { isPhone, isWide } from "../../static/js/page.js";
import { applyEvent, options } from "../../static/js/store.js";
import {
  canPin, depth, DEPTH_KINDS, isAtLeast, isPanelHidden, nextDepth, openTab, pinnedTab, setDepth, tab, tabs, tabTitle,
  toggleHidden, togglePin,
} from "../../static/js/workspace.js";
import { EXAMPLE } from "./features.js";
import { makeRun, makeStage, OPTIONS } from "./options.js";

install([EXAMPLE]);

/** @param {string} search */
const open = (search) => read({ search, hash: "" });

const RUN = makeRun({});
const withARun = () => applyEvent("snapshot", { runs: [RUN], stage: makeStage({ run_id: RUN.id, phase: "ended" }) });

beforeEach(() => {
  options.value = OPTIONS;
  [isPhone.value, isWide.value] = [false, false];
  withARun();
  setDepth("watch");
  open("");
});

test("each depth shows more than the one before, and after the last comes the first", () => {
  assert.deepEqual([depth.value, tabs.value], ["watch", ["board"]]);
  nextDepth();
  assert.deepEqual([depth.value, tabs.value], ["try", ["board", "train", "world", "why"]]);
  nextDepth();
  assert.deepEqual([depth.value, tabs.value],
    ["study", ["board", "train", "world", "why", "gait", "table", "what-if"]]);
  assert.deepEqual(["watch", "try", "study"].map(isAtLeast), [true, true, true]);
  nextDepth();
  assert.equal(depth.value, "watch");
  assert.deepEqual(Object.values(DEPTH_KINDS).map(({ title }) => title), ["Watch", "Try", "Study"]);
});

test("a depth is kept by the browser, and that of a link comes before it", () => {
  setDepth("try");
  open("");
  assert.equal(depth.value, "try");
  open("?depth=study");
  assert.equal(depth.value, "study");
  open("");
  assert.equal(depth.value, "try");
});

test("a tab that is opened brings the depth that offers it; only the explanation needs none", () => {
  openTab("why");
  assert.deepEqual([depth.value, tab.value], ["watch", "why"]);
  openTab("world");
  assert.deepEqual([depth.value, tab.value], ["try", "world"]);
  open("?tab=what-if");
  assert.deepEqual([depth.value, tab.value], ["study", "what-if"]);
});

test("a depth that lacks the open tab shows the board, and keeps a tab that it has", () => {
  openTab("gait");
  setDepth("try");
  assert.deepEqual([depth.value, tab.value], ["try", "board"]);
  openTab("world");
  setDepth("study");
  assert.equal(tab.value, "world");
});

test("before the first run those who try prepare it, and those who watch see the lanes", () => {
  applyEvent("snapshot", { runs: [], stage: makeStage() });
  assert.equal(tab.value, "board");
  setDepth("try");
  assert.equal(tab.value, "train");
  openTab("board");
  assert.equal(tab.value, "board");
});

test("where there is room, a tab stays beside the one that is opened then", () => {
  setDepth("study");
  openTab("gait");
  assert.ok(!canPin.value);
  isWide.value = true;
  togglePin();
  assert.deepEqual([pinnedTab.value, tab.value], ["gait", "board"]);
  assert.equal(write(), "?depth=study&tab=board&pinned=gait");
  isWide.value = false;
  assert.equal(pinnedTab.value, null, "it is pinned again once there is room");
  isWide.value = true;
  openTab("gait");
  assert.deepEqual([pinnedTab.value, page.pinned.value], [null, null], "it is not shown twice");
  openTab("table");
  togglePin();
  togglePin();
  assert.equal(pinnedTab.value, null);
  openTab("what-if");
  togglePin();
  setDepth("try");
  assert.equal(page.pinned.value, null, "the depth does not offer it");
});

test("the panel is hidden until a tab is opened, but never on a phone", () => {
  toggleHidden("panel");
  assert.deepEqual([isPanelHidden.value, write()], [true, "?hidden=panel"]);
  isPhone.value = true;
  assert.ok(!isPanelHidden.value);
  isPhone.value = false;
  openTab("why");
  assert.ok(!isPanelHidden.value);
  change({ hidden: ["panel", "card"] });
  toggleHidden("panel");
  assert.deepEqual(page.hidden.value, ["card"]);
});

test("each tab has a title", () => {
  assert.deepEqual(["board", "what-if"].map(tabTitle), ["Board", "What if"]);
});
