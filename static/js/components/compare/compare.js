// The view that compares runs: which, their learning curves, results, settings, and replays.
import { compared, comparable, followCompared, leaveOut, leftOut, MAX_COMPARED } from "../../compare.js";
import { count } from "../../format.js";
import { commonFacts } from "../../run-words.js";
import { isActive } from "../../selectors.js";
import { html } from "../elements.js";
import { Slot } from "../../features.js";
import { ReplayLink } from "../replay-link.js";
import { Curves } from "./curves.js";
import { Key } from "./key.js";
import { RaceThem } from "./race-them.js";
import { Results, Settings } from "./tables.js";

/** @import { Compared } from "../../compare.js" */

followCompared();

export function Compare() {
  const all = compared.value;
  if (all.length === 0) return html`<div class="compare alone"><${Nothing} /></div>`;
  const isEnough = comparable.value.length > 1;
  return html`
    <div class="compare">
      <section class="compared-column" aria-labelledby="compare-title">
        <div class="details-head">
          <h2 id="compare-title">Compare ${count(all.length, "run")}</h2>
          <a href="#runs">Choose others</a>
          <p class="dim details-facts">${commonFacts(comparable.value.map(({ run }) => run)).join(" · ")}</p>
        </div>
        <div class="details-body">
          <ul class="compared">${all.map((entry) => html`<${ComparedRun} key=${entry.id} one=${entry} />`)}</ul>
          ${leftOut.value > 0 && html`
            <p class="notice" role="status">
              Up to ${MAX_COMPARED} runs are compared; the link names ${leftOut.value} more, which are left out.
            </p>
          `}
        </div>
        <div class="details-foot"><${RaceThem} runs=${comparable.value.map(({ run }) => run)} /></div>
      </section>
      <div class="compared-parts">${isEnough ? html`<${Parts} />` : html`<${TooFew} />`}</div>
    </div>
  `;
}

const Parts = () => html`
  <${Curves} />
  <${Results} />
  <${Settings} />
  <${Slot} name="comparison" />
`;

const Nothing = () => html`
  <section class="panel compare-none" aria-labelledby="compare-title">
    <h2 id="compare-title">Compare runs</h2>
    <p class="dim">
      Select two runs or more in the list, and press Compare: their learning curves are laid over each other, and
      settings and results stand side by side.
    </p>
    <a class="secondary button" href="#runs">Go to the list</a>
  </section>
`;

function TooFew() {
  const isLoading = compared.value.some(({ run, problem }) => !run && !problem);
  return isLoading
    ? html`
      <section class="panel">
        <p role="status"><span class="spinner" aria-hidden="true"></span> Loading the runs…</p>
      </section>
    `
    : html`
      <section class="panel compare-none">
        <p>It takes two runs to compare. <a href="#runs">Choose another in the list</a>.</p>
      </section>
    `;
}

/** @param {{ one: Compared }} props */
function ComparedRun({ one: entry }) {
  const { id, letter, title, run, problem } = entry;
  return html`
    <li>
      <${Key} one=${entry} />
      <span class="compared-run">
        <b>${title}</b>
        ${run && html` <span class="dim">${run.kind}, ${run.state}</span>`}
        ${problem && html` <span class="bad" role="alert">${problem}</span>`}
        ${!run && !problem && html` <span class="dim" role="status">loading…</span>`}
      </span>
      ${run && run.progress.done > 0 && html`
        <span class="compared-links">
          <${ReplayLink} id=${id} label=${`Replay ${letter}`}>Replay<//>
          <${GhostLink} one=${entry} />
        </span>
      `}
      <button class="quiet square small" aria-label=${`Leave out ${title}`} title="Leave out"
        onClick=${() => leaveOut(id)}>✕</button>
    </li>
  `;
}

/**
 * A replay of the first run with this one's robots as ghosts, or of this one with the first's.
 * @param {{ one: Compared }} props
 */
function GhostLink({ one: entry }) {
  const [first] = comparable.value;
  if (!first?.run || !entry.run || first.id === entry.id) return null;
  if (first.run.kind !== entry.run.kind || !first.run.progress.done) return null;
  const [shown, ghost] = isActive(entry.run) ? [entry, first] : [first, entry];
  if (isActive(ghost.run)) return null;
  const words = `${shown.letter} with ${ghost.letter} as ghost`;
  return html`<${ReplayLink} id=${shown.id} ghost=${ghost.id} label=${`Replay ${words}`}>${words}<//>`;
}
