// Files that the browser downloads.
import assert from "node:assert/strict";
import { readdirSync, readFileSync } from "node:fs";
import { test } from "node:test";
import { downloads } from "../../static/js/files.js";
import { makeRun } from "./options.js";

test("no link has `download` without a value, which would call its file true", () => {
  const folder = new URL("../../static/", import.meta.url);
  const scripts = readdirSync(folder, { recursive: true, encoding: "utf-8" }).filter((path) => path.endsWith(".js"));
  const links = scripts.flatMap((path) =>
    [...readFileSync(new URL(path, folder), "utf-8").matchAll(/<a\b[^<>`]*\sdownload\b(=?)/g)]
      .map(([link, sign]) => ({ path, link, hasValue: sign === "=" })));
  assert.ok(links.length > 5);
  assert.deepEqual(links.filter(({ hasValue }) => !hasValue), []);
});

test("each run offers the files that it has", () => {
  const labels = (/** @type {object} */ changes) => downloads(makeRun(changes)).map(([label]) => label);
  const withTable = { result: { q_table_sha256: "ab" } };
  assert.deepEqual(labels({ kind: "race" }), ["Recording"]);
  assert.deepEqual(labels(withTable), ["Curve (CSV)", "Q-table (CSV)", "Q-table (npz)"]);
  assert.deepEqual(labels({ result: { q_table_sha256: null } }), ["Curve (CSV)", "Learned state (npz)"]);
  assert.deepEqual(labels({ state: "interrupted" }), ["Curve (CSV)"]);
});
