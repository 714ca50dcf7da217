// Files that the browser downloads.
import assert from "node:assert/strict";
import { test } from "node:test";
import { downloads, fileAddress, videoSpeed } from "../../static/js/files.js";
import { options } from "../../static/js/store.js";
import { makeRun, OPTIONS } from "./options.js";

test("addresses of files are escaped part by part", () => {
  const run = { kind: /** @type {const} */ ("experiment"), id: "a b" };
  assert.equal(fileAddress(run, "figures/one two.png"),
    "http://page.test/api/v1/experiments/a%20b/files/figures/one%20two.png");
});

test("each run offers the files that it has", () => {
  const labels = (/** @type {object} */ changes) => downloads(makeRun(changes)).map(([label]) => label);
  const walk = ["Joints and feet (CSV)", "Offline replay (HTML)"];
  const withTable = { result: { q_table_sha256: "ab" } };
  assert.deepEqual(labels({ kind: "race" }), ["Recording", ...walk]);
  assert.deepEqual(labels(withTable), ["Curve (CSV)", "Q-table (CSV)", "Q-table (npz)", ...walk]);
  assert.deepEqual(labels({ ...withTable, started_at: null }), ["Curve (CSV)", "Q-table (CSV)", "Q-table (npz)"],
    "nothing was recorded of an imported table");
  assert.deepEqual(labels({ result: { q_table_sha256: null } }), ["Curve (CSV)", "Learned state (npz)", ...walk]);
  assert.deepEqual(labels({ state: "interrupted" }), ["Curve (CSV)", ...walk]);
});

test("a video shows all that is recorded, faster where that would be too long for one", () => {
  options.value = OPTIONS;
  assert.equal(videoSpeed([[0, 12]]), 1);
  assert.equal(videoSpeed([[0, 10], [500, 577]]), 3);
  assert.equal(videoSpeed([[0, 90.88]]), 3.2);
});
