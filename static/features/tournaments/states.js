// The states of a tournament in words, and where its page is: what other pages say of it, too.
import { root } from "../../js/api.js";

/** @import { Classroom, ListedTournament } from "../../js/types.js" */

const STATES = {
  open: "Open", ending: "Judging the last entries", ended: "Ended",
};

/** @param {ListedTournament["state"]} state */
export const stateInWords = (state) => STATES[state];

/** The address of the page of a tournament. @param {string} id */
export const tournamentPage = (id) => `${root()}t/${encodeURIComponent(id)}`;

/** The tournaments of a room that go on, and the last one. @param {Classroom} room */
export const presentTournaments = ({ tournaments }) =>
  tournaments.filter(({ state }, n) => state !== "ended" || n === tournaments.length - 1);
