// Tournaments over the REST API.
import { addressOf, call, start } from "../../js/api.js";

/** @import { Deleted } from "../../js/api.js" */
/** @import { Tournament, TournamentEntry, TournamentList } from "../../js/types.js" */

/** @param {string} id */
const pathOf = (id) => `tournaments/${encodeURIComponent(id)}`;

/** @returns {Promise<TournamentList>} */
export const listTournaments = () => call("GET", "tournaments");
/** @type {(body: object) => Promise<Tournament>} */
export const openTournament = (body) => start("tournaments", body);
/** @type {(id: string) => Promise<Tournament>} */
export const getTournament = (id) => call("GET", pathOf(id));
/** The same entry again is the one that is there. @type {(id: string, entry: object) => Promise<TournamentEntry>} */
export const enter = (id, entry) => start(`${pathOf(id)}/entries`, entry);
/** @type {(id: string, withdraw_waiting: boolean) => Promise<Tournament>} */
export const endTournament = (id, withdraw_waiting) => call("POST", `${pathOf(id)}/end`, { withdraw_waiting });
/** @type {(id: string) => Promise<Deleted>} */
export const deleteTournament = (id) => call("DELETE", pathOf(id));
/** Where the file of a tournament is, once it has ended. @param {string} id */
export const fileOf = (id) => addressOf(`${pathOf(id)}/file`);
