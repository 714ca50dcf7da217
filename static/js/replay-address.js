// The address of a replay of this page's own: the run, the run whose robots are its ghosts, and a held position.
import { place, REPLAY_FIELDS, viewOf } from "./page.js";

/**
 * A replay; without `time_s` it plays.
 * @typedef {{ id: string, ghost?: string | null, time_s?: number | null }} Shown
 */

/** @param {Shown} shown */
const fieldsOf = ({ id, ghost = null, time_s = null }) => ({
  run: id, ...(ghost ? { ghost } : {}), ...(time_s === null ? {} : { t: time_s.toFixed(2) }),
});

/** Where a run is replayed, alone or with the robots of another as ghosts. @param {Shown} shown */
export const replayAddress = (shown) => `${location.pathname}?${new URLSearchParams(fieldsOf(shown))}`;

/** The replay that the address names; null if it names none. */
export function readReplay() {
  const query = new URLSearchParams(location.search);
  const id = query.get("run");
  if (!id) return null;
  const time_s = Math.max(0, Number(query.get("t")) || 0);
  return { id, at: { ghost: query.get("ghost"), time_s, isPlaying: !query.has("t") } };
}

/** Write a replay into the address; null takes it out. @param {Shown | null} shown */
export function writeReplay(shown) {
  const query = new URLSearchParams(location.search);
  const [before, ghostBefore] = [query.get("run"), query.get("ghost")];
  for (const field of REPLAY_FIELDS) query.delete(field);
  for (const [field, text] of Object.entries(shown ? fieldsOf(shown) : {})) query.set(field, text);
  const isOther = (shown?.id ?? null) !== before || (shown?.ghost ?? null) !== ghostBefore;
  const search = query.size ? `?${query}` : "";
  // A replay opens in the view of the race, as the stage is there.
  const address = `${location.pathname}${search}${shown && isOther ? "" : location.hash}`;
  // Back goes to what was shown before.
  if (isOther) history.pushState(history.state, "", address);
  else history.replaceState(history.state, "", address);
  place.value = viewOf(location.hash);
}
