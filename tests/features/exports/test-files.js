// Files of a run's walk for other programs.
import assert from "node:assert/strict";
import { test } from "node:test";
import { notInstalled, rendered, walkFiles } from "../../../static/features/exports/files.js";
import { options } from "../../../static/js/store.js";
import { makeRun, OPTIONS } from "../../page/options.js";

test("exports are those that the server names: downloads, what it renders, and what it lacks", () => {
  options.value = OPTIONS;
  assert.deepEqual(walkFiles({ ...makeRun({ kind: "race" }), id: "a b" }), [
    ["Joints (CSV)", "http://page.test/api/v1/runs/a%20b/joints?format=csv"],
    ["Page", "http://page.test/api/v1/runs/a%20b/page"],
  ]);
  assert.deepEqual(walkFiles(makeRun({ started_at: null })), [], "nothing was recorded of an imported table");
  assert.deepEqual(rendered().map(({ title }) => title), ["Film"]);
  assert.deepEqual(notInstalled(), [["pip install p", ["Joints (Parquet)"]]]);
  const lacking = OPTIONS.exports.map((format) => ({ ...format, install: "pip install p" }));
  options.value = { ...OPTIONS, exports: lacking };
  assert.deepEqual(rendered(), []);
  assert.deepEqual(notInstalled(), [["pip install p", lacking.map(({ title }) => title)]]);
});
