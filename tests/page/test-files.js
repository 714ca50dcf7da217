// Files that the browser downloads.
import assert from "node:assert/strict";
import { test } from "node:test";
import { downloads, fileAddress } from "../../static/js/files.js";
import { makeRun } from "./options.js";

test("addresses of files are escaped part by part", () => {
  const run = { kind: /** @type {const} */ ("experiment"), id: "a b" };
  assert.equal(fileAddress(run, "figures/one two.png"),
    "http://page.test/api/v1/experiments/a%20b/files/figures/one%20two.png");
});

test("each run offers the files that it has", () => {
  const labels = (/** @type {object} */ changes) => downloads(makeRun(changes)).map(([label]) => label);
  const withTable = { result: { q_table_sha256: "ab" } };
  assert.deepEqual(labels({ kind: "race" }), ["Recording"]);
  assert.deepEqual(labels(withTable), ["Curve (CSV)", "Q-table (CSV)", "Q-table (npz)"]);
  assert.deepEqual(labels({ result: { q_table_sha256: null } }), ["Curve (CSV)", "Learned state (npz)"]);
  assert.deepEqual(labels({ state: "interrupted" }), ["Curve (CSV)"]);
});
