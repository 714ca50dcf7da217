// Sentences about a robot as it was read.
import { count } from "../../js/format.js";
import { lengthInWords, massInWords } from "./quantities.js";
import { directionInWords, groupsInWords } from "./reading-choices.js";

/** @import { FoundRobot, Reading } from "./reading.js" */

/** "6 legs, 2.3 kg, stands 84 mm high" @param {FoundRobot} robot */
export const robotInWords = ({ legs, mass_kg, body_height_m }) =>
  `${count(legs.length, "leg")} · ${massInWords(mass_kg)} · stands ${lengthInWords(body_height_m)} high`;

/** What screen readers are told of a new reading. @param {Reading} reading */
export function readingInWords({ robot, problem, notes }) {
  if (!robot) return `This cannot be a robot yet: ${problem}`;
  const guesses = notes.filter(({ kind }) => kind === "guess").length;
  return [
    `${robot.name}: ${count(robot.legs.length, "leg")}`, `forward along ${directionInWords(robot.forward_deg)}`,
    `groups ${groupsInWords(robot.groups)}`, `stands ${lengthInWords(robot.body_height_m)} high`,
    guesses ? `${count(guesses, "guess").replace("guesss", "guesses")} to confirm` : "nothing was guessed",
  ].join(", ");
}

/** Topics of notes as titles. @type {Record<string, string>} */
const TOPICS = {
  file: "Document", links: "Links", base: "Base", legs: "Feet", forward: "Forward", groups: "Groups",
  stance: "Stance", joints: "Joints", servos: "Servos", masses: "Masses", size: "Size", shapes: "Shapes",
  meshes: "Meshes",
};

/** @param {string} topic */
export const topicTitle = (topic) => TOPICS[topic] ?? topic;

/** What is missing of a robot that cannot be stored, and what to do. @param {Reading} reading */
export const missingInWords = ({ feet }) => (feet.length
  ? "Choose its feet, in the picture or below, or correct its units."
  : "Nothing in it could be a foot.");
