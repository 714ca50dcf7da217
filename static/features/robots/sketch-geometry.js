// Points of a robot on its turntable, in the frame of its scene: x right, y forward, z up, the ground at z = 0 [m].

/** @import { Frames } from "../../js/replay-frames.js" */

/** @typedef {[number, number, number]} Point3 */
/**
 * How far it reaches from the axis of the turntable, and up [m]; `rims_m`: of slices from the ground up how far each
 * reaches, and its upper end.
 * @typedef {{ radius_m: number, height_m: number, rims_m: [number, number][] }} Extent
 */

/** Directions in which forward can be dragged [°]. */
export const STEP_DEG = 15;
/** Of the arrow, in radii of the robot: begin, begin of its head, tip, and half the widths of shaft and head. */
const ARROW = { from: 0.72, neck: 1.16, to: 1.34, shaft: 0.05, head: 0.13 };
/** The radius of what is to be in view, the arrow too, in radii of the robot. */
const SHOWN = 1.36;
const SMALLEST_M = 0.01;
const SLICES = 6;
const DIGITS = 2;

const PART = /\/part\/(\d+)$/;

/** Rounded up, so that a small change of the robot does not move the camera. @param {number} value */
function rounded(value) {
  const unit = 10 ** (Math.floor(Math.log10(Math.max(value, 1e-9))) - DIGITS + 1);
  return Number((Math.ceil(value / unit - 1e-4) * unit).toPrecision(DIGITS + 1));
}

/** The vertices of the parts in a scene. @param {Frames} scene @returns {Float32Array[]} */
const verticesIn = ({ frames }) => frames.flatMap(({ messages }) => messages)
  .filter(({ name, props }) => PART.test(name ?? "") && props?.vertices)
  .map(({ props: { vertices } }) => (vertices instanceof Float32Array ? vertices
    : new Float32Array(vertices.buffer.slice(vertices.byteOffset, vertices.byteOffset + vertices.byteLength))));

/** The distance from the axis, and the height, of each vertex. @param {Frames} scene @returns {[number, number][]} */
const reachesIn = (scene) => verticesIn(scene).flatMap((vertices) =>
  Array.from({ length: Math.floor(vertices.length / 3) }, (_, n) => /** @type {[number, number]} */ (
    [Math.hypot(vertices[3 * n], vertices[3 * n + 1]), vertices[3 * n + 2]])));

/** How far the parts of a scene reach. @param {Frames} scene @returns {Extent} */
export function extentOf(scene) {
  const reaches = reachesIn(scene);
  const most = (/** @type {number[]} */ values) => rounded(values.reduce((a, b) => Math.max(a, b), SMALLEST_M));
  const radius_m = most(reaches.map(([radius]) => radius));
  const height_m = most(reaches.map(([, height]) => height));
  const radii = Array.from({ length: SLICES }, () => 0);
  for (const [radius, height] of reaches) {
    const slice = Math.min(Math.max(Math.floor((SLICES * height) / height_m), 0), SLICES - 1);
    radii[slice] = Math.max(radii[slice], radius);
  }
  const rims_m = radii.map((radius, n) => /** @type {[number, number]} */ (
    [rounded(Math.max(radius, SMALLEST_M / SLICES)), (height_m * (n + 1)) / SLICES]));
  return { radius_m, height_m, rims_m };
}

/** What is to be in view: the robot, and on the ground the arrow and the numbers. @param {Extent} extent */
export const viewOf = ({ radius_m, height_m, rims_m }) =>
  ({ centre_m: [0, 0, height_m / 2], rims_m: [[SHOWN * radius_m, 0], ...rims_m] });

/** A point of the ground, by its direction from forward, anticlockwise, and distance. */
/** @type {(angle_deg: number, distance_m: number, side_m?: number) => Point3} */
function onGround(angle_deg, distance_m, side_m = 0) {
  const angle = (angle_deg * Math.PI) / 180;
  const [sine, cosine] = [Math.sin(angle), Math.cos(angle)];
  return [-distance_m * sine + side_m * cosine, distance_m * cosine + side_m * sine, 0];
}

/** The outline of the arrow, its tip first. @type {(extent: Extent, angle_deg: number) => Point3[]} */
export function arrowPoints({ radius_m }, angle_deg) {
  const { from, neck, to, shaft, head } = ARROW;
  return [[to, 0], [neck, head], [neck, shaft], [from, shaft], [from, -shaft], [neck, -shaft], [neck, -head]]
    .map(([ahead, side]) => onGround(angle_deg, ahead * radius_m, side * radius_m));
}

/** The angles to which the arrow can be dragged [°], and where its tip is then. @param {Extent} extent */
export const arrowTips = ({ radius_m }) => Array.from({ length: 360 / STEP_DEG }, (_, n) => {
  const angle_deg = n * STEP_DEG > 180 ? n * STEP_DEG - 360 : n * STEP_DEG;
  return { angle_deg, point: onGround(angle_deg, ARROW.to * radius_m) };
});

/**
 * Where the number of a leg stands: on the ground, outside of its foot.
 * @type {(foot: number[], extent: Extent) => Point3}
 */
export function numberPoint([x, y], { radius_m }) {
  const distance = Math.hypot(x, y) || 1;
  const out = distance + 0.1 * radius_m;
  return [(x / distance) * out, (y / distance) * out, 0];
}

/** An angle, and its place in the picture. */
/** @typedef {{ angle_deg: number, place: { x: number, y: number } | null }} Candidate */

/**
 * The nearest of some angles to a place of the picture; null where none is in the picture.
 * @type {(at: { x: number, y: number }, candidates: Candidate[]) => number | null}
 */
export function nearestAngle(at, candidates) {
  const distances = candidates.flatMap(({ angle_deg, place }) =>
    (place ? [{ angle_deg, distance: Math.hypot(place.x - at.x, place.y - at.y) }] : []));
  return distances.toSorted((a, b) => a.distance - b.distance)[0]?.angle_deg ?? null;
}
