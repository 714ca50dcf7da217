// The page's state: the link that carries it, what "back" restores, and what a link says in vain.
import assert from "node:assert/strict";
import { beforeEach, test } from "node:test";
import {
  addressOf, change, changeIfStillHere, followHistory, ignored, linkTo, page, read, write,
} from "../../static/js/page-state.js";
import { install } from "../../static/js/features.js";
import { EXAMPLE } from "./features.js";
import { entries, follow, goBack, visit } from "./browser.js";

visit("/?alpha=0.5&run=opened&t=1.5#runs?kind=race");
entries.splice(0, 1, "/?alpha=0.5&run=opened&t=1.5#runs?kind=race");
install([EXAMPLE]);
followHistory();
const opened = { run: page.run.value, moment: page.moment.value, view: page.view.value, link: linkTo() };

/** The whole document, in plain types. */
const document = () =>
  Object.fromEntries(Object.entries(page).map(([name, { value }]) =>
    [name, value instanceof URLSearchParams ? String(value) : value]));

/** @param {string} address */
const open = (address) => {
  const { search, hash } = new URL(address, "http://page.test");
  read({ search, hash });
};

beforeEach(() => {
  for (const view of ["experiments", "runs", "compare"]) open(`/#${view}?none`);
  change(/** @type {object} */ ({
    experiment: new URLSearchParams(), list: new URLSearchParams(), compared: [], report: null,
  }));
  open("/");
  ignored.query.value = [];
  entries.splice(0, entries.length, "/");
});

test("the address that was opened is read first, and stays one entry of the history", () => {
  assert.deepEqual(opened, {
    run: "opened", moment: 1.5, view: "runs", link: "http://page.test/?alpha=0.5&run=opened&t=1.50#runs?kind=race",
  });
});

test("a link is read as the state that wrote it, each field of it", () => {
  /** @type {Partial<import("../../static/js/page-state.js").PageState> & { page_number: number, is_lit: boolean }} */
  const changes = {
    form: new URLSearchParams("alpha=0,7&disturb=limp:legs%3D1,4&disturb=slope:degrees%3D8&steps="),
    run: "a", ghost: "b", moment: 2.25, clock: "free", end: "all", depth: "study", tab: "why", pinned: "gait",
    camera: "2", hidden: ["panel", "card"], lang: "fr", page_number: 3, is_lit: true,
  };
  const ofViews = {
    experiments: { experiment: new URLSearchParams("alpha=0.1;0.3&name=A %26 B"), report: "c" },
    runs: {
      list: new URLSearchParams("kind=race&tag=µ %26 co"), grouping: "day", columns: ["alpha", "seed"],
      selected: ["d", "e"], opened: "d", isOverList: true,
    },
    compare: { compared: ["a", "b"] },
  };
  const named = ["view", ...Object.keys(changes), ...Object.values(ofViews).flatMap(Object.keys)];
  assert.deepEqual(named.sort(), Object.keys(page).sort());
  for (const [view, own] of Object.entries({ race: {}, ...ofViews })) {
    change({ view, ...changes, ...own });
    const [before, link] = [document(), write()];
    open("/?run=other#race");
    change({ compared: [] });
    open(link);
    assert.deepEqual(document(), before, link);
    assert.equal(write(), link);
  }
});

test("a link that people have typed opens", () => {
  open("/?gait=wave&alpha=0.3&run=a&ghost=b&t=2.50&lit#experiments?experiment=sweep&alpha=0.1,0.3&run=c");
  const { form, experiment, view, run, ghost, moment, is_lit, report } = document();
  assert.deepEqual([view, run, ghost, moment, is_lit, report], ["experiments", "a", "b", 2.5, true, "c"]);
  assert.deepEqual([form, experiment], ["gait=wave&alpha=0.3", "experiment=sweep&alpha=0.1%2C0.3"]);
  open("/?lit=#compare?runs=a,b");
  assert.deepEqual([document().is_lit, page.compared.value], [true, ["a", "b"]]);
});

