// A page that the server has opened at the address of a view, as "/proxy/runs?kind=race".
import assert from "node:assert/strict";
import { test } from "node:test";
import { change, followHistory, ignored, linkTo, page } from "../../static/js/page-state.js";
import { entries, follow, goBack, visit } from "./browser.js";

globalThis.document.documentElement.dataset.view = "runs";
visit("/proxy/runs?kind=race&group=day");
entries.splice(0, 1, "/proxy/runs?kind=race&group=day");
followHistory();

test("the address of a view opens it with what its query says, and becomes that of the page", () => {
  assert.deepEqual([page.view.value, page.grouping.value, String(page.list.value)], ["runs", "day", "kind=race"]);
  assert.deepEqual([String(page.form.value), ignored.query.value], ["", []], "the query is the view's");
  assert.deepEqual(entries, ["/proxy/#runs?group=day&kind=race"]);
  assert.equal(linkTo(), "http://page.test/proxy/#runs?group=day&kind=race");
});

test("back and forth lead through the views, below the same path", () => {
  change({ view: "race" });
  assert.equal(entries.at(-1), "/proxy/");
  goBack();
  assert.equal(page.view.value, "runs");
  follow("/proxy/#compare?runs=a,b");
  assert.deepEqual([page.view.value, page.compared.value], ["compare", ["a", "b"]]);
  goBack();
  assert.equal(page.view.value, "runs");
});
