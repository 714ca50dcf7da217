// Every run that there is: filter, show, take away, delete.
import { useState } from "preact/hooks";
import { listRuns } from "../api.js";
import { html } from "../html.js";
import { everyRun } from "../selectors.js";
import { damagedRuns, keepRun } from "../store.js";
import { DamagedRunRow } from "./damaged-run-row.js";
import { ExperimentRunRow } from "./experiments/experiment-run-row.js";
import { RunRow } from "./run-row.js";
import { Segments } from "./segments.js";

const KINDS = [["all", "All"], ["training", "Trainings"], ["race", "Races"], ["experiment", "Experiments"]];
const STATES = ["any state", "running", "paused", "queued", "finished", "stopped", "failed", "interrupted"];

export function Runs() {
  const [kind, setKind] = useState("all");
  const [state, setState] = useState("any state");
  const all = [...damagedRuns.value.values(), ...everyRun.value];
  const shown = all.filter(
    (run) =>
      (kind === "all" || (run.kind ?? kind) === kind) && (state === "any state" || run.state === state),
  );
  return html`
    <section class="panel runs" aria-labelledby="runs-title">
      <div class="runs-head">
        <h2 id="runs-title">Runs</h2>
        <${Segments} label="Kind" choices=${KINDS} value=${kind} onValue=${setKind} />
        <label class="choice">
          <span class="sr-only">State</span>
          <select onChange=${({ target }) => setState(target.value)}>
            ${STATES.map((one) => html`<option selected=${one === state}>${one}</option>`)}
          </select>
        </label>
      </div>
      ${shown.length === 0
        ? html`<${NoRuns} isFiltered=${all.length > 0} />`
        : html`<ul>${shown.map((run) => html`<${rowOf(run)} key=${run.id} run=${run} />`)}</ul>`}
      <${Older} count=${all.length} />
    </section>
  `;
}

const rowOf = (run) => (run.damaged ? DamagedRunRow : run.kind === "experiment" ? ExperimentRunRow : RunRow);

const NoRuns = ({ isFiltered }) => html`
  <div class="no-runs">
    ${isFiltered
      ? html`<p>No run is of this kind and state.</p>`
      : html`<p><b>Nothing has run.</b></p><p>Every training, race and experiment is kept here, with its curve, its table, its recording or its report. <a href="#">Start the first one</a>.</p>`}
  </div>
`;

/** The snapshot has the newest fifty; the rest comes when asked for. */
function Older({ count }) {
  const [cursors, setCursors] = useState({ training: "", race: "", experiment: "" });
  const [note, setNote] = useState("");
  if (count < 50 || Object.values(cursors).every((cursor) => cursor === null)) return null;
  const load = async () => {
    setNote("");
    try {
      const next = { ...cursors };
      for (const kind of Object.keys(cursors).filter((one) => cursors[one] !== null)) {
        const { items, next_cursor } = await listRuns(kind, cursors[kind]);
        items.forEach(keepRun);
        next[kind] = next_cursor ?? null;
      }
      setCursors(next);
    } catch (error) {
      setNote(error.message);
    }
  };
  return html`<div class="older"><button class="secondary" onClick=${load}>Show older runs</button><p role="alert">${note}</p></div>`;
}
