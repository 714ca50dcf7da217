// Sentences of the server in another language than English. The server speaks English; a sentence is recognised by the
// pattern that it was made from, which is a key of the catalogue, and is said anew with its values.

/** @typedef {(key: string, values: Record<string, string | number>) => string} Say */
/** @typedef {{ key: string, names: string[], pattern: RegExp }} Sentence */

/**
 * A place of a key: `{distance}` is a figure, `{Move}` words, which are looked up themselves, and `{steps|step|steps}`
 * the form that goes with a count.
 */
const PLACE = /\{(\w+)(?:\|([^|}]*)\|([^}]*))?\}/g;
/** A number, maybe with its unit: "2,000", "−12.3 mm". */
const FIGURE = String.raw`[+−-]?\d+(?:[.,\u202f]\d+)*(?:[ \u00a0](?:mm|cm|m|s|MB)(?!\p{L}))?`;
const BETWEEN_SENTENCES = /(?<=[.!?]) (?=\p{Lu})/u;
const IS_CAPITAL = /^\p{Lu}/u;

/** @param {string} text */
const escaped = (text) => text.replace(/[\\^$.*+?()[\]{}|/-]/g, "\\$&");

/**
 * How a sentence of the server is recognised that a key stands for.
 * @param {string} key
 * @returns {Sentence}
 */
export function sentenceOf(key) {
  /** @type {string[]} */
  const names = [];
  let [source, end] = ["", 0];
  for (const { 0: place, 1: name, 2: first, 3: second, index } of key.matchAll(PLACE)) {
    source += escaped(key.slice(end, index));
    end = index + place.length;
    if (second === undefined) {
      source += IS_CAPITAL.test(name) ? "(.+?)" : `(${FIGURE})`;
      names.push(name);
    } else source += `(?:${escaped(first)}|${escaped(second)})`;
  }
  return { key, names, pattern: new RegExp(`^${source}${escaped(key.slice(end))}$`, "su") };
}

/** Of two keys the one with more words of its own is about less. @param {string} key */
const wordsOf = (key) => key.replace(PLACE, "").length;

/**
 * A figure as the page writes it: a whole number, to be grouped, or a text with the mark of the language's decimals.
 * @param {string} figure
 * @param {string} mark
 */
function asHere(figure, mark) {
  const digits = figure.replaceAll(",", "").replaceAll("\u202f", "");
  if (/^\d+$/.test(digits)) return Number(digits);
  return digits.replace(/^-/, "\u2212").replace(".", mark).replace(" ", "\u00a0");
}

/**
 * Says sentences of the server in the language of a catalogue; what it does not have stays in English.
 * @param {Record<string, string>} sentences of the catalogue, by their keys
 * @param {{ messages: Record<string, string>, mark: string, t: Say }} language all its texts, its mark of decimals, and
 *   what gives a text its values
 * @returns {(text: string) => string}
 */
export function sentencesIn(sentences, { messages, mark, t }) {
  /** @type {Sentence[] | null} */
  let known = null;

  /** A single sentence. @param {string} text */
  function translated(text) {
    known ??= Object.keys(sentences).toSorted((a, b) => wordsOf(b) - wordsOf(a)).map(sentenceOf);
    for (const { key, names, pattern } of known) {
      const values = pattern.exec(text)?.slice(1);
      if (values) {
        return t(key, Object.fromEntries(names.map((name, n) =>
          [name, IS_CAPITAL.test(name) ? said(values[n]) : asHere(values[n], mark)])));
      }
    }
    return text;
  }

  /** @param {string} text @returns {string} */
  function said(text) {
    if (Object.hasOwn(messages, text)) return messages[text];
    const parts = text.split(BETWEEN_SENTENCES);
    return parts.length > 1 ? parts.map(said).join(" ") : translated(text);
  }
  return said;
}

/**
 * A name that the server has given a run: "Q-learning, α 0.5, 500 steps".
 * @param {string} name
 * @param {(text: string) => string} said
 * @param {string} mark of decimals
 */
export const nameIn = (name, said, mark) =>
  name.split(", ").map((part) => said(part).replace(/(\d)\.(\d)/, `$1${mark}$2`)).join(", ");
