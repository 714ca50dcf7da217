// Distance against race time up to the moment that is shown. Flat parts are thinking.
import uPlot from "uplot";
import { useMemo } from "preact/hooks";
import { agentOf } from "../agents.js";
import { metres } from "../format.js";
import { html } from "../html.js";
import { clock, raceInView } from "../selectors.js";
import { clipped, distanceAt, shownTime, timeline } from "../timeline.js";
import { AsTable } from "./as-table.js";
import { Empty } from "./empty.js";
import { Plot } from "./plot.js";

/** What thinking costs under each clock. */
const COSTS = {
  paper: "a decision costs what it did in the paper",
  wall: "a decision costs the time it took on this machine",
  free: "a decision costs nothing under this clock",
};
const HEADROOM = 1.16;
const TABLE_ROWS = 10;
/** The time axis shows at least so much of a race that has just begun [s]. */
const FIRST_VIEW_S = 20;

export function RaceChart() {
  const known = timeline.value;
  const time = shownTime.value;
  const isOn = known && time !== null && known.lanes.some(({ points }) => points.length > 1);
  const cost = COSTS[clock.value];
  return html`
    <section class="panel chart" aria-labelledby="race-title">
      <h2 id="race-title">The race</h2>
      <p class="dim">Flat parts are thinking${cost && `: ${cost}`}</p>
      ${isOn ? html`<${Lines} known=${known} time=${time} />` : html`<${Empty} shape="lines" words=${invitation()} />`}
    </section>
  `;
}

const invitation = () =>
  raceInView.value
    ? "The lines start when the robots do. Flat parts are thinking."
    : "Each robot draws a line here as it walks. Flat parts are thinking.";

function Lines({ known, time }) {
  const longest = Math.max(...known.lanes.map(({ total_s }) => total_s));
  const until = Math.min(time, longest);
  const lanes = known.lanes.map((lane) => {
    const shown = clipped(lane.points, until);
    return { ...lane, ...agentOf(lane.agent), shown, end: shown.at(-1) };
  });
  const data = useMemo(
    () => uPlot.join(lanes.map(({ shown }) => [shown.map(([t]) => t), shown.map(([, d]) => d)])),
    [known, until],
  );
  const far = Math.max(known.finish_line_m, ...lanes.map(({ end }) => end[1]));
  const ends = lanes.map(({ title, end }) => `${title} ${metres(end[1])}`).join(", ");
  const caption = `The race after ${Math.round(until)} seconds: ${ends}.`;
  return html`
    <${Plot} label=${caption} data=${data} marks=${marksOf(known, until)}
      series=${lanes.map(({ color }) => ({ color }))}
      labels=${lanes.map(({ title, color, end }) => ({ text: title, color, x: end[0], y: end[1] }))}
      x=${{ min: 0, max: lastMoment(known, until, longest), unit: "race time, s" }}
      y=${{ min: 0, max: HEADROOM * far }} />
    <${AsTable} caption=${caption} columns=${["Race time", ...lanes.map(({ title }) => title)]}
      rows=${rowsOf(lanes, until)} />
  `;
}

/** Where the time axis ends. */
function lastMoment({ first_finish_s }, until, longest) {
  const planned = first_finish_s ? Math.min(1.3 * first_finish_s, longest) : Math.min(longest, FIRST_VIEW_S);
  return Math.max(until, planned, 1);
}

/** The finish line, and time-out once it is past. */
function marksOf({ finish_line_m, first_finish_s }, until) {
  // Its caption stands where no line passes: first on the left, later behind the lanes that have arrived.
  const share = first_finish_s && until > 1.5 * first_finish_s ? 0.55 : 0;
  /** @type {object[]} */
  const marks = [{ y: finish_line_m, color: "--finish", text: "finish line", share }];
  if (first_finish_s && until >= first_finish_s) {
    marks.push({ x: first_finish_s, color: "--dim", dash: [2, 3], text: "time-out" });
  }
  return marks;
}

function rowsOf(lanes, until) {
  const step = Math.max(1, Math.ceil(until / TABLE_ROWS));
  const moments = Array.from({ length: Math.floor(until / step) + 1 }, (_, n) => n * step);
  return moments.map((t) => [`${t} s`, ...lanes.map(({ points }) => metres(distanceAt(points, t)))]);
}
