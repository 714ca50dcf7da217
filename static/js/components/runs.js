// The list of all runs with its filters.
import { useState } from "preact/hooks";
import { listRuns } from "../api.js";
import { html } from "../html.js";
import { everyRun } from "../selectors.js";
import { damagedRuns, requestRuns } from "../store.js";
import { DamagedRunRow } from "./damaged-run-row.js";
import { ExperimentRunRow } from "./experiments/experiment-run-row.js";
import { RunRow } from "./run-row.js";
import { Segments } from "./segments.js";

/** @import { RequestError } from "../api.js" */
/** @import { Kind } from "../types.js" */

const KINDS = [["all", "All"], ["training", "Trainings"], ["race", "Races"], ["experiment", "Experiments"]];
const ANY_STATE = "any state";
const STATES = [ANY_STATE, "running", "paused", "queued", "finished", "stopped", "failed", "interrupted"];
/** The snapshot has so many; more are requested. */
const SNAPSHOT_RUNS = 50;

export function Runs() {
  const [kind, setKind] = useState("all");
  const [state, setState] = useState(ANY_STATE);
  const all = [...damagedRuns.value.values(), ...everyRun.value];
  const shown = all.filter(
    (run) => ["all", run.kind ?? kind].includes(kind) && (state === ANY_STATE || run.state === state),
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

function rowOf(run) {
  if ("damaged" in run) return DamagedRunRow;
  return run.kind === "experiment" ? ExperimentRunRow : RunRow;
}

const NoRuns = ({ isFiltered }) => html`
  <div class="no-runs">${isFiltered ? html`<p>No run is of this kind and state.</p>` : html`<${FirstVisit} />`}</div>
`;

const FirstVisit = () => html`
  <p><b>No runs yet.</b></p>
  <p>
    Every training, race and experiment is kept here, with its curve, its table, its recording or its report.
    <a href="#">Start the first one</a>.
  </p>
`;

/** @type {Kind[]} */
const LISTED_KINDS = ["training", "race", "experiment"];

function Older({ count }) {
  /** Where each kind continues; null after its last page. */
  const [cursors, setCursors] = useState(/** @type {Record<Kind, string | null>} */ (
    { training: "", race: "", experiment: "" }
  ));
  const [note, setNote] = useState("");
  const [isLoading, setIsLoading] = useState(false);
  if (count < SNAPSHOT_RUNS || Object.values(cursors).every((cursor) => cursor === null)) return null;
  const load = async () => {
    // A second click would request the same pages again.
    if (isLoading) return;
    setIsLoading(true);
    setNote("");
    try {
      const next = { ...cursors };
      for (const kind of LISTED_KINDS.filter((one) => cursors[one] !== null)) {
        const { next_cursor } = await requestRuns(() => listRuns(kind, cursors[kind]));
        next[kind] = next_cursor ?? null;
      }
      setCursors(next);
    } catch (error) {
      setNote(/** @type {RequestError} */ (error).message);
    } finally {
      setIsLoading(false);
    }
  };
  return html`
    <div class="older">
      <button class="secondary" aria-disabled=${isLoading ? "true" : undefined} onClick=${load}>Show older runs</button>
      <p role="alert">${note}</p>
    </div>
  `;
}
