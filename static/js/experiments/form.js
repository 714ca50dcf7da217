// What an experiment is asked to try. Only what one has said oneself is kept, sent and linked to.
import { computed, signal } from "@preact/signals";
import { futureRuns } from "./trials.js";
import { experimentOf, experiments, GRID } from "./catalogue.js";

const numbers = (word) => word.split(",").filter((part) => part.trim() !== "").map(Number);
const names = (word) => word.split(",").filter(Boolean);
const whole = (word) => (/^\d+$/.test(word) ? Number(word) : undefined);
const list = (parse) => (word) => {
  const found = parse(word);
  return found.length && !found.some(Number.isNaN) ? found : undefined;
};

const READERS = {
  seeds: whole, seed: whole, gaits: list(names), observations: list(names), robots: list(names),
  simulator: (word) => word, agents: list(names), name: (word) => word,
  ...Object.fromEntries(GRID.map((field) => [field, list(numbers)])),
};

const chosenName = signal("table1");
/** Field → value, of those that differ from the experiment's own. */
export const given = signal({});
/** Field → what is wrong with it. */
export const mistakes = signal({});

export const chosenKind = computed(() => experimentOf(chosenName.value));
export const maySay = (field) => field === "name" || chosenKind.value.fields.includes(field);

/** What will be tried, with the experiment's own values where nothing is said. */
export const values = computed(() => {
  const said = Object.entries(given.value).filter(([field]) => maySay(field));
  return { name: "", ...chosenKind.value.defaults, ...Object.fromEntries(said) };
});

/** How many trials that comes to. */
export const trials = computed(() => futureRuns(chosenKind.value.name, values.value));

export function choose(name) {
  chosenName.value = name;
  mistakes.value = {};
}

export function say(field, value) {
  const { [field]: _, ...others } = given.value;
  const own = chosenKind.value.defaults[field] ?? "";
  given.value = String(value) === String(own) ? others : { ...others, [field]: value };
}

export function setMistake(field, message) {
  const { [field]: _, ...others } = mistakes.value;
  mistakes.value = message ? { ...others, [field]: message } : others;
}

/** The request's body. */
export function body() {
  const said = Object.entries(given.value).filter(([field, value]) => maySay(field) && value !== "");
  return { experiment: chosenKind.value.name, ...Object.fromEntries(said) };
}

/** As it stands in an address. */
export const written = () => ({
  ...(chosenName.value === "table1" ? {} : { experiment: chosenName.value }),
  ...Object.fromEntries(Object.entries(given.value).map(([field, value]) => [field, String(value)])),
});

/** Take over what an address says; what it says badly is left as it is. */
export function read(query) {
  const name = query.get("experiment") ?? "table1";
  chosenName.value = experiments.value.some((one) => one.name === name) ? name : "table1";
  const found = {};
  for (const [field, parse] of Object.entries(READERS)) {
    const value = query.has(field) ? parse(query.get(field)) : undefined;
    if (value !== undefined) found[field] = value;
  }
  given.value = found;
}
