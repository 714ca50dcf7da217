// The page's state: the link that carries it, what "back" restores, and what a link says in vain.
import assert from "node:assert/strict";
import { beforeEach, test } from "node:test";
import {
  addressOf, change, changeIfStillHere, followHistory, ignored, linkTo, page, read, write,
} from "../../static/js/page-state.js";
import { entries, follow, goBack, visit } from "./browser.js";

visit("/?alpha=0.5&run=opened&t=1.5#runs?kind=race");
entries.splice(0, 1, "/?alpha=0.5&run=opened&t=1.5#runs?kind=race");
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
  change({ experiment: new URLSearchParams(), list: new URLSearchParams(), compared: [], report: null });
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
  const changes = {
    form: new URLSearchParams("alpha=0,7&disturb=limp:legs%3D1,4&disturb=slope:degrees%3D8&steps="),
    run: "a", ghost: "b", moment: 2.25, isExplaining: true, whatIf: "closed", isPresenting: true,
  };
  const ofViews = {
    experiments: { experiment: new URLSearchParams("alpha=0.1;0.3&name=A %26 B"), report: "c" },
    runs: { list: new URLSearchParams("kind=race&tag=µ %26 co") },
    compare: { compared: ["a", "b"] },
  };
  for (const [view, own] of Object.entries({ race: {}, ...ofViews })) {
    change({ view, ...changes, ...own });
    const [before, link] = [document(), write()];
    change({ view: "race", form: new URLSearchParams(), run: null, ghost: null, moment: null, compared: [] });
    open(link);
    assert.deepEqual(document(), before, link);
    assert.equal(write(), link);
  }
});

test("links of earlier versions open", () => {
  open("/?gait=wave&alpha=0.3&run=a&ghost=b&t=2.50&present#experiments?experiment=sweep&alpha=0.1,0.3&run=c");
  const { form, experiment, view, run, ghost, moment, isPresenting, report } = document();
  assert.deepEqual([view, run, ghost, moment, isPresenting, report], ["experiments", "a", "b", 2.5, true, "c"]);
  assert.deepEqual([form, experiment], ["gait=wave&alpha=0.3", "experiment=sweep&alpha=0.1%2C0.3"]);
  open("/?present=#compare?runs=a,b");
  assert.deepEqual([page.isPresenting.value, page.compared.value], [true, ["a", "b"]]);
});

test("a link can be read by people", () => {
  assert.equal(addressOf({ form: new URLSearchParams([["disturb", "limp:legs=1,4:at=25"], ["name", "A & B"]]) }),
    "?disturb=limp:legs=1,4:at=25&name=A+%26+B");
});

test("what is as it is by default is in no link", () => {
  assert.equal(write(), "");
  assert.equal(addressOf({ run: "a" }), "?run=a");
  assert.equal(addressOf({ view: "experiments", report: "a b" }), "#experiments?run=a+b");
  assert.equal(linkTo({ run: "a", moment: 1 }), "http://page.test/?run=a&t=1.00");
});

test("a value that is none is told, and so is a view that is not", () => {
  open("/?run=a&t=soon&what-if=maybe#nothing");
  assert.deepEqual(ignored.query.value.sort(), ["t=soon", "view=nothing", "what-if=maybe"]);
  assert.deepEqual([page.run.value, page.moment.value, page.view.value], ["a", null, "race"]);
  open("/?t=-1");
  assert.ok(ignored.query.value.includes("t=-1"));
});

test("another view and another run are entries of the history; all else changes the present one", () => {
  change({ form: new URLSearchParams("alpha=0.7") });
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
