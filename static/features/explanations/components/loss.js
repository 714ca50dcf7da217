// Why a learner with a table loses: what it had tried, what better moves would have brought, and why it passed them.
import { useEffect, useRef } from "preact/hooks";
import { distanceApart, sentence, t } from "../../../js/format.js";
import { followLoss, isAbout, isOpen, isSought, loss, lostLane } from "../loss.js";
import { standings } from "../../../js/race.js";
import { messageOf, clockTitle } from "../../../js/titles.js";
import { html } from "../../../js/components/elements.js";
import { Trouble } from "./navigator.js";

/** @import { RequestError } from "../../../js/api.js" */
/** @import { Loss } from "../../../js/types.js" */

/** A lane without a table, or that cannot be walked again: the server says which. */
const NOT_AVAILABLE = 409;

export function WhyLost() {
  const fold = useRef(/** @type {HTMLDetailsElement | null} */ (null));
  useEffect(followLoss, []);
  const lane = lostLane.value;
  useEffect(() => {
    if (!isSought.value || !fold.current) return;
    isOpen.value = true;
    fold.current.scrollIntoView({ block: "start" });
    fold.current.querySelector("summary")?.focus({ preventScroll: true });
    // Without the answer the panel may be too short to be scrolled.
    isSought.value = !loss.value.answer && !loss.value.error;
  }, [isSought.value, lane === null, loss.value]);
  if (!lane) return null;
  return html`
    <details class="fold why-lost" ref=${fold} open=${isOpen.value}
      onToggle=${(/** @type {{ target: HTMLDetailsElement }} */ { target }) => (isOpen.value = target.open)}>
      <summary>Why does it lose?</summary>
      <${Answer} asked=${lane} />
    </details>
  `;
}

/** @param {{ asked: NonNullable<typeof lostLane.value> }} props */
function Answer({ asked }) {
  const { answer, error, again } = loss.value;
  if (answer && isAbout(answer, asked)) return html`<${LossReasons} loss=${answer} />`;
  if (error && /** @type {RequestError} */ (error).status === NOT_AVAILABLE) {
    return html`<p class="dim">Not told here: ${messageOf(error)}</p>`;
  }
  if (error) return html`<${Trouble} error=${error} again=${again} />`;
  return html`
    <p class="dim" role="status">
      <span class="spinner" aria-hidden="true"></span> Every move in each of its states is simulated…
    </p>
  `;
}

/** @param {{ loss: Loss }} props */
function LossReasons({ loss: answer }) {
  const ahead = standings.value?.find(({ lane }) => lane === answer.ahead)?.title ??
    t("lane {lane}", { lane: answer.ahead + 1 });
  const values = { distance: distanceApart(answer.behind_m), robot: ahead, clock: clockTitle(answer.clock) };
  return html`
    <p class="dim">${sentence(answer.is_ranked ? t("{distance} behind {robot} at time-out ({clock}).", values)
      : t("{distance} behind {robot}.", values))}</p>
    ${answer.sentences.map((text) => html`<p>${text}</p>`)}
    <p class="dim fine">One step ahead only: the best next step is not always the best walk.</p>
  `;
}
