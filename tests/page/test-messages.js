// The catalogues of the page's texts, and how texts are looked up in them.
import assert from "node:assert/strict";
import { test } from "node:test";
import { LANGUAGES } from "../../static/js/page-state.js";
import { t } from "../../static/js/format.js";
import { nameIn, sentencesIn } from "../../static/js/server-sentences.js";
import { keysIn, labelIn, named, patternsOf, translated } from "../../static/js/translation.js";
import { catalogues } from "./catalogues.js";
import { keysOfModule, modules, placeholdersOf } from "./messages.js";
import { PHONE, WATCH } from "./translated.js";

/** A template as the tag gets it. @param {TemplateStringsArray} statics */
const template = (statics, /** @type {unknown[]} */ ...fields) => ({ statics: [...statics], fields });

test("there is a catalogue of each language but English", () => {
  assert.deepEqual(Object.keys(catalogues()).sort(), Object.keys(LANGUAGES).filter((code) => code !== "en").sort());
});

test("a catalogue has every text of Watch and of a room's phone", () => {
  const keys = [...WATCH, ...PHONE].flatMap(keysOfModule);
  assert.ok(keys.length > 500);
  for (const [code, { page }] of Object.entries(catalogues())) {
    assert.deepEqual(keys.filter((key) => !page[key]), [], code);
  }
});

test("a catalogue has no text that no module has", () => {
  const keys = new Set(modules().flatMap(keysOfModule));
  for (const [code, { page }] of Object.entries(catalogues())) {
    assert.deepEqual(Object.keys(page).filter((key) => !keys.has(key)), [], code);
  }
});

test("a translation has no other placeholders than its text, and no signs that a template would read", () => {
  for (const { page, server, sentences } of Object.values(catalogues())) {
    for (const [key, text] of Object.entries({ ...server, ...page, ...sentences })) {
      assert.deepEqual(placeholdersOf(text).filter((name) => !placeholdersOf(key).includes(name)), [], text);
      assert.doesNotMatch(text, /[<>"]/, key);
    }
  }
});

test("a text has its values, and the form of its noun that fits them", () => {
  assert.equal(t("{steps} {steps|step|steps} of {robot}", { steps: 1, robot: "Greedy" }), "1 step of Greedy");
  assert.equal(t("{steps} {steps|step|steps} of {robot}", { steps: 12_500, robot: "A" }), "12\u202f500 steps of A");
});

test("the texts of a template are those between its tags, and of attributes that are read", () => {
  const { statics } = template`
    <p class="dim" title="About it">Card ${1} of
      ${2}</p>
    <${3} name="play" label="Progress" /> ${4}
  `;
  assert.deepEqual(keysIn(statics), ["About it", "Card {0} of{1}", "Progress"]);
});

test("a translated template has its fields where the translation has them", () => {
  const { statics, fields } = template`<p class=${"a"} title="About">Card ${1} of ${2}</p>${3}`;
  const catalogue = { "Card {0} of {1}": "{1}: {0}", "About": "Über" };
  const { statics: parts, order } = translated(statics, catalogue);
  assert.deepEqual(parts, ["<p class=", ' title="Über">', ": ", "</p>", ""]);
  assert.deepEqual(order.map((n) => fields[n]), ["a", 2, 1, 3]);
});

test("of an answer the titles are translated, and what people typed stays", () => {
  const world = { name: "Ice", title: "Ice", description: "Ice", settings: { default: "Ice" } };
  const answer = { name: "Ice", worlds: [world] };
  assert.deepEqual(named(answer, (text) => ({ Ice: "Eis" })[text] ?? text), {
    name: "Ice", worlds: [{ ...world, title: "Eis", description: "Eis" }],
  });
});

test("a catalogue has the words of the labels in the 3D view", () => {
  const lines = ["after 10 000 steps", "0.10 m, step 16", "thinking 142/156", "crossed at 19.9 s", "on the spot"];
  for (const [code, { plates }] of Object.entries(catalogues())) {
    for (const line of lines) {
      const inWords = patternsOf(plates)
        .reduce((text, [pattern, other]) => text.replace(new RegExp(pattern, "u"), other), line);
      assert.doesNotMatch(inWords, /after|step|thinking|crossed|spot/, code);
      assert.deepEqual(inWords.match(/\d+/g), line.match(/\d+/g), code);
    }
  }
});

test("the label of the picture has its words in another language, and a run's name as it is", () => {
  const words = patternsOf({ "at step": "bei Schritt", "step": "Schritt", "of": "von" });
  const messages = { "On the start line": "An der Startlinie" };
  const label = (/** @type {string} */ text) => labelIn(text, messages, words);
  assert.equal(label("On the start line"), "An der Startlinie");
  assert.equal(label("Race: Greedy, Two-step, step 18 of 20"), "Race: Greedy, Two-step, Schritt 18 von 20");
  assert.equal(label("Two of a step, Two-step at step 3 of 20"), "Two of a step, Two-step bei Schritt 3 von 20");
});

test("a sentence of the server is known by its pattern, and is said anew with its values", () => {
  const sentences = {
    "{Robot} came {distance} in {steps} {steps|step|steps}.":
      "{Robot} kam {distance} in {steps} {steps|Schritt|Schritten}.",
    "the {Kind} one": "der {Kind}",
  };
  /** @type {Record<string, string>} */
  const messages = { ...sentences, large: "große", "It fell.": "Er fiel." };
  const said = sentencesIn(sentences, { messages, mark: ",", t: (key, values) => t(messages[key], values) });
  assert.equal(said("the large one came 2.5 mm in 1 step."), "der große kam 2,5\u00a0mm in 1 Schritt.");
  assert.equal(said("It fell. X came -1.0 m in 12,000 steps."), "Er fiel. X kam −1,0\u00a0m in 12\u202f000 Schritten.");
  assert.equal(said("Nothing like it."), "Nothing like it.");
  assert.equal(nameIn("the large one, α 0.5", said, ","), "der große, α 0,5");
});
