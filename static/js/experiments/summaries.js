// What the chosen experiment has shown so far: fetched again as its trials end.
import { computed, effect, signal } from "@preact/signals";
import { getSummary } from "../api.js";
import { place } from "../page.js";
import { connection, summarised } from "../store.js";
import { chosenRun } from "./selection.js";

const PAUSE_MS = 2000;

/** Run id → its newest summary. */
const fetched = signal({});
/** Run id → why there is none. */
const refused = signal({});

export const summary = computed(() => fetched.value[chosenRun.value?.id] ?? null);
export const summaryError = computed(() => refused.value[chosenRun.value?.id] ?? null);

async function load(id) {
  try {
    fetched.value = { ...fetched.value, [id]: await getSummary(id) };
    refused.value = { ...refused.value, [id]: null };
  } catch (error) {
    refused.value = { ...refused.value, [id]: error };
  }
}

/** At most one request each two seconds, and one more for what came meanwhile. */
export function followSummary() {
  const wanted = computed(() => {
    const run = chosenRun.value;
    if (!run || place.value !== "experiments" || connection.value !== "live") return "";
    return [run.id, run.state, summarised.value[run.id] ?? ""].join(" ");
  });
  let busy = false;
  let missed = false;
  let last = "";

  const next = async () => {
    const [id] = wanted.peek().split(" ");
    if (!id) return;
    if (busy && id === last) {
      missed = true;
      return;
    }
    busy = true;
    missed = false;
    last = id;
    await load(id);
    setTimeout(() => {
      busy = false;
      if (missed) next();
    }, PAUSE_MS);
  };
  effect(() => {
    if (wanted.value) next();
  });
}
