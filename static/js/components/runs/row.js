// A run in the list: its picture, what differs and what came of it, and the chosen columns.
import { Fragment } from "preact";
import { ago } from "../../format.js";
import { COLUMNS, shownColumns } from "../../run-columns.js";
import { openDetails, subjects } from "../../run-details.js";
import { isSelected, setSelected } from "../../run-selection.js";
import { outcomeInWords, titleOf } from "../../run-words.js";
import { html } from "../elements.js";
import { Problem } from "../foot.js";
import { RunMenu } from "./menu.js";
import { Thumbnail } from "./thumbnail.js";

/** @import { Row } from "../../run-groups.js" */
/** @import { AnyRun } from "../../runs.js" */
/** @import { Run } from "../../types.js" */

/** Beside a longer name there is no room: what came of the run stands below it. */
const MAX_SHORT = 32;

/** `hasNote`: whether notes stand in the row, and not above its group. @param {{ row: Row, hasNote: boolean }} props */
export function RunRow({ row: { run, name, facts }, hasNote }) {
  const isOpen = subjects.value.length === 1 && subjects.value[0].id === run.id;
  const title = titleOf(run);
  const kind = run.kind ?? "run";
  const outcome = "damaged" in run ? "" : outcomeInWords(run);
  const isShort = name.length <= MAX_SHORT;
  return html`
    <li class=${`run ${isOpen ? "open" : ""}`}>
      <${Box} run=${run} title=${name === title ? title : `${name}: ${title}`} />
      <${Thumbnail} run=${run} />
      <div class="what">
        <p class="run-line">
          <b class="run-name" role="heading" aria-level="4">
            <button class="run-open" aria-current=${isOpen ? "true" : undefined} title=${title}
              onClick=${() => openDetails(run.id)}>${name}</button>
          </b>
          ${"damaged" in run
            ? html`<${State} state="damaged" />`
            : html`<${State} state=${run.state} run=${run} outcome=${isShort ? outcome : ""} />`}
        </p>
        <${Beside} run=${run} facts=${isShort ? facts : [outcome, ...facts].filter(Boolean)} hasNote=${hasNote} />
      </div>
      <${Cells} run=${run} />
      <${RunMenu} run=${run} label=${`More for this ${kind}`} />
      <${Problem} at=${run.id} />
    </li>
  `;
}

/**
 * Selects the run; a click with Shift selects all from the one before to it.
 * @param {{ run: AnyRun, title: string }} props
 */
function Box({ run, title }) {
  /** @param {MouseEvent & { target: HTMLInputElement }} event */
  const onClick = ({ target, shiftKey }) => setSelected(run.id, target.checked, shiftKey);
  return html`
    <label class="run-box">
      <input type="checkbox" value=${run.id} checked=${isSelected(run.id)} onClick=${onClick}
        aria-label=${`Select ${title}`} />
    </label>
  `;
}

/**
 * How a run stands, and what came of it; that it has finished is seen only where it `isTold`.
 * @param {{ state: string, run?: Run, outcome?: string, isTold?: boolean }} props
 */
export function State({ state, run, outcome = "", isTold = false }) {
  const place = run?.queue_position ? `no. ${run.queue_position}` : "";
  return html`
    <span class=${state === "finished" && !isTold ? "sr-only" : `state ${state}`}>
      <i class="dot" aria-hidden="true"></i><span>${state}</span>
    </span>
    ${(outcome || place) && html` <span class="dim outcome">${[place, outcome].filter(Boolean).join(", ")}</span>`}
  `;
}

/** The line below the name. @param {{ run: AnyRun, facts: string[], hasNote: boolean }} props */
function Beside({ run, facts, hasNote }) {
  if ("damaged" in run) return html`<p class="beside bad">${run.damaged} <span class="dim">${run.id}</span></p>`;
  const [note] = (hasNote && run.notes?.split("\n")) || [""];
  const tags = run.tags ?? [];
  return html`
    ${(facts.length > 0 || tags.length > 0) && html`
      <p class="beside dim">
        ${tags.map((tag) => html`<span class="tag" key=${tag}>${tag}</span>`)}${facts.join(" · ")}
      </p>
    `}
    ${note && html`<p class="beside run-note">${note}</p>`}
    ${run.error && html`<p class="beside bad">${run.error}</p>`}
  `;
}

/** Columns that stand on the right where all others stand below the name. */
const MAIN = ["distance", "created"];

/** @param {{ run: AnyRun }} props */
function Cells({ run }) {
  const names = shownColumns.value;
  const [minor, main] = [names.filter((name) => !MAIN.includes(name)), names.filter((name) => MAIN.includes(name))];
  return html`
    ${minor.length > 0 && html`
      <div class="cells">${minor.map((name) => html`<${Cell} key=${name} name=${name} run=${run} />`)}</div>
    `}
    ${main.map((name) => html`<${Cell} key=${name} name=${name} run=${run} />`)}
  `;
}

/** @param {{ name: string, run: AnyRun }} props */
function Cell({ name, run }) {
  if (name === "created") {
    const { created_at: at } = run;
    return html`
      <p class="cell cell-created dim">
        ${at && html`<span class="sr-only">Created </span><time datetime=${at} title=${ago(at)}>${
          COLUMNS.created.value(/** @type {Run} */ (run))}</time>`}
      </p>
    `;
  }
  const words = "damaged" in run ? "" : COLUMNS[name].value(run);
  return html`
    <p class=${`cell num cell-${name}`}>
      ${words && html`<${Fragment}><span class="label">${COLUMNS[name].title} </span>${words}<//>`}
    </p>
  `;
}
