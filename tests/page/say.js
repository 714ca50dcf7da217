// Says sentences of the server, and names that it gives, by the catalogues: reads English ones as JSON, and writes what
// each catalogue makes of them, what one in full-width letters does, and by which keys. Run by
// tests/server_sentences.py.
import { readFileSync } from "node:fs";
import { t } from "../../static/js/format.js";
import { nameIn, sentencesIn } from "../../static/js/server-sentences.js";
import { catalogues } from "./catalogues.js";

const LETTER = /(\{\w+(?=[|}]))|([A-Za-z])/g;

/** In full-width letters, but for the names of places. @param {string} text */
const fullWidth = (text) => text.replace(LETTER, (_, place, letter) =>
  place ?? String.fromCharCode(letter.charCodeAt(0) + 0xfee0));

/** @type {{ sentences: string[], names: string[] }} */
const { sentences, names } = JSON.parse(readFileSync(0, "utf-8"));
/** @type {Set<string>} */
const used = new Set();

/** @param {Record<string, Record<string, string>>} catalogue @param {string} mark of decimals */
function saidBy(catalogue, mark) {
  const messages = { ...catalogue.sentences, ...catalogue.server, ...catalogue.page };
  const say = sentencesIn(catalogue.sentences, {
    messages: new Proxy(messages, { get: (_, key) => (used.add(String(key)), messages[String(key)]) }), mark,
    t: (key, values) => (used.add(key), t(messages[key], values)),
  });
  return Object.fromEntries([
    ...sentences.map((sentence) => [sentence, say(sentence)]), ...names.map((name) => [name, nameIn(name, say, mark)]),
  ]);
}

const all = catalogues();
const inFullWidth = Object.fromEntries(Object.entries(all.de).map(([group, texts]) =>
  [group, Object.fromEntries(Object.keys(texts).map((key) => [key, fullWidth(key)]))]));
const said = {
  ...Object.fromEntries(Object.entries(all).map(([code, catalogue]) => [code, saidBy(catalogue, ",")])),
  "full width": saidBy(inFullWidth, "."),
};
process.stdout.write(JSON.stringify({ said, used: [...used] }));
