// Completes the catalogues of static/messages: texts of Watch and of a room's phone without a translation get an empty
// one, which the checks name, and those that no module has any more go. Run by `make messages`.
import { writeFileSync } from "node:fs";
import { join } from "node:path";
import { CATALOGUES, catalogues } from "./catalogues.js";
import { keysOfModule, modules } from "./messages.js";
import { PHONE, WATCH } from "./translated.js";

const needed = [...WATCH, ...PHONE].flatMap(keysOfModule);
const all = new Set(modules().flatMap(keysOfModule));

for (const [code, { page, ...others }] of Object.entries(catalogues())) {
  const kept = Object.entries(page).filter(([key]) => all.has(key));
  const whole = { ...Object.fromEntries(needed.map((key) => [key, ""])), ...Object.fromEntries(kept) };
  const sorted = Object.fromEntries(Object.entries(whole).sort(([a], [b]) => (a < b ? -1 : 1)));
  writeFileSync(join(CATALOGUES, `${code}.json`), `${JSON.stringify({ page: sorted, ...others }, null, 1)}\n`);
}
