// The presenter's remote, on a phone: it commands the stage that all share, and every presenter's window of it.
import { canStart, endAtTimeOut, primaryAction, runPrimaryAction, togglePlaying } from "../../js/actions.js";
import { deck } from "../../js/features.js";
import { isPlaying } from "../../js/on-stage.js";
import { CODES, presentation, tell, toggleBlank, toggleWhy, turnPage } from "./presentation.js";
import { page } from "../../js/page-state.js";
import { stage } from "../../js/store.js";
import { html, Icon, Segments } from "../../js/components/elements.js";
import { Problem } from "../../js/components/foot.js";

export function Remote() {
  const { card, shows_why, is_blank, code } = presentation.value;
  const { cards } = deck.value;
  const shown = card === null ? null : cards.value[card - 1];
  const next = cards.value[card ?? 0];
  const endsAtTimeOut = stage.value?.end_at_time_out ?? true;
  return html`
    <section class="remote" aria-label="Remote of the presentation">
      <h2>${shown ? `${card}. ${shown.title}` : "No card is shown"}</h2>
      <p class="dim">${shown?.text ?? "The first card comes with “Next”."}</p>
      <div class="row">
        <button class="secondary" disabled=${(card ?? 0) <= 1} onClick=${() => turnPage(-1)}>Back</button>
        <button class="primary" disabled=${!next} onClick=${() => turnPage(1)}>
          ${next ? `Next: ${next.title}` : "That was the last card"}
        </button>
      </div>
      <div class="remote-buttons">
        <${Toggle} isOn=${!isPlaying.value} onClick=${togglePlaying} icon=${isPlaying.value ? "pause" : "play"}
          words=${isPlaying.value ? "Pause" : "Play"} />
        <${Toggle} isOn=${shows_why} onClick=${toggleWhy} icon="edit" words="Show why" />
        <${Toggle} isOn=${endsAtTimeOut} onClick=${() => endAtTimeOut(!endsAtTimeOut)} icon="flag"
          words="End at time-out" />
        <${Toggle} isOn=${is_blank} onClick=${toggleBlank} icon="stop" words="Blank" />
      </div>
      <${Segments} label="QR code" value=${code} onValue=${(/** @type {any} */ size) => tell({ code: size })}
        choices=${CODES.map((size) => [size, `Code ${size}`])} />
      <button class="secondary" aria-disabled=${canStart.value ? undefined : "true"} onClick=${runPrimaryAction}>
        ${primaryAction.value.label}
      </button>
      <${Problem} at="stage" /><${Problem} at="start" />
      <button class="quiet" onClick=${() => (page.isRemote.value = false)}>Leave the remote</button>
    </section>
  `;
}

/** @param {{ isOn: boolean, onClick: () => unknown, icon: any, words: string }} props */
const Toggle = ({ isOn, onClick, icon, words }) => html`
  <button class="secondary" aria-pressed=${isOn ? "true" : "false"} onClick=${onClick}>
    <${Icon} name=${icon} />${words}
  </button>
`;
