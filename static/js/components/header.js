// The header: navigation, connection state, sharing, theme and help.
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
    <${Connection} />
    <div class="switches">
      <button class="quiet" onClick=${share} title="Copy a link that contains every setting">
        <${Icon} name="link" /><span class="wide-only">Share</span>
        <span class="sr-only narrow-only">Share</span>
      </button>
      <button class="quiet square" onClick=${nextTheme} title="Light, dark, or the system's theme"
        aria-label=${`Theme: ${theme.value}. Change it`}>
        <${Icon} name=${theme.value} />
      </button>
      <button class="quiet square" onClick=${() => (helpIsOpen.value = true)}
        title="Keys and help" aria-label="Keys and help">?</button>
    </div>
  </header>
`;

function Connection() {
  const state = connection.value;
  const watching = viewers.value ? html` · ${viewers.value}<span class="roomy"> watching</span>` : "";
  return html`
    <p class=${`live ${state}`}>
      <span class="dot" aria-hidden="true"></span>
      <span>${state === "live" ? html`live${watching}` : state}</span>
    </p>
  `;
}
