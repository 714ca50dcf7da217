// The help dialog: keys, and what the page shows.
import { useEffect, useRef } from "preact/hooks";
import { html } from "../html.js";
import { KEYS } from "../keys.js";
import { helpIsOpen, setShortcuts, shortcuts } from "../page.js";

export function HelpDialog() {
  const dialog = useRef(/** @type {HTMLDialogElement | null} */ (null));
  const isOpen = helpIsOpen.value;
  useEffect(() => {
    if (isOpen && !dialog.current?.open) dialog.current?.showModal();
    if (!isOpen) dialog.current?.close();
  }, [isOpen]);
  const close = () => (helpIsOpen.value = false);
  const onBackdrop = (event) => event.target === dialog.current && close();
  return html`
    <dialog class="help" ref=${dialog} onClose=${close} onClick=${onBackdrop} aria-labelledby="help-title">
      <div class="help-body">
        <h2 id="help-title">Keys</h2>
        <dl class="keys">
          ${KEYS.map(([key, does]) => html`<div><dt><kbd>${key}</kbd></dt><dd>${does}</dd></div>`)}
        </dl>
        <label class="check">
          <input type="checkbox" checked=${shortcuts.value} onChange=${(e) => setShortcuts(e.target.checked)} />
          Use single keys
        </label>
        <h2>What you see</h2>
        <p>
          A hexapod learns by trial and error: it moves two legs at a time, measures how far that took it, and
          keeps in a table what each move is worth. Then it races against two robots that simulate their moves
          before they make one: greedy looks one step ahead, two-step looks two. The race ends at time-out, when
          the first robot has used its steps; the robot that is furthest then wins. Thinking costs time.
        </p>
        <form method="dialog"><button class="secondary" autofocus>Close</button></form>
      </div>
    </dialog>
  `;
}
