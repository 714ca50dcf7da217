// The keys, and what the page is, in a dialog.
import { useEffect, useRef } from "preact/hooks";
import { html } from "../html.js";
import { KEYS } from "../keys.js";
import { helpIsOpen, setShortcuts, shortcuts } from "../page.js";

export function HelpDialog() {
  const dialog = useRef(null);
  const isOpen = helpIsOpen.value;
  useEffect(() => {
    if (isOpen && !dialog.current.open) dialog.current.showModal();
    if (!isOpen && dialog.current.open) dialog.current.close();
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
          Listen to single keys
        </label>
        <h2>What you see</h2>
        <p>
          A hexapod learns by trying: it moves two legs at a time, feels how far that took it, and keeps in a
          table what each move is worth. Then it races against two robots that simulate their moves before they
          make one: greedy looks one move ahead, two-step looks two. Whoever is furthest when the first robot has used its
          steps, wins; thinking costs time.
        </p>
        <form method="dialog"><button class="secondary" autofocus>Close</button></form>
      </div>
    </dialog>
  `;
}
