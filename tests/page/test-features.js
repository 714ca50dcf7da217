// The seam between the page and its features: what one adds, what is missing without it, and that the core names none.
import assert from "node:assert/strict";
import { existsSync, readdirSync, readFileSync } from "node:fs";
import { test } from "node:test";
import {
  actionOfKey, features, fillersOf, hasFeature, helpOfKeys, imported, install, menuRows, Part, partsOf,
} from "../../static/js/features.js";
import { MENU_GROUPS } from "../../static/js/components/menu.js";
import { change, ignored, page, read } from "../../static/js/page-state.js";
import { applyEvent, eventNames } from "../../static/js/store.js";
import { allTabs, depth, openTab, pinnedTab, setDepth, tab } from "../../static/js/workspace.js";
import { ALL, EXAMPLE, FOLDER } from "./features.js";

const CORE = new URL("../../static/js/", import.meta.url);
const NAMES = ALL.map(({ name }) => name);
/** Features that are not yet behind the seam. */
const NOT_YET = /** @type {string[]} */ ([]);

/** The scripts below a folder, with their texts. @param {URL} folder */
const scriptsIn = (folder) => readdirSync(folder, { recursive: true, encoding: "utf-8" })
  .filter((path) => path.endsWith(".js"))
  .map((path) => ({ path, at: new URL(path, folder), text: readFileSync(new URL(path, folder), "utf-8") }));

