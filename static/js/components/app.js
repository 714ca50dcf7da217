// The page: header, the three views, and what lies over them.
import { announcement } from "../outcome.js";
import { html } from "../html.js";
import { place } from "../page.js";
import { isLockedOut } from "../store.js";
import { Experiments } from "./experiments/experiments.js";
import { Header } from "./header.js";
import { HelpDialog } from "./help.js";
import { RaceView } from "./race-view.js";
import { Runs } from "./runs.js";
import { Toast } from "./toast.js";

export function App() {
  return html`
    <a class="skip" href="#main" onClick=${skip}>Skip to the page</a>
    <${Header} />
    <main id="main" tabindex="-1">
      ${isLockedOut.value ? html`<${LockedOut} />` : html`
        <${RaceView} isHidden=${place.value !== "race"} />
        ${place.value === "experiments" && html`<${Experiments} />`}
        ${place.value === "runs" && html`<${Runs} />`}
      `}
    </main>
    <${HelpDialog} />
    <${Toast} />
    <p class="sr-only" role="status">${announcement}</p>
  `;
}

const LockedOut = () => html`
  <section class="panel locked">
    <h2>This show needs a link</h2>
    <p>Whoever runs this server shows it only to those who have its link. Open that link once, and this page remembers it.</p>
  </section>
`;

/** The hash names the view, so the link moves the focus itself. */
function skip(event) {
  event.preventDefault();
  document.getElementById("main").focus();
}
