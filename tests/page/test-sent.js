// Scripts as the server sends them: without comments, with the same code in the same lines.
import assert from "node:assert/strict";
import { execFileSync } from "node:child_process";
import { readFileSync } from "node:fs";
import { test } from "node:test";
import * as espree from "espree";

const SENT = `
import json, sys
from pathlib import Path
from hexapods.assets import as_sent
paths = sorted(path for path in Path("static").rglob("*.js") if "vendor" not in path.parts)
json.dump({str(path): as_sent(path, path.read_bytes()).decode() for path in paths}, sys.stdout)
`;

/** The tokens of a script, with their places. @param {string} path @param {string} text */
const codeOf = (path, text) => espree.tokenize(text, {
  ecmaVersion: "latest", loc: true, sourceType: path.startsWith("static/viewer/") ? "script" : "module",
}).map(({ type, value, loc }) => `${loc?.start.line}:${loc?.start.column} ${type} ${value}`);

test("what is sent of a script is its code, in its lines", () => {
  /** @type {Record<string, string>} */
  const sent = JSON.parse(execFileSync(".venv/bin/python", ["-c", SENT], { encoding: "utf8", maxBuffer: 1e8 }));
  let left = 0;
  for (const [path, text] of Object.entries(sent)) {
    const source = readFileSync(path, "utf8");
    assert.deepEqual(codeOf(path, text), codeOf(path, source), path);
    left += source.length - text.length;
  }
  assert.ok(left > 100_000);
});
