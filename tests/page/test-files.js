// Files that the browser downloads.
import assert from "node:assert/strict";
import { test } from "node:test";
import { downloads, fileAddress, notInstalled, rendered } from "../../static/js/files.js";
import { options } from "../../static/js/store.js";
import { makeRun, OPTIONS } from "./options.js";

test("addresses of files are escaped part by part", () => {
  const run = { kind: /** @type {const} */ ("experiment"), id: "a b" };
  assert.equal(fileAddress(run, "figures/one two.png"),
    "http://page.test/api/v1/experiments/a%20b/files/figures/one%20two.png");
});

test("each run offers the files that it has", () => {
  const labels = (/** @type {object} */ changes) => downloads(makeRun(changes)).map(([label]) => label);
  options.value = OPTIONS;
  const walk = ["Joints (CSV)", "Page"];
  const withTable = { result: { q_table_sha256: "ab" } };
  assert.deepEqual(labels({ kind: "race" }), ["Recording", ...walk]);
  assert.deepEqual(labels(withTable), ["Curve (CSV)", "Q-table (CSV)", "Q-table (npz)", ...walk]);
  assert.deepEqual(labels({ ...withTable, started_at: null }), ["Curve (CSV)", "Q-table (CSV)", "Q-table (npz)"],
    "nothing was recorded of an imported table");
  assert.deepEqual(labels({ result: { q_table_sha256: null } }), ["Curve (CSV)", "Learned state (npz)", ...walk]);
  assert.deepEqual(labels({ state: "interrupted" }), ["Curve (CSV)", ...walk]);
});

test("exports are those that the server names: downloads, what it renders, and what it lacks", () => {
  options.value = OPTIONS;
  const addresses = Object.fromEntries(downloads({ ...makeRun({ kind: "race" }), id: "a b" }));
  assert.equal(addresses["Joints (CSV)"], "http://page.test/api/v1/runs/a%20b/joints?format=csv");
  assert.deepEqual(rendered().map(({ title }) => title), ["Film"]);
  assert.deepEqual(notInstalled(), [["pip install p", ["Joints (Parquet)"]]]);
  const lacking = OPTIONS.exports.map((one) => ({ ...one, install: "pip install p" }));
  options.value = { ...OPTIONS, exports: lacking };
  assert.deepEqual(rendered(), []);
  assert.deepEqual(notInstalled(), [["pip install p", lacking.map(({ title }) => title)]]);
});
