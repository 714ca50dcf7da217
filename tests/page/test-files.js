// Files that the page hands to the browser's downloads.
import assert from "node:assert/strict";
import { test } from "node:test";
import { filmSpeed } from "../../static/js/files.js";

test("a film shows all that is recorded, faster where that would be too long for one", () => {
  assert.equal(filmSpeed([[0, 12]]), 1);
  assert.equal(filmSpeed([[0, 10], [500, 577]]), 3);
  assert.equal(filmSpeed([[0, 90.88]]), 3.2);
});
