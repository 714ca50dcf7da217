// The own trainings whose tables can enter: those of a participant in the room, or those of the server.
import { signal } from "@preact/signals";
import { call, getAnyRun, listRuns } from "../../js/api.js";
import { fits } from "./draft.js";

/** @import { Signal } from "@preact/signals" */
/** @import { Run, Tournament } from "../../js/types.js" */

/** Null until the server has answered. @type {Signal<Run[] | null>} */
export const tables = signal(null);

/** @param {Tournament} of */
export async function loadTables({ room, is_operator, rules }) {
  try {
    const trainings = is_operator || room === null ? await finishedTrainings() : await runsIn(room);
    tables.value = trainings.filter((run) => fits(run, rules));
  } catch {
    // The list is a convenience; without it one enters with an agent.
    tables.value = [];
  }
}

const finishedTrainings = async () => (await listRuns({ kind: "training", state: "finished" })).items;

/** The own runs of a participant, the newest first. @param {string} code */
async function runsIn(code) {
  const { me } = await call("GET", `rooms/${encodeURIComponent(code)}`);
  /** @type {{ run_id: string }[]} */
  const runs = me?.runs ?? [];
  const results = await Promise.allSettled(runs.map(({ run_id }) => getAnyRun(run_id)));
  return results.flatMap((result) => (result.status === "fulfilled" ? [result.value] : [])).reverse();
}
