// The presenter's panel below the stage: the card, what comes next, and how others can watch.
import { useEffect, useState } from "preact/hooks";
import { call } from "../../js/api.js";
import { canStart, primaryAction, runPrimaryAction } from "../../js/actions.js";
import { narrative } from "../../js/headline.js";
import { deck } from "../../js/features.js";
import { presentation, toggleBlank, turnCode, turnPage } from "./presentation.js";
import { canPlay } from "../../js/on-stage.js";
import { enterFullScreen, isFullScreen, leavePresenter } from "./presenting.js";
import { isOperator } from "../../js/selectors.js";
import { connection, isAway, viewers } from "../../js/store.js";
import { html } from "../../js/components/elements.js";

/** @import { Spectators } from "../../js/types.js" */

export function PresenterPanel() {
  const { code, is_blank } = presentation.value;
  const spectators = useSpectators();
  return html`
    <section class=${`panel projection-controls code-${code}`} aria-label="Presenter’s panel">
      <h1 class="sr-only">Racing Hexapods</h1>
      <${Act} />
      <${Keys} />
      ${code !== "none" && html`<${Address} known=${spectators} />`}
    </section>
    ${is_blank && html`
      <button class="blank" onClick=${toggleBlank} aria-label="Show the page again"></button>
    `}
  `;
}

/** Where others can watch; asked again when the server comes back, as it may have another address. */
export function useSpectators() {
  const [spectators, setSpectators] = useState(/** @type {Spectators & { problem?: string } | null} */ (null));
  const state = connection.value;
  useEffect(() => {
    if (state !== "live") return;
    call("GET", "spectators").then(setSpectators, ({ message }) =>
      setSpectators(/** @type {any} */ ({ problem: message })));
  }, [state]);
  return spectators;
}

/** The card that is shown, and the one that comes next. */
function Act() {
  const { card: number } = presentation.value;
  const { cards: { value: cards }, number: { value: open }, Question } = deck.value;
  const shown = number === null ? null : cards[number - 1] ?? cards[(open ?? 0) - 1];
  const next = cards[number ?? 0];
  return html`
    <div class="act">
      ${number !== null && html`<span class="card-number">Card ${number} of ${cards.length}</span>`}
      <h2>${shown ? shown.title : "Racing Hexapods"}</h2>
      <p>${shown ? shown.text : "They learn to walk by trial and error, and race against two that think ahead."}</p>
      ${shown?.ask && html`<${Question} />`}
      ${next && html`<p class="dim">Next: card ${(number ?? 0) + 1}, “${next.title}”.</p>`}
    </div>
  `;
}

/** @param {{ known: ReturnType<typeof useSpectators> }} props */
const Address = ({ known }) => html`
  <div class="watch-along">
    ${known?.qr_code && html`<img class="qr-code" src=${known.qr_code} alt=${`QR code of ${known.address}`} />`}
    <div>
      <h2>Watch along</h2>
      ${known?.address
        ? html`<p class="address">${known.address.replace(/^http:\/\/|\/$/g, "")}</p>`
        : html`<p class="dim" role="status">${known?.reason ?? known?.problem}</p>`}
      <p class="watching-count"><b>${isAway.value ? "…" : viewers.value ?? known?.watching ?? "…"}</b> watching</p>
    </div>
  </div>
`;

const Keys = () => html`
  <div class="presenter-keys">
    ${isOperator.value && html`
      <button class="primary" onClick=${() => turnPage(1)}>Next card</button>
      <p><kbd>→</kbd> next</p>
      <button class="quiet" onClick=${runPrimaryAction} aria-disabled=${canStart.value ? undefined : "true"}>
        <kbd>R</kbd> ${primaryAction.value.label}
      </button>
      <button class="quiet" onClick=${turnCode}><kbd>Q</kbd> code</button>
    `}
    ${canPlay.value && html`<p><kbd>Space</kbd> ${narrative.value.play.isPlaying ? "pause" : "play"}</p>`}
    ${!isFullScreen.value && document.fullscreenEnabled && html`
      <button class="quiet" onClick=${enterFullScreen}>Full screen</button>
    `}
    <button class="quiet" onClick=${leavePresenter}><kbd>Esc</kbd> leave</button>
  </div>
`;
