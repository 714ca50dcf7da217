// The kinds of questions: how each is asked, answered, told, shown to a class, and written in a lesson.
import { signal } from "@preact/signals";
import { html } from "../../../js/components/elements.js";
import { decimal, distanceApart, metres, percentage, t } from "../../../js/format.js";
import { linesOf, numberOf, parseNumber } from "../../../js/parse.js";
import { agentOf, rangeOf } from "../../../js/settings.js";
import { setEntry } from "../../../js/store.js";
import { Curve, inWords, knotsOf, lineOf, Point, stepsOf } from "./chart.js";
import { errorInWords, PER_METRE } from "./scores.js";

/** @import { Signal } from "@preact/signals" */
/** @import { ComponentChildren, FunctionComponent } from "preact" */
/** @import { Ask, LessonCard, ResultEntry } from "../../../js/types.js" */

/** @typedef {NonNullable<ResultEntry["score"]>} Score */
/**
 * What a control of a question is drawn with. `locked`: the answer once it cannot be changed; undefined before.
 * `actual`: the learning curve of the own run.
 * @typedef {{
 *   card: LessonCard, ask: Ask, draft: any, locked: any, onValue: (value: any) => unknown, actual: number[][],
 * }} ControlProps
 */
/**
 * A kind of question. Values and drafts are of the kind; all from `tally` on may be left out.
 * @typedef {object} QuestionKind
 * @property {string} title on the page that writes lessons
 * @property {FunctionComponent<any>} Control gets `ControlProps`
 * @property {(draft: any, ask: Ask, card: LessonCard) => any} answerOf undefined as long as it is no answer
 * @property {(value: any, ask: Ask) => string} inWords
 * @property {(score: Score, ask: Ask, value: any) => string | null} scoreInWords against all seeds
 * @property {(ask: Ask, values: unknown[]) => [string, number][]} [tally] how many gave which answer
 * @property {(value: any, steps: number) => ComponentChildren} [onChart] an answer among the curves of the class
 * @property {(ask: Ask, values: unknown[]) => number[] | null} [metresOf] answers as distances, if they are
 * @property {(before: any) => Partial<Ask>} [fieldsOf] of a new question; the one before had another kind
 * @property {(ask: Ask) => boolean} [isComplete] whether it can be asked
 * @property {FunctionComponent<any>} [Editor] of its fields; gets `ask` and `change`
 * @property {FunctionComponent<any>} [RightAnswer] of a lesson; gets `ask`, `answer` and `change`
 */

// ---- one of several texts, which may be names of agents that race

/** Longer texts are no names any more. */
const NAME_CHARACTERS = 14;

/** @param {Ask} ask */
const hasSentences = ({ choices }) => (choices ?? []).some((choice) => agentOf(choice).title.length > NAME_CHARACTERS);

/** @param {ControlProps} props */
const Choice = ({ ask, locked, draft, onValue }) => html`
  <div class=${`choices ${hasSentences(ask) ? "sentences" : ""}`} role="group" aria-label="Your prediction">
    ${(ask.choices ?? []).map((choice) => html`
      <button key=${choice} class="choice-chip" aria-pressed=${(locked ?? draft) === choice ? "true" : "false"}
        disabled=${locked !== undefined} onClick=${() => onValue(choice)}>${agentOf(choice).title}</button>
    `)}
  </div>
`;

/** @param {{ ask: Ask, change: (changes: Partial<Ask>) => unknown, id?: string }} props */
const ChoiceEditor = ({ ask, change, id = "ask-choices" }) => html`
  <label for=${id}>Answers to choose from, one a line; the name of an agent stands for its win</label>
  <textarea id=${id} rows="3" value=${(ask.choices ?? []).join("\n")}
    onChange=${(/** @type {any} */ { target }) => change({ choices: linesOf(target.value) })}></textarea>
`;

/**
 * `isNeeded`: whether there has to be one.
 * @typedef {{ ask: Ask, answer: any, change: (answer: any) => unknown, isNeeded?: boolean, id?: string }} RightProps
 */

