// The page: header, the three views, dialogs and messages.
import { announcement } from "../outcome.js";
import { html } from "../html.js";
import { place } from "../page.js";
import { isLockedOut, options } from "../store.js";
import { Experiments } from "./experiments/experiments.js";
import { Header } from "./header.js";
import { HelpDialog } from "./help.js";
import { RaceView } from "./race-view.js";
import { Runs } from "./runs.js";
import { Toast } from "./toast.js";

export const App = () => html`
  <a class="skip" href="#main" onClick=${focusMain}>Skip to the page</a>
  <${Header} />
  <main id="main" tabindex="-1"><${Main} /></main>
  <${HelpDialog} />
  <${Toast} />
  <p class="sr-only" role="status">${announcement}</p>
`;

function Main() {
  if (isLockedOut.value) return html`<${LockedOut} />`;
  if (options.value === null) return html`<${Loading} />`;
  return html`
    <${RaceView} isHidden=${place.value !== "race"} />
    ${place.value === "experiments" && html`<${Experiments} />`}
    ${place.value === "runs" && html`<${Runs} />`}
  `;
}

const LockedOut = () => html`
  <section class="panel locked">
    <h2>This page needs a link</h2>
    <p>This server shows the page only to those who have its link. Open that link once; the page remembers it.</p>
  </section>
`;

const Loading = () => html`
  <section class="panel locked">
    <p role="status"><span class="spinner" aria-hidden="true"></span> Loading gaits, robots, agents and settings…</p>
  </section>
`;

/** The hash names the view, so a link cannot move the focus by itself. */
function focusMain(event) {
  event.preventDefault();
  document.getElementById("main")?.focus();
}
