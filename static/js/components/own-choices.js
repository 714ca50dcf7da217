// What a spectator can do on their own page, while the stage goes on for all.
import { downloads } from "../files.js";
import { tryOwnSettings } from "../form.js";
import { isOwn, openReplay, position } from "../player.js";
import { clock, shownRun } from "../on-stage.js";
import { isActive, isWalk } from "../selectors.js";
import { isAway } from "../store.js";
import { html, Icon } from "./elements.js";
import { Slot } from "../features.js";

/** @import { Run } from "../types.js" */

export function OwnChoices() {
  const run = shownRun.value;
  const canReplay = run !== null && isWalk(run) && Boolean(run?.progress?.done);
  return html`
    <div class="own-choices">
      ${!isOwn.value && run && canReplay && html`
        <button class="secondary compact" disabled=${isAway.value} onClick=${() => replay(run)}
          title="Play, seek and go step by step for yourself"><${Icon} name="replay" />Replay</button>
      `}
      <button class="secondary compact" onClick=${tryOwnSettings}>Try other settings</button>
    </div>
    ${canReplay && !isActive(run) && html`<${Files} run=${run} />`}
  `;
}

/** @param {Run} run */
const replay = (run) => openReplay(run.id, { time_s: position.peek(), clock: clock.value });

/** @param {{ run: Run }} props */
const Files = ({ run }) => html`
  <details class="more">
    <summary>Download it</summary>
    <div class="own-choices">
      ${downloads(run).map(([label, href]) => html`<a class="to-report" href=${href} download="">${label}</a>`)}
      <${Slot} name="files of a walk" run=${run} look="to-report" />
    </div>
  </details>
`;
