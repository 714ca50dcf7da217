// Files that the browser downloads.
import assert from "node:assert/strict";
import { test } from "node:test";
import { downloads, fileAddress, filmSpeed } from "../../static/js/files.js";

test("addresses of files are escaped part by part", () => {
  const run = { kind: /** @type {const} */ ("experiment"), id: "a b" };
  assert.equal(fileAddress(run, "figures/one two.png"),
    "http://page.test/api/v1/experiments/a%20b/files/figures/one%20two.png");
  assert.deepEqual(downloads({ ...run, kind: "race" }).map(([label]) => label),
    ["Recording", "Joints and feet (CSV)", "Offline replay (HTML)"]);
  assert.equal(downloads({ ...run, kind: "training" }).length, 5);
  assert.equal(downloads({ ...run, kind: "training", started_at: null }).length, 3);
  assert.deepEqual(downloads({ ...run, kind: "training" }, false).map(([label]) => label),
    ["Curve (CSV)", "Joints and feet (CSV)", "Offline replay (HTML)"]);
});

test("a film shows all that is recorded, faster where that would be too long for one", () => {
  assert.equal(filmSpeed([[0, 12]]), 1);
  assert.equal(filmSpeed([[0, 10], [500, 577]]), 3);
  assert.equal(filmSpeed([[0, 90.88]]), 3.2);
});