/** @param {RightProps} props */
const RightChoice = ({ ask, answer, change, isNeeded = false, id = "card-answer" }) => html`
  <label for=${id}>${isNeeded ? t("The right answer") : t("The right answer, if the runs do not tell it")}</label>
  <select id=${id} value=${answer ?? ""}
    onChange=${(/** @type {any} */ { target }) => change(target.value || null)}>
    <option value="">${isNeeded ? t("Choose it") : t("None: it follows from the runs")}</option>
    ${(ask.choices ?? []).map((choice) => html`<option key=${choice} value=${choice}>${choice}</option>`)}
  </select>
`;

/** @type {QuestionKind} */
const CHOICE = {
  title: t("Choice"),
  Control: Choice,
  answerOf: (draft) => draft,
  // The name of an agent stands for its win.
  inWords: (value) => agentOf(String(value)).title,
  scoreInWords: ({ share }, _, value) =>
    (share === null ? null
      : t("{robot} won in {share} of all races.", { robot: agentOf(String(value)).title, share: percentage(share) })),
  tally: (ask, values) =>
    (ask.choices ?? []).map((choice) => [choice, values.filter((value) => value === choice).length]),
  fieldsOf: (before) => ({ choices: before?.choices ?? [] }),
  isComplete: ({ choices }) => (choices ?? []).length > 0,
  Editor: ChoiceEditor,
  RightAnswer: RightChoice,
};

// ---- a number

const MOST = 1e9;

/** Limits of a number. @param {Ask} ask */
const limitsOf = ({ minimum, maximum }) => ({
  minimum: minimum ?? -MOST, maximum: maximum ?? MOST, excludes_minimum: false, excludes_maximum: false,
});

/** @type {QuestionKind["inWords"]} */
const numberInWords = (value, { unit }) =>
  (unit === "m" ? metres(value) : [decimal(value), unit].filter(Boolean).join("\u00a0"));

/** @param {ControlProps} props */
function NumberControl({ ask, draft = "", locked, onValue }) {
  if (locked !== undefined) return html`<p class="locked-answer">${numberInWords(locked, ask)}</p>`;
  const limits = limitsOf(ask);
  const { mistake } = draft.trim() ? parseNumber(draft, limits, false) : { mistake: undefined };
  const isLimited = ask.minimum !== null && ask.minimum !== undefined;
  const range = isLimited ? `${rangeOf(limits)}${ask.unit ? ` ${ask.unit}` : ""}` : "";
  return html`
    <div class="number-answer">
      <label for="answer">Your prediction</label>
      <span>
        <input id="answer" type="text" inputmode="decimal" autocomplete="off" value=${draft}
          aria-invalid=${mistake ? "true" : undefined} aria-describedby="answer-range"
          onInput=${(/** @type {any} */ { target }) => onValue(target.value)} />
        ${ask.unit && html`<b>${ask.unit}</b>`}
      </span>
      <p id="answer-range" class=${mistake ? "bad" : "dim"} role=${mistake ? "alert" : undefined}>
        ${mistake ?? range.replaceAll("-", "\u2212")}
      </p>
    </div>
  `;
}

/** @param {{ ask: Ask, change: (changes: Partial<Ask>) => unknown }} props */
const NumberEditor = ({ ask, change }) => html`
  <div class="number-rules">
    ${[["minimum", t("Least")], ["maximum", t("Most")]].map(([name, title]) => html`
      <label key=${name}>${title}
        <input type="text" inputmode="decimal" value=${/** @type {any} */ (ask)[name] ?? ""}
          onChange=${(/** @type {any} */ { target }) => change({ [name]: numberOf(target.value) })} />
      </label>
    `)}
    <label>Unit
      <input type="text" maxlength="20" value=${ask.unit ?? ""}
        onChange=${(/** @type {any} */ { target }) => change({ unit: target.value.trim() || null })} />
    </label>
  </div>
`;

/** @param {RightProps} props */
const RightNumber = ({ answer, change, isNeeded = false, id = "card-answer" }) => html`
  <label for=${id}>${isNeeded ? t("The right number") : t("The right number, if the runs do not tell it")}</label>
  <input id=${id} type="text" inputmode="decimal" value=${answer ?? ""}
    onChange=${(/** @type {any} */ { target }) => change(numberOf(target.value))} />
`;

