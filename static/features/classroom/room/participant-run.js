// The own robot of a participant: its picture, how far it is, and what came of it.
import { html, ProgressBar } from "../../../js/components/elements.js";
import { page } from "../../../js/page-state.js";
import { toast } from "../../../js/page.js";
import { setReplayClock } from "../../../js/player.js";
import { participantRunNarrative } from "./run-sentences.js";
import { isAway } from "../../../js/store.js";
import { givenInWords } from "./allowed-settings.js";
import { Picture, ReplayBar } from "./picture.js";
import { ClockChoice } from "./clocks.js";
import { arrived, ownEntry, ownRun, replayed, room, toReplay } from "./room.js";

/** @import { Clock } from "../../../js/types.js" */

export const OwnRobot = () => html`
  <section class="own-robot" aria-label="Your robot">
    <${Picture} />
    <${ReplayBar} />
    <${OwnRun} />
    ${toReplay.value?.kind === "race" && arrived.value.has(replayed.value ?? "") && html`
      <${ClockChoice} clock=${page.clock.value} onClock=${chooseClock} />
    `}
  </section>
`;

/** Watch the own race by another clock, from its start. @param {Clock} clock */
const chooseClock = (clock) => {
  setReplayClock(clock).catch(({ message }) => toast(message));
};

/** How far the own run is, or what came of it. */
export function OwnRun() {
  const run = ownRun.value;
  if (run === null) return null;
  const said = participantRunNarrative({
    run, distance_m: ownEntry.value?.run?.distance_m ?? run.result?.distance_m ?? null, isAway: isAway.value,
    hasArrived: replayed.value !== run.id || arrived.value.has(run.id),
  });
  if (said.isBad) return html`<p class="run-words bad" role="alert">${said.words}</p>`;
  return said.distance === undefined ? html`<${OnItsWay} ...${said} />` : html`<${Arrived} ...${said} />`;
}

/** @param {{ words: string, share?: number, isBusy?: boolean }} props */
const OnItsWay = ({ words, share, isBusy }) => html`
  <div class="run-words" role="status">
    <p>${isBusy && html`<span class="spinner" aria-hidden="true"></span> `}${words}</p>
    ${share !== undefined && html`<${ProgressBar} label="Progress of your robot" share=${share} />`}
  </div>
`;

/** @param {{ words: string, distance?: string }} props */
function Arrived({ words, distance }) {
  const given = ownEntry.value?.run?.given ?? {};
  return html`
    <div class="own-distance" role="status">
      <b class="num">${distance}</b>
      <span class="dim">${words}
        ${Object.keys(given).length > 0 && html`<br />${givenInWords(given, room.value?.shown ?? { text: "" })}`}</span>
    </div>
  `;
}
