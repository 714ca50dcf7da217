// Who we are, where one can go, whether it is live, and the page's own switches.
import { share } from "../actions.js";
import { html } from "../html.js";
import { helpIsOpen, place } from "../page.js";
import { connection, viewers } from "../store.js";
import { nextTheme, theme } from "../theme.js";
import { Icon } from "./icon.js";

const VIEWS = [["race", "Race", "#"], ["experiments", "Experiments", "#experiments"], ["runs", "Runs", "#runs"]];

export const Header = () => html`
  <header class="header">
    <h1 class="brand"><img src="static/favicon.svg" alt="" width="24" height="24" />Racing Hexapods</h1>
    <nav class="nav" aria-label="Views">
      ${VIEWS.map(([name, title, href]) => html`
        <a href=${href} aria-current=${place.value === name ? "page" : undefined}>${title}</a>
      `)}
    </nav>
    <${Live} />
    <div class="switches">
      <button class="quiet" onClick=${share} title="Copy a link that carries every setting">
        <${Icon} name="link" /><span class="wide-only">Share</span>
        <span class="sr-only narrow-only">Share</span>
      </button>
      <button class="quiet square" onClick=${nextTheme} title="Light, dark, or as the system has it"
        aria-label=${`Theme: ${theme.value}. Change it`}>
        <${Icon} name=${theme.value} />
      </button>
      <button class="quiet square" onClick=${() => (helpIsOpen.value = true)}
        title="Keys and help" aria-label="Keys and help">?</button>
    </div>
  </header>
`;

const STATES = { connecting: "connecting", reconnecting: "reconnecting" };

function Live() {
  const state = connection.value;
  const watching = viewers.value ? html` · ${viewers.value}<span class="roomy"> watching</span>` : "";
  return html`
    <p class=${`live ${state}`}>
      <span class="dot" aria-hidden="true"></span>
      <span>${STATES[state] ?? html`live${watching}`}</span>
    </p>
  `;
}
