// The choice of a gait by drawings.
import { form, setField } from "../form.js";
import { html } from "../html.js";
import { served } from "../store.js";
import { showHelp } from "./setting-help.js";
import { HexapodGlyph } from "./hexapod-glyph.js";

export const GaitPicker = () => html`
  <fieldset onFocusIn=${showHelp("gait")} onPointerEnter=${showHelp("gait")}>
    <legend><h2>Gait</h2></legend>
    <div class="gait-row">
      ${served().gaits.map((gait) => html`
        <label class="gait" key=${gait.name}>
          <input class="sr-only" type="radio" name="gait" value=${gait.name}
            checked=${gait.name === form.value.gait} onChange=${() => setField("gait", gait.name)} />
          <${HexapodGlyph} gait=${gait} />
          <span>${gait.title}</span>
        </label>
      `)}
    </div>
  </fieldset>
`;