/** What a script imports, at once or later, as whole addresses. @param {{ at: URL, text: string }} script */
const importsOf = ({ at, text }) =>
  [...text.matchAll(/(?:from |import |import\()"(\.[^"]+)"/g)].map(([, path]) => new URL(path, at).href);

/** The feature in whose folder an address is; null outside of all. @param {string} href */
const featureOf = (href) =>
  (href.startsWith(FOLDER.href) ? href.slice(FOLDER.href.length).split("/")[0] : null);

test("no module of the core imports one of a feature", () => {
  const guilty = scriptsIn(CORE).filter((script) => importsOf(script).some(featureOf));
  assert.deepEqual(guilty.map(({ path }) => path), []);
});

test("a feature imports modules of those features alone that it needs, or names as used", () => {
  for (const { name, needs = [], uses = [] } of ALL) {
    const used = scriptsIn(new URL(`${name}/`, FOLDER)).flatMap(importsOf).map(featureOf);
    const undeclared = used.filter((other) => other !== null && ![name, ...needs, ...uses].includes(other));
    assert.deepEqual(undeclared, [], name);
  }
});

test("what is only used is loaded later, so that it may be missing", () => {
  for (const { name, uses = [] } of ALL) {
    for (const { path, at, text } of scriptsIn(new URL(`${name}/`, FOLDER))) {
      const atOnce = [...text.matchAll(/^import [^"]*"(\.[^"]+)"/gm)].map(([, target]) => new URL(target, at).href);
      assert.deepEqual(atOnce.map(featureOf).filter((other) => other !== null && uses.includes(other)), [], path);
    }
  }
});

/** The words of a feature, where its name alone would not tell it. @type {Record<string, RegExp>} */
const WORDS = {
  classroom: /classroom|lesson|pupil|teacher/i,
  tournaments: /tournament/i,
  demo: /\bdemos?\b|visitor/i,
  experiments: /(?<!guide\/)experiment/i,
  gait_analysis: /gait.analysis/i,
  guide: /guide\//,
  run_code: /as code|showCode/i,
  presenter: /presenter|presentation|isPresenting|isRemote|\bremote\b/i,
  archives: /archive_|archive of|\.zip|import(Runs|Files|Table)|runs\/(im|ex)port/i,
  exports: /served\(\)\.exports|ExportOption|MP4/,
  robots: /body.?editor|your robots|edit.?(the.)?body|robotsAreOpen/i,
};

test("no module of the core names a feature", () => {
  for (const name of Object.keys(WORDS).filter((feature) => !NOT_YET.includes(feature))) {
    const guilty = scriptsIn(CORE).flatMap(({ path, text }) => text.split("\n")
      .flatMap((line, n) => (WORDS[name].test(line) ? [`${path}:${n + 1}: ${line.trim()}`] : [])));
    assert.deepEqual(guilty, [], name);
  }
});

test("what a feature declares is there", async () => {
  for (const { name, needs = [], menu = [], runMenu = [], keys = {}, whenSet = {}, ...feature } of ALL) {
    const { tabs = {}, views = {}, dialogs = {}, panels = {}, slots = {} } = feature;
    assert.deepEqual(needs.filter((other) => !NAMES.includes(other)), [], name);
    const parts = [tabs, views, dialogs, panels, slots].flatMap((kind) => Object.values(kind));
    const shown = parts.flatMap((part) => ("show" in part ? [part.show] : []));
    for (const { group = "page" } of menu) assert.ok(group in MENU_GROUPS, `${name}: ${group}`);
    const called = [...menu, ...runMenu, ...Object.values(keys)].flatMap(({ call }) => call ?? []);
    for (const source of [...shown, ...called, ...Object.values(whenSet)]) {
      assert.equal(typeof await imported(name, source), "function", `${name}: ${source}`);
    }
    const styles = parts.flatMap((part) => ("style" in part && part.style ? [part.style] : []));
    assert.deepEqual(styles.filter((style) => !existsSync(new URL(`${name}/${style}`, FOLDER))), [], name);
  }
});

test("a feature adds tabs, views, fields, places and events; one that needs a missing one is left out", () => {
  assert.deepEqual([allTabs.value, hasFeature("example")], [["board", "train", "world"], false]);
  read({ search: "?tab=gait&page=3", hash: "" });
  assert.deepEqual(ignored.query.value, ["tab=gait (valid: board, train, world)"], "as a link of another server");
  assert.equal("page_number" in page, false);

  const heard = /** @type {number[]} */ ([]);
  const Filler = () => null;
  install([
    {
      ...EXAMPLE, menu: [{ title: "B", order: 2 }, { title: "A", order: 1 }], slots: { card: { component: Filler } },
      events: { example: ({ value }) => heard.push(value) },
    },
    { name: "dependent", needs: ["missing"], hideable: ["late"] },
    { name: "second", needs: ["dependent"] },
  ]);
  assert.deepEqual(features.value.map(({ name }) => name), ["example"]);
  assert.deepEqual(allTabs.value, ["board", "train", "world", "why", "gait", "table", "what-if"]);
  assert.deepEqual(Object.keys(partsOf("views")), ["experiments", "lessons"]);
  assert.deepEqual(menuRows.value.map(({ title, feature }) => [title, feature]), [["A", "example"], ["B", "example"]]);
  assert.deepEqual([fillersOf("card"), fillersOf("none")], [[{ component: Filler, feature: "example" }], []]);
  read({ search: "?tab=gait&page=3", hash: "#lessons" });
  const fields = /** @type {any} */ (page);
  assert.deepEqual([fields.tab.value, fields.view.value, fields.page_number.value], ["gait", "lessons", 3]);
  assert.ok(eventNames().includes("example"));
  applyEvent("example", { value: 7 });
  assert.deepEqual(heard, [7]);
});

test("parts with the same words while they load are kept apart", () => {
  const parts = ["left", "right"].map((feature) => ({ feature, show: "part.js#Part", loading: "part" }));
  const [left, right] = parts.map((part) => /** @type {any} */ (Part({ part })).props);
  assert.equal(left.name, right.name);
  assert.notEqual(left.source, right.source);
});

test("a key of a feature acts while a field of the page's state is set, and the help lists it", () => {
  const before = features.value;
  const call = "none.js#none";
  features.value = [{ ...EXAMPLE, keys: { x: { call, does: "cross out" }, y: { call, while: "is_lit" } } }];
  const acting = () => ["x", "y", "z"].filter((key) => actionOfKey(key));
  assert.deepEqual([acting(), helpOfKeys()], [["x"], [["X", "cross out"]]]);
  change(/** @type {object} */ ({ is_lit: true }));
  assert.deepEqual(acting(), ["x", "y"]);
  change(/** @type {object} */ ({ is_lit: false }));
  features.value = before;
});

test("a tab whose feature is left out is none, whoever names it", () => {
  change({ tab: "missing", pinned: "missing" });
  assert.deepEqual([tab.value, pinnedTab.value, depth.value], ["board", null, "watch"], "as a card of a lesson may");
  openTab("missing");
  setDepth("try");
  assert.deepEqual([tab.value, depth.value], ["train", "try"]);
  change({ tab: null, pinned: null });
});
