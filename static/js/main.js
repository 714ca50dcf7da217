// Entry point: loads the options, opens the event stream, renders the page.
import { effect, untracked } from "@preact/signals";
import { render } from "preact";
import { addressOf, getStage } from "./api.js";
import { App } from "./components/app.js";
import { html } from "./components/elements.js";
import { listenForFiles } from "./components/dropping.js";
import { listenForKeys, listenForMenus } from "./components/keyboard.js";
import { openEvents } from "./events.js";
import { openForm } from "./form.js";
import { windowTitle } from "./on-stage.js";
import { addCodeFor, features, followFields, installFeatures } from "./features.js";
import { followHistory, page, reload } from "./page-state.js";
import { followTheme } from "./page.js";
import { announceOutcomes, headline } from "./headline.js";
import { followTimeline } from "./race.js";
import { followPlayer, isOwn } from "./player.js";
import { followRuns, stageIds } from "./runs.js";
import {
  applyEvent, connection, eventNames, followOptions, isLockedOut, isLockOut, role, version,
} from "./store.js";
import { followCurves, trainingsInView } from "./training.js";
import { followChartDepth } from "./workspace.js";

/** Open the forms; the options are there. */
function openForms() {
  openForm();
  features.value.forEach(({ withOptions }) => withOptions?.());
  effect(() => {
    // If that fails, again once the connection is back.
    if (role.value !== "spectator" || connection.value !== "live") return;
    import("./spectators.js").then(({ followStageSettings }) => untracked(followStageSettings), () => {});
  });
}

/** Reload when the server comes back in another version, which these scripts may not fit. */
function reloadAfterUpgrade() {
  /** @type {string | null} */
  let first = null;
  effect(() => {
    first ??= version.value;
    if (version.value !== first) reload();
  });
}

/** Load the code of features that pages of this role need; if that fails, again once the connection is back. */
const followRole = () => effect(() => {
  const isLive = connection.value === "live";
  if (isLive && role.value) addCodeFor(role.value).catch(() => {});
});

/** Keep the window's title: what is shown, in a list of tabs. */
const followTitle = () => effect(() => {
  document.title = windowTitle(page.view.value, headline.value);
});

await installFeatures();
followHistory();
followFields();
features.value.forEach(({ follow }) => follow?.());
followTheme();
followChartDepth();
followRole();
reloadAfterUpgrade();
followRuns(stageIds);
followCurves(trainingsInView);
followTimeline();
followPlayer();
announceOutcomes();
followTitle();
listenForKeys();
listenForMenus();
listenForFiles();
openEvents(eventNames(), applyEvent, (state) => {
  connection.value = state;
  if (state === "live") isLockedOut.value = false;
  // The stream does not say why it ended: the server may have come back with a token.
  if (state === "reconnecting") getStage().catch((error) => (isLockedOut.value = isLockOut(error)));
}, () => ({ stream: addressOf(`events?picture=${!isOwn.value}`), snapshot: addressOf("events/snapshot") }));
followOptions(openForms);

const root = /** @type {HTMLElement} */ (document.getElementById("app"));
root.replaceChildren();
render(html`<${App} />`, root);
