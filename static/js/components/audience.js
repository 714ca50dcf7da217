// The presenter view's strip below the picture: where others can watch, as an address and a QR code, how many do, and
// the rule of the race with the figures that decide it.
import { useEffect, useState } from "preact/hooks";
import { getSpectators } from "../api.js";
import { canStart, primaryAction, runPrimaryAction } from "../actions.js";
import { enterFullScreen, isFullScreen, leavePresenter } from "../page.js";
import { reason, ruleOf } from "../headline.js";
import { canPlay, clock } from "../on-stage.js";
import { standings } from "../race.js";
import { isOperator } from "../selectors.js";
import { connection, viewers } from "../store.js";
import { clockTitle } from "../titles.js";
import { html } from "./elements.js";

/** @import { Spectators } from "../types.js" */
/** @import { RequestError } from "../api.js" */

export function Audience() {
  const [known, setKnown] = useState(/** @type {Spectators | null} */ (null));
  const [problem, setProblem] = useState("");
  const state = connection.value;
  useEffect(() => {
    // A server that comes back may have another address.
    if (state === "live") getSpectators().then(setKnown, (error) => setProblem(error.message));
  }, [state]);
  return html`
    <section class="panel audience" aria-labelledby="audience-title">
      ${known?.qr_code && html`<img class="qr-code" src=${known.qr_code} alt=${`QR code of ${known.address}`} />`}
      <h1 class="sr-only">Racing Hexapods</h1>
      <div class="audience-words">
        <h2 id="audience-title">Watch along</h2>
        <${Address} known=${known} problem=${problem} />
        <p class="watching-count"><b>${viewers.value ?? known?.watching ?? "…"}</b> watching</p>
      </div>
      <${Rule} />
      <${Keys} />
    </section>
  `;
}

/** @param {{ known: Spectators | null, problem: RequestError | null }} props */
function Address({ known, problem }) {
  if (known?.address) return html`<p class="address">${known.address.replace(/^http:\/\/|\/$/g, "")}</p>`;
  return html`<p class="dim" role="status">${known?.reason || problem}</p>`;
}

/** By what a race is ranked and timed, and the figures that have decided so far. */
function Rule() {
  const [row] = standings.value ?? [];
  return row && html`
    <div class="audience-rule">
      <p>${ruleOf(row.steps, clockTitle(clock.value))}</p>
      ${reason.value && html`<p><b>${reason.value}</b></p>`}
    </div>
  `;
}

const Keys = () => html`
  <div class="presenter-keys">
    ${isOperator.value && html`
      <button class="quiet" onClick=${runPrimaryAction} aria-disabled=${canStart.value ? undefined : "true"}>
        <kbd>R</kbd> ${primaryAction.value.label}
      </button>
    `}
    ${canPlay.value && html`<p><kbd>Space</kbd> Pause and play</p>`}
    ${!isFullScreen.value && document.fullscreenEnabled && html`
      <button class="quiet" onClick=${enterFullScreen}>Full screen</button>
    `}
    <button class="quiet" onClick=${leavePresenter}><kbd>Esc</kbd> Leave</button>
  </div>
`;