test("a link can be read by people", () => {
  assert.equal(addressOf({ form: new URLSearchParams([["disturb", "limp:legs=1,4:at=25"], ["name", "A & B"]]) }),
    "?disturb=limp:legs=1,4:at=25&name=A+%26+B");
});

test("what is as it is by default is in no link", () => {
  assert.equal(write(), "");
  assert.equal(addressOf({ run: "a" }), "?run=a");
  assert.equal(addressOf(/** @type {object} */ ({ view: "experiments", report: "a b" })), "#experiments?run=a+b");
  assert.equal(linkTo({ run: "a", moment: 1 }), "http://page.test/?run=a&t=1.00");
});

/** What a link says in vain, as it is told. @param {string} link */
const inVain = (link) => {
  ignored.query.value = [];
  open(link);
  return ignored.query.value;
};

test("a value that is none is told, with those that are valid where they are few", () => {
  assert.deepEqual(inVain("/?run=a&t=soon"), ["t=soon"]);
  assert.deepEqual([page.run.value, page.moment.value], ["a", null]);
  assert.deepEqual(inVain("/?t=-1"), ["t=-1"]);
  assert.deepEqual(inVain("/?page=0"), ["page=0"]);
  assert.deepEqual(inVain("/?depth=deep"), ["depth=deep (valid: watch, try, study)"]);
  assert.deepEqual(inVain("/?tab=chart"), ["tab=chart (valid: board, train, world, why, gait, table, what-if)"]);
  assert.deepEqual(inVain("/?camera=9"), ["camera=9 (valid: directed, free, 1 to 8)"]);
  assert.deepEqual(inVain("/?hidden=panel,stage"), ["hidden=panel,stage (valid: panel, card)"]);
  assert.deepEqual(inVain("/#nothing"), ["view=nothing (valid: race, runs, compare, experiments, lessons)"]);
  assert.equal(write(), "", "all is as it is without a link");
});

test("another view, tab or run is an entry of the history; all else changes the present one", () => {
  change({ form: new URLSearchParams("alpha=0.7"), depth: "study", camera: "2" });
  change({ tab: "gait" });
  goBack();
  assert.deepEqual([page.tab.value, entries], [null, ["/?alpha=0.7&depth=study&camera=2"]]);
  change({ depth: null, camera: "directed" });
  change({ run: "a", ghost: "b" });
  change({ moment: 2 });
  change({ moment: 3 });
  change({ view: "runs" });
  change({ list: new URLSearchParams("kind=race") });
  assert.deepEqual(entries,
    ["/?alpha=0.7", "/?alpha=0.7&run=a&ghost=b&t=3.00", "/?alpha=0.7&run=a&ghost=b&t=3.00#runs?kind=race"]);
});

test("back restores what was, the form with it, and makes no entry of its own", () => {
  change({ form: new URLSearchParams("alpha=0.7") });
  change({ run: "a", moment: 2 });
  change({ form: new URLSearchParams("alpha=0.2") });
  goBack();
  assert.deepEqual([page.run.value, page.moment.value, String(page.form.value)], [null, null, "alpha=0.7"]);
  assert.deepEqual(entries, ["/?alpha=0.7"]);
});

test("the bare link of a view leaves what is set there, and the address says it again", () => {
  change({ view: "runs", list: new URLSearchParams("kind=race") });
  follow("/#");
  assert.equal(page.view.value, "race");
  follow("/#runs");
  assert.equal(String(page.list.value), "kind=race");
  assert.equal(location.hash, "#runs?kind=race");
  follow("/#runs?tag=ice");
  assert.equal(String(page.list.value), "tag=ice");
});

test("a view that was just left writes nothing over the new address", () => {
  change({ view: "runs" });
  follow("/");
  change({ list: new URLSearchParams("search=anna") });
  assert.equal(location.hash, "");
});

test("an action goes to its view only from the one in which it was begun", () => {
  change({ view: "runs" });
  const go = changeIfStillHere();
  change({ view: "experiments" });
  go({ view: "race" });
  assert.equal(page.view.value, "experiments");
  changeIfStillHere()({ view: "race" });
  assert.equal(page.view.value, "race");
});
