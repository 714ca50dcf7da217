// Numbers and words as people read them.

const MINUS = "\u2212";
const NARROW = "\u202f";
const NO_BREAK = "\u00a0";

/** Metres to the centimetre: "0.38 m". */
export function metres(value) {
  if (value === null || value === undefined || Number.isNaN(value)) return "–";
  const rounded = Math.round(value * 100) / 100;
  return `${rounded < 0 ? MINUS : ""}${Math.abs(rounded).toFixed(2)}${NO_BREAK}m`;
}

/** Whole millimetres without the unit, which the heading has: "52". */
export function millimetres(value) {
  const rounded = Math.round(value * 1000);
  return `${rounded < 0 ? MINUS : ""}${Math.abs(rounded)}`;
}

/** The time of one decision: "<1 ms", "12 ms", "1.4 s". */
export function decision(seconds) {
  if (seconds === null || seconds === undefined) return "–";
  const ms = seconds * 1000;
  if (ms < 1) return "<1 ms";
  return ms < 1000 ? `${Math.round(ms)} ms` : `${(ms / 1000).toFixed(1)} s`;
}

/** A time that is left or has passed: "4 s", "2 min", "1 h 5 min". */
export function duration(seconds) {
  if (seconds < 1) return "under 1 s";
  if (seconds < 90) return `${Math.round(seconds)} s`;
  const minutes = Math.round(seconds / 60);
  if (minutes < 90) return `${minutes} min`;
  return `${Math.floor(minutes / 60)} h ${minutes % 60} min`;
}

/** A place in a race: "1:05". */
export function clockTime(seconds) {
  const whole = Math.max(0, Math.floor(seconds));
  return `${Math.floor(whole / 60)}:${String(whole % 60).padStart(2, "0")}`;
}

/** "7 800", with a space that never breaks. */
export const whole = (value) =>
  value === null || value === undefined
    ? "–"
    : String(Math.round(value)).replace(/\B(?=(\d{3})+$)/g, NARROW);

/** "500 steps", "1 step". */
export const count = (number, noun) => `${whole(number)} ${noun}${number === 1 ? "" : "s"}`;

/** "×2", "×0.25". */
export const times = (factor) => `×${Number(factor.toPrecision(2))}`;

/** "two minutes ago", in the reader's own day when it is older. */
export function ago(iso, now = Date.now()) {
  const then = Date.parse(iso);
  const seconds = (now - then) / 1000;
  if (seconds < 60) return "just now";
  if (seconds < 3600) return `${Math.floor(seconds / 60)} min ago`;
  const day = new Date(then);
  const time = day.toLocaleTimeString([], { hour: "2-digit", minute: "2-digit" });
  if (new Date(now).toDateString() === day.toDateString()) return `today, ${time}`;
  return `${day.toLocaleDateString([], { day: "numeric", month: "short" })}, ${time}`;
}

export const sentence = (text) => text.charAt(0).toUpperCase() + text.slice(1);

/** "a", "a and b", "a, b and c". */
export const listed = (items) =>
  items.length < 2 ? items.join("") : `${items.slice(0, -1).join(", ")} and ${items.at(-1)}`;
