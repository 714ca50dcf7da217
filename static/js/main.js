// Starts the page: what can be chosen, what happens, and what is drawn of it.
import { effect } from "@preact/signals";
import { render } from "preact";
import { getOptions } from "./api.js";
import { App } from "./components/app.js";
import { followCurves } from "./curves.js";
import { openEvents } from "./events.js";
import { announceExperiments } from "./experiments/announce.js";
import { followAddress } from "./experiments/address.js";
import { followExperiments } from "./experiments/selection.js";
import { followSummary } from "./experiments/summaries.js";
import { readAddress, useDefaults, writeAddress } from "./form.js";
import { html } from "./html.js";
import { listenForKeys } from "./keys.js";
import { announceOutcomes } from "./outcome.js";
import { applyEvent, connection, isLockedOut, options, version } from "./store.js";
import { followTheme } from "./theme.js";
import { followTimeline } from "./timeline.js";
import { followWhatIf } from "./what-if.js";

async function loadOptions(attempt = 0) {
  try {
    options.value = await getOptions();
    isLockedOut.value = false;
  } catch (error) {
    isLockedOut.value = error.status === 401 || error.status === 403;
    setTimeout(loadOptions, Math.min(500 * 2 ** attempt, 8000), attempt + 1);
    return;
  }
  useDefaults(options.value);
  readAddress();
  writeAddress();
  followWhatIf();
}

/** A server of another version came back under this page, whose scripts may no longer fit. */
function reloadAfterUpgrade() {
  let first = null;
  effect(() => {
    first ??= version.value;
    if (version.value !== first) location.reload();
  });
}

followTheme();
reloadAfterUpgrade();
followCurves();
followTimeline();
followAddress();
followExperiments();
followSummary();
announceOutcomes();
announceExperiments();
listenForKeys();
openEvents(applyEvent, (state) => (connection.value = state));
loadOptions();

const root = document.getElementById("app");
root.replaceChildren();
render(html`<${App} />`, root);