/** @type {QuestionKind} */
const NUMBER = {
  title: t("Number"),
  Control: NumberControl,
  answerOf: (draft, ask) => parseNumber(draft, limitsOf(ask), false).value,
  inWords: numberInWords,
  scoreInWords({ quantile, error }, { unit }) {
    if (quantile === null || error === null) return null;
    const values = { share: percentage(quantile), error: errorInWords(error, unit) };
    return t("{share} of all robots went less far than you said; you were {error} from the typical one.", values);
  },
  metresOf({ unit }, values) {
    const per = PER_METRE[unit ?? "m"];
    return per ? values.flatMap((value) => (typeof value === "number" ? [value / per] : [])) : null;
  },
  fieldsOf: () => ({ unit: "m" }),
  Editor: NumberEditor,
  RightAnswer: RightNumber,
};

// ---- a point on a chart, and a curve that is drawn

/** @type {QuestionKind["scoreInWords"]} */
const fromCurve = ({ error }) =>
  (error === null ? null
    : t("On average you were {error} from the typical curve.", { error: distanceApart(error) }));

/** @type {QuestionKind} */
const POINT = {
  title: t("Point"),
  Control: Point,
  answerOf: (draft) => draft,
  inWords,
  scoreInWords: fromCurve,
  onChart: (value, steps) =>
    html`<circle class="own-point" r="4" transform=${`translate(${lineOf([value], steps)})`} />`,
};

/** @type {QuestionKind} */
const CURVE = {
  title: t("Curve"),
  Control: Curve,
  answerOf: (draft, _, card) => knotsOf(stepsOf(card)).map((x, n) => [x, draft[n]]),
  inWords: (value) => t("from {low} to {high}", { low: metres(value[0][1]), high: metres(value.at(-1)[1]) }),
  scoreInWords: fromCurve,
  onChart: (value, steps) => html`<path class="predicted-curve" d=${`M${lineOf(value, steps)}`} />`,
};

// ---- all kinds

/** By the name that lessons have for them. @type {Record<Ask["kind"], QuestionKind>} */
export const KINDS = { choice: CHOICE, number: NUMBER, point: POINT, curve: CURVE };

/** Card → what is chosen, typed or drawn, and not locked yet. @type {Signal<Record<string, any>>} */
const drafts = signal({});

/**
 * What would be locked; undefined as long as that is no answer.
 * @param {LessonCard} card
 * @param {number} number
 */
export function draftOf(card, number) {
  const draft = drafts.value[`${number}`];
  const { ask } = card;
  return draft === undefined || !ask ? undefined : KINDS[ask.kind].answerOf(draft, ask, card);
}

/** An answer in words. @param {Ask} ask @param {any} value */
export const answerInWords = (ask, value) => KINDS[ask.kind].inWords(value, ask);

/**
 * The control of a question; a chart shows the answer also once it is locked, beside what came of it.
 * @param {{ card: LessonCard, number: number, locked: any, actual?: number[][] }} props see `ControlProps`
 */
export function Answer({ card, number, locked, actual = [] }) {
  const { ask } = /** @type {{ ask: Ask }} */ (card);
  return html`
    <${KINDS[ask.kind].Control} card=${card} ask=${ask} draft=${drafts.value[`${number}`]} locked=${locked}
      onValue=${(/** @type {any} */ value) => setEntry(drafts, `${number}`, value)} actual=${actual} />
  `;
}

/**
 * What a prediction was worth, against the answer of the lesson or all seeds.
 * @param {ResultEntry} entry with a score
 * @param {Ask} ask
 */
export function scoreInWords({ score, prediction }, ask) {
  const answerScore = /** @type {Score} */ (score);
  if (answerScore.is_right !== null) {
    if (answerScore.is_right) return t("You were right.");
    const off = answerScore.error && errorInWords(answerScore.error, ask.unit ?? "");
    return off ? t("That was not it. It is {error} off.", { error: off }) : t("That was not it.");
  }
  return KINDS[ask.kind].scoreInWords(answerScore, ask, prediction) ?? t("Your prediction is kept.");
}
