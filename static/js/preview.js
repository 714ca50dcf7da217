// What is known of the form's robot, gait and foot grid before anything runs: support, reach, states, speed.
import { effect, signal, untracked } from "@preact/signals";
import { keepAnswer, previewRobot } from "./api.js";
import { bodyFields, offerLearner, setField, wrong } from "./form.js";
import { listed, metres, millimetres, whole } from "./format.js";
import { isPlaying } from "./on-stage.js";
import { connection, options } from "./store.js";

/** @import { Signal } from "@preact/signals" */
/** @import { Reply } from "./api.js" */
/** @import { FormValue, Preview } from "./types.js" */

/** @type {Signal<Reply<Preview>>} */
export const preview = signal({ answer: null, error: null, again: false });

/** While the stage plays, previews are asked for at most so often [ms]. */
const EVERY_MS = 500;
const BODY_FIELDS = ["gait", "robot", "divisions", "grid_side_m"];

/** Keep the preview of the form, and offer a learner by it, until the function that is returned is called. */
export function followPreview() {
  const stops = [
    keepAnswer(
      () => {
        const isKnown = connection.value === "live" && options.value
          && !BODY_FIELDS.some((field) => field in wrong.value);
        return isKnown ? JSON.stringify(bodyFields()) : "";
      },
      (key) => previewRobot(JSON.parse(key)),
      preview,
      () => (isPlaying.value ? EVERY_MS : 0),
    ),
    effect(() => {
      const { answer } = preview.value;
      if (answer) untracked(() => offerLearner(offeredFor(answer)));
    }),
  ];
  return () => stops.forEach((stop) => stop());
}

/**
 * The learner that the form has for a body unless a person chooses one: where it tips the recommended one, since the
 * usual ones hardly walk it; else, null, the server's default.
 * @param {Preview} known
 */
export const offeredFor = ({ tips, recommended_agent }) => (tips ? recommended_agent : null);

/** How it stands and how fast it is by the law, in a line. @param {Preview} known */
export function inWords({ states, actions, tips, margin_m, law_m }) {
  const stands = tips ? `tips by ${millimetres(-margin_m)} mm` : `stands by ${millimetres(margin_m)} mm`;
  return `${whole(states)} states, ${whole(actions)} moves · ${stands} · ${metres(law_m)} in 50 steps by the law`;
}

/** What speaks against it, as sentences. @param {Preview} known */
export function objections({ groups, tips, out_of_reach, beside_grid, table_fits, values }) {
  const tipping = groups.filter(({ margin_m }) => margin_m < 0).map(({ legs }) => legs.join("+"));
  return [
    out_of_reach,
    beside_grid && `It walks beside its grid: ${beside_grid}.`,
    tips && `It tips while legs ${listed(tipping)} swing: its centre of mass is not between the other feet.`,
    !table_fits && `A table of ${whole(values)} values is too large: only learners without one can start.`,
  ].filter((sentence) => typeof sentence === "string");
}

/**
 * Move a leg to the next group; after the last one it begins a group of its own.
 * @param {Preview} known
 * @param {number} leg
 */
export function moveLeg({ gait, groups }, leg) {
  const parts = groups.map(({ legs }) => legs.filter((other) => other !== leg));
  const from = groups.findIndex(({ legs }) => legs.includes(leg));
  const isAlone = parts[from].length === 0;
  const to = (from + 1) % (isAlone ? parts.length : parts.length + 1);
  const moved = [...parts, []].map((legs, number) => (number === to ? [...legs, leg].toSorted((a, b) => a - b) : legs));
  setField("gait", /** @type {FormValue} */ ({
    .../** @type {object} */ (gait), groups: moved.filter((legs) => legs.length),
  }));
}

/** Take the groups with which it would stand. @param {Preview} known */
export const takeBetter = ({ better }) => better && setField("gait", /** @type {FormValue} */ (better.gait));
