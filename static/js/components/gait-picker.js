// The four gaits, drawn.
import { set, form } from "../form.js";
import { html } from "../html.js";
import { options } from "../store.js";
import { showHelp } from "./setting-help.js";
import { HexapodGlyph } from "./hexapod-glyph.js";

const titleOf = (gait) => (gait.title ?? gait.name).replace(/-(?=\w+$)/, " ");

export function GaitPicker() {
  const gaits = options.value?.gaits ?? [];
  return html`
    <fieldset onFocusIn=${showHelp("gait")} onPointerEnter=${showHelp("gait")}>
      <legend><h2>Gait</h2></legend>
      <div class="gait-row">
        ${gaits.length === 0 && [0, 1, 2, 3].map(() => html`<span class="gait loading" aria-hidden="true"></span>`)}
        ${gaits.map((gait) => html`
          <label class="gait" key=${gait.name}>
            <input class="sr-only" type="radio" name="gait" value=${gait.name}
              checked=${gait.name === form.value.gait} onChange=${() => set("gait", gait.name)} />
            <${HexapodGlyph} gait=${gait} />
            <span>${titleOf(gait)}</span>
          </label>
        `)}
      </div>
    </fieldset>
  `;
}
