// What came of it, on a participant's phone: the class, and thirty ideal robots. Loaded by those who have joined.
import { DotStrip } from "../../../js/components/dot-strip.js";
import { html } from "../../../js/components/elements.js";
import { count, metres, t } from "../../../js/format.js";
import { ownEntry, shownResults } from "./room.js";
import { axisOf } from "./scores.js";

/** @import { WhatIfAnswer } from "../../../js/types.js" */

/** Thirty ideal robots with these settings, beside the defaults. @param {{ answer: WhatIfAnswer }} props */
export function WhatIfDots({ answer }) {
  const far = 1.06 * Math.max(answer.greedy_m, ...answer.chosen.distances_m, ...answer.default.distances_m);
  return html`
    <section class="phone-part" aria-label="Thirty robots">
      ${[[t("With these settings"), answer.chosen], [t("With the defaults"), answer.default]].map(([of, half]) => {
        const title = String(of);
        const { distances_m, iqm_m } = /** @type {WhatIfAnswer["chosen"]} */ (half);
        return html`
          <p><b>${title}</b>: typically ${metres(iqm_m)}</p>
          <${DotStrip} label=${t("{title}: typically {distance}", { title, distance: metres(iqm_m) })}
            points=${distances_m} high=${far} low=${Math.min(0, ...distances_m)} typical=${{ iqm: iqm_m }}
            axis=${metres} />
        `;
      })}
    </section>
  `;
}

/** The distances of the class, with the own one among them. */
export function ClassDots() {
  const { distances_m, interval } = /** @type {NonNullable<typeof shownResults.value>} */ (shownResults.value);
  const ownRun = ownEntry.value?.run ?? null;
  const { low, high } = axisOf(distances_m);
  const typical = interval && { iqm: interval.iqm_m, low: interval.low_m, high: interval.high_m };
  const all = count(distances_m.length, "seed");
  const ends = { low: metres(distances_m[0]), high: metres(distances_m.at(-1)) };
  const rank = ownRun?.rank ? t("Rank {rank} of {all}", { rank: ownRun.rank, all }) : all;
  return html`
    <h2>${rank}</h2>
    <${DotStrip} label=${t("{rank}, from {low} to {high}", { rank, ...ends })} size=${1.6}
      points=${distances_m} low=${low} high=${high} typical=${typical} axis=${metres}
      own=${ownRun?.distance_m ?? null} />
    <p class="dim">
      ${ownRun && html`<span class="own-key">your robot</span> ${metres(ownRun.distance_m)}, `}
      ${t("the class typically {distance}", { distance: metres(interval?.iqm_m) })}
      ${interval && interval.low_m !== null && html` (95 %: ${metres(interval.low_m)} to ${metres(interval.high_m)})`}
    </p>
  `;
}
