// Tags over the picture of a robot: each guess at its place, in two columns beside the robot, with a line to the place.
import { sentence } from "../../js/format.js";
import { topicTitle } from "./reading-words.js";

/** @import { Extent } from "./sketch-geometry.js" */
/** @import { Reading, ReadingChoices, ReadingNote } from "./reading.js" */

/** `at_m`: the point that it is about, in the scene. */
/**
 * @typedef {{
 *   index: number, topic: string, title: string, text: string, offer: ReadingChoices | null, at_m: number[],
 * }} Tag
 */
/** @typedef {"left" | "right"} Side */
/** @typedef {{ x: number, y: number }} Place */

/** Sizes of the picture and of tags [px]. */
export const TAG = { width: 178, height: 58, gap: 8, top: 12, bottom: 64, edge: 12 };
/** A picture that is narrower has no room for tags beside the robot: they are dots. */
export const LEAST_WIDTH = 700;
const MOST_TAGS = 8;

/** The parts of a leg, from the torso to the foot. @type {(reading: Reading, leg: number) => Reading["parts"]} */
const partsOfLeg = ({ parts }, leg) => parts.filter((part) => part.leg === leg);

/** @type {(reading: Reading, name: string) => number[] | null} */
function placeOfName(reading, name) {
  const body = reading.parts.find((part) => part.name === name);
  if (body) return body.at_m;
  const foot = reading.feet.find((candidate) => candidate.name === name);
  if (foot) return foot.at_m;
  for (const { leg, joints } of reading.robot?.legs ?? []) {
    const links = partsOfLeg(reading, leg);
    const at = joints.indexOf(name);
    if (at >= 0 && links.length) return links[Math.min(at, links.length - 1)].at_m;
  }
  return null;
}

/**
 * Where a guess without parts is told: by what it is about.
 * @type {(reading: Reading, topic: string, extent: Extent) => number[]}
 */
function placeOfTopic(reading, topic, { radius_m, height_m }) {
  const first = partsOfLeg(reading, 1);
  if (topic === "forward") return [0, radius_m, 0];
  if (topic === "legs" && reading.feet.length) return reading.feet[0].at_m;
  if ((topic === "servos" || topic === "joints") && first.length) return first[0].at_m;
  if (topic === "groups") return partsOfLeg(reading, 2)[0]?.at_m ?? [0, 0, height_m];
  return [0, 0, 0.8 * height_m];
}

/** Topics that have no place on the robot: they are in the list alone, unless they offer something. */
const ELSEWHERE = ["file", "meshes", "size"];

/**
 * The guesses of a reading as tags; those that name parts come first.
 * @type {(reading: Reading, extent: Extent) => Tag[]}
 */
export function tagsOf(reading, extent) {
  const guesses = reading.notes.map((note, index) => ({ note, index })).filter(({ note }) =>
    note.kind === "guess" && (!ELSEWHERE.includes(note.topic) || note.offer || note.parts.length));
  const isPlaced = (/** @type {ReadingNote} */ { parts, offer }) => (offer ? 2 : 0) + (parts.length ? 1 : 0);
  return guesses
    .toSorted((a, b) => isPlaced(b.note) - isPlaced(a.note) || a.index - b.index).slice(0, MOST_TAGS)
    .map(({ note: { topic, text, parts, offer }, index }) => {
      const places = parts.flatMap((name) => placeOfName(reading, name) ?? []).length
        ? parts.map((name) => placeOfName(reading, name)) : [];
      const at_m = places.find((place) => place !== null) ?? placeOfTopic(reading, topic, extent);
      return { index, topic, title: topicTitle(topic), text: sentence(text), offer, at_m };
    });
}

/** How high a robot on its turntable is in a picture, by its width there. */
const SEEN_HEIGHT = 0.55;

/**
 * What of a picture stays free of the robot for tags and controls [px]: columns beside it, or the corners above it,
 * which leaves more room in a picture that is high.
 * @type {(tags: number, size: { width: number, height: number }) => { side: number, top: number, bottom: number }}
 */
export function marginsFor(tags, { width, height }) {
  const none = { side: TAG.edge, top: TAG.top, bottom: TAG.bottom };
  if (!tags || width < LEAST_WIDTH) return none;
  const beside = { ...none, side: TAG.width + 2 * TAG.edge };
  const rows = Math.ceil(tags / 2);
  const above = { ...none, top: TAG.top + rows * (TAG.height + TAG.gap) };
  const shown = (/** @type {typeof none} */ { side, top, bottom }) =>
    Math.min(width - 2 * side, (height - top - bottom) / SEEN_HEIGHT);
  return shown(above) > shown(beside) ? above : beside;
}

/**
 * The side of each tag, and its place in the column there: near to what it is about, and as many on both sides as there
 * is room; null for one without room.
 * @type {(places: (Place | null)[], size: { width: number, height: number }) => ({ side: Side, row: number } | null)[]}
 */
export function columnsOf(places, { width, height }) {
  const rows = Math.max(0, Math.floor((height - TAG.top - TAG.bottom + TAG.gap) / (TAG.height + TAG.gap)));
  const middle = width / 2;
  /** @type {(x: number) => Side} */
  const sideOf = (x) => (x < middle ? "left" : "right");
  const wanted = places.map((place, index) =>
    ({ index, x: place?.x ?? middle, y: place?.y ?? 0, side: sideOf(place?.x ?? 0) }));
  // Of a side with more, those that are nearest to the middle go over.
  for (const [side, other] of /** @type {[Side, Side][]} */ ([["left", "right"], ["right", "left"]])) {
    const ofSide = wanted.filter((tag) => tag.side === side)
      .toSorted((a, b) => Math.abs(b.x - middle) - Math.abs(a.x - middle));
    const most = Math.max(Math.ceil(places.length / 2), 1);
    for (const tag of ofSide.slice(Math.min(most, rows))) tag.side = other;
  }
  /** @type {({ side: Side, row: number } | null)[]} */
  const columns = places.map(() => null);
  for (const side of /** @type {Side[]} */ (["left", "right"])) {
    wanted.filter((tag) => tag.side === side).slice(0, rows).toSorted((a, b) => a.y - b.y)
      .forEach(({ index }, row) => (columns[index] = { side, row }));
  }
  return columns;
}

/**
 * The box of a tag [px].
 * @type {(column: { side: Side, row: number }, size: { width: number }) => { left: number, top: number }}
 */
export const boxOf = ({ side, row }, { width }) => ({
  left: side === "left" ? TAG.edge : width - TAG.edge - TAG.width, top: TAG.top + row * (TAG.height + TAG.gap),
});

/**
 * The end of a tag's line at the tag [px].
 * @type {(column: { side: Side, row: number }, size: { width: number }) => Place}
 */
export function lineEnd(column, size) {
  const { left, top } = boxOf(column, size);
  return { x: column.side === "left" ? left + TAG.width : left, y: top + TAG.height / 2 };
}
