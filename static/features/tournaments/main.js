// Entry point of a tournament's page: of entrants and watchers, of its operator, or for the projector.
import { effect } from "@preact/signals";
import { render } from "preact";
import { Away } from "../../js/components/away.js";
import { Deletions } from "../../js/components/deletions.js";
import { html, Icon } from "../../js/components/elements.js";
import { Loaded } from "../../js/features.js";
import { codeInGroups } from "../../js/format.js";
import { followTheme, nextTheme, theme, toastMessage } from "../../js/page.js";
import { options } from "../../js/store.js";
import { Enter } from "./enter.js";
import { Operator } from "./operator.js";
import { Ranking } from "./ranking.js";
import { stateInWords } from "./states.js";
import {
  announcement, follow, id, isProjector, shownTournament, refusal, takeRestored, tournament,
} from "./tournament.js";
import { rulesInWords, walkInWords } from "./words.js";

function Page() {
  if (refusal.value) return html`<${Closed} />`;
  if (tournament.value === null || options.value === null) return html`<${Waiting} />`;
  return isProjector ? html`<${Loaded} name="projector" load=${loadProjector} />` : html`<${Whole} />`;
}

// Phones need neither before they are wanted.
const loadProjector = () => import("./projector.js").then(({ Projector }) => Projector);
const loadEnded = () => import("./ended.js").then(({ Ended }) => Ended);

const Waiting = () => html`
  <main class="door">
    <p role="status"><span class="spinner" aria-hidden="true"></span> Looking for the tournament…</p>
  </main>
`;

const Closed = () => html`
  <main class="door">
    <p class="brand"><img src="../static/favicon.svg" alt="" width="24" height="24" />Racing Hexapods</p>
    <h1>${refusal.value?.status === 404 ? "No tournament here" : "Not open to you"}</h1>
    <p role="alert">${refusal.value?.message}</p>
    <${Deletions} kind="tournaments" id=${id} take=${takeRestored} />
    <a class="secondary as-button" href="../">Go to the dashboard</a>
  </main>
`;

function Whole() {
  const { state } = shownTournament();
  return html`
    <${Header} />
    <${Away} words="This is the last that is known; entries are kept." />
    <main class="tournament">
      <${About} />
      <${Enter} />
      <div class="tournament-main">
        <${Ranking} />
        ${state === "ended" && html`<${Loaded} name="result" load=${loadEnded} />`}
      </div>
      <${Operator} />
    </main>
    <p class="sr-only" role="status">${announcement}</p>
    <div class="toast" role="status">${toastMessage.value && html`<p>${toastMessage.value.words}</p>`}</div>
  `;
}

function Header() {
  const { room } = shownTournament();
  return html`
    <header class="tournament-header">
      <a class="brand" href="../" title="Go to the dashboard">
        <img src="../static/favicon.svg" alt="" width="24" height="24" /><span>Racing Hexapods</span>
      </a>
      <span class="space"></span>
      ${room && html`
        <a class="quiet as-button" href=${`../r/${room}`}>Room <b class="code">${codeInGroups(room)}</b></a>
      `}
      <button class="quiet square" onClick=${nextTheme} aria-label=${`Theme: ${theme.value}`}
        title=${`Theme: ${theme.value}`}><${Icon} name=${theme.value} /></button>
    </header>
  `;
}

/** Title, state and rules. */
function About() {
  const { title, state, rules, commitment } = shownTournament();
  return html`
    <section class="about" aria-labelledby="tournament-title">
      <h1 id="tournament-title">${title}</h1>
      <p role="status"><b class=${`tournament-state ${state}`}>${stateInWords(state)}</b></p>
      <p class="rules">${rulesInWords(rules)}</p>
      <p class="dim">${walkInWords(rules)}</p>
      <details>
        <summary>Secret seeds, and how they are checked</summary>
        <p>
          Before the first entry the server drew a secret, from which all seeds and worlds follow. This is its SHA-256.
          At the end the secret is published: whoever computes its SHA-256 sees that the draws were fixed at the
          beginning.
        </p>
        <p><code class="digits">${commitment}</code></p>
      </details>
    </section>
  `;
}

followTheme();
document.documentElement.toggleAttribute("data-projector", isProjector);
effect(() => {
  document.title = `${tournament.value?.title ?? "Tournament"} · Racing Hexapods`;
});
follow();

const root = /** @type {HTMLElement} */ (document.getElementById("app"));
root.replaceChildren();
render(html`<${Page} />`, root);
