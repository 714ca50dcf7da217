// The report of an experiment as one file: what the page shows of its summary, from the data that the file has. It is
// complete without a server, and asks for nothing.
import { render } from "preact";
import { html } from "../../js/components/elements.js";
import { options } from "../../js/settings.js";
import { Findings } from "./components/all-findings.js";
import { followPrinting } from "./printing.js";
import { comparable, firstPair } from "./profiles.js";
import { configInWords, findingIn } from "./words.js";

/** @import { Run, Summary } from "../../js/types.js" */

/** What else the file tells. @typedef {{ title: string, command: string }} Report */

/** The data of a block. @param {string} id */
const dataOf = (id) => JSON.parse(document.getElementById(id)?.textContent ?? "null");

/** @type {{ pairs: { keys: string[] }[] }} */
const comparisons = dataOf("comparisons");

/** A comparison that the file has. @type {import("./components/two-settings.js").Compare} */
function storedComparison(a, b) {
  const stored = comparisons.pairs.find(({ keys }) => keys.includes(a) && keys.includes(b));
  const command = `hexapods compare FOLDER ${a} ${b}`;
  return stored
    ? Promise.resolve(/** @type {any} */ (stored))
    : Promise.reject(new Error(`This file has no comparison of these two; the command line makes it: ${command}`));
}

/** The first pair, or the first one whose comparison the file has. @param {Summary} summary */
function firstStoredPair(summary) {
  const [a, b] = firstPair(comparable(summary));
  const isStored = comparisons.pairs.some(({ keys }) => keys.includes(a) && keys.includes(b));
  return isStored ? [a, b] : comparisons.pairs[0]?.keys ?? null;
}

const FILES = "summary.json has all numbers of this page, trials.csv every trial.";

/** @param {{ summary: Summary, report: Report }} props */
const OfflineReport = ({ summary, report }) => html`
  <header>
    <p class="dim">Racing Hexapods: Q-learning against uninformed search</p>
    <h1>${report.title}</h1>
  </header>
  <main class="report">
    <div class="report-body">
      <div class="gist">
        ${findingIn(summary) && html`<p class="finding">${findingIn(summary)}</p>`}
        <p class="dim">${configInWords(/** @type {Run["config"]} */ (/** @type {unknown} */ (summary.config)))}</p>
      </div>
      <${Findings} summary=${summary} compare=${storedComparison} firstPair=${firstStoredPair(summary)}
        more=${[["Command", html`<code>${report.command}</code>`], ["Files", FILES]]} />
    </div>
  </main>
`;

options.value = dataOf("options");
render(html`<${OfflineReport} summary=${dataOf("summary")} report=${dataOf("report")} />`, document.body);
followPrinting();
