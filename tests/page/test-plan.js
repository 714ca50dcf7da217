// The plan of the track from above: robots as links tell of them, all in the picture, and their labels.
import assert from "node:assert/strict";
import { test } from "node:test";
import {
  apart, bodiesOf, FINISH_M, laneWidth, LabelTexts, pathOf, placeOf, ticksOf, viewOf,
} from "../../static/js/plan.js";

/** Links of a robot with six legs at a place: each has a hip, a knee and a foot. */
/** @type {(lane: number, x: number, y: number) => import("../../static/js/plan.js").Link[]} */
const robot = (lane, x, y) => {
  const torso = { lane, leg: null, origin: [x, y, 0.1], tip: [x, y, 0.12] };
  const legs = [3, 1, 6, 2, 5, 4].flatMap((leg) => {
    const [sine, cosine] = [Math.sin(leg), Math.cos(leg)];
    const at = (/** @type {number} */ far) => [x + far * cosine, y + far * sine, 0];
    // A knee is told of before its hip; the tip of the inner link lies beside it.
    return [
      { lane, leg, origin: at(0.18), tip: at(0.27) }, { lane, leg, origin: at(0.1), tip: at(0.19) },
    ];
  });
  return [torso, ...legs];
};
const far = (/** @type {number[]} */ [x, y], /** @type {number[]} */ at) => Math.hypot(x - at[0], y - at[1]);

test("a robot is its torso and legs from hip to foot, in their order around it", () => {
  const [first, second] = bodiesOf([...robot(1, 0.6, 0.2), ...robot(0, 0, 0)]);
  assert.deepEqual([first.lane, second.lane, second.at], [0, 1, [0.6, 0.2, 0.1]]);
  assert.equal(second.legs.length, 6);
  for (const leg of second.legs) {
    assert.deepEqual(leg.map((point) => Number(far(point, second.at).toFixed(2))), [0.1, 0.18, 0.27]);
  }
  const angles = second.legs.map(([[x, y]]) => Math.atan2(y - 0.2, x - 0.6));
  assert.deepEqual(angles, angles.toSorted((a, b) => a - b));
});

test("all robots with their feet, the start and the finish are in the picture of any size", () => {
  const races = [[0], [0.1, 0.5, 0.32], [-0.4, 1.7], [0.2, 0.2, 0.2, 0.2, 0.2, 0.2]];
  for (const ys of races) {
    const bodies = bodiesOf(ys.flatMap((y, lane) => robot(lane, 0.62 * lane, y)));
    for (const [width, height] of [[828, 520], [390, 150], [700, 380], [300, 900]]) {
      const view = viewOf(bodies, { width, height }, false);
      const xs = bodies.map(({ at }) => at[0]);
      const lines = [0, FINISH_M].flatMap((y) => xs.map((x) => [x, y]));
      for (const point of [...bodies.flatMap(({ legs }) => legs.flat()), ...lines]) {
        const [x, y] = placeOf(view, point);
        assert.ok(x >= 0 && x <= width && y >= 0 && y <= height, `${ys} in ${width} x ${height}: ${x}, ${y}`);
      }
    }
  }
});

test("the run goes where the robots are larger: up with many lanes, to the right with a single one", () => {
  const [three, single] = [3, 1].map((lanes) =>
    bodiesOf(Array.from({ length: lanes }, (_, lane) => robot(lane, 0.62 * lane, 0)).flat()));
  const size = { width: 828, height: 520 };
  assert.equal(laneWidth(three).toFixed(2), "0.62");
  const [up, right] = [viewOf(three, size, false), viewOf(single, size, true)];
  assert.deepEqual([up.isUpright, right.isUpright], [true, false]);
  // Seen from above: who looks along the run has the first lane at the left.
  assert.ok(placeOf(up, [0, 0])[0] < placeOf(up, [0.62, 0])[0]);
  assert.ok(placeOf(up, [0, FINISH_M])[1] < placeOf(up, [0, 0])[1]);
  assert.ok(placeOf(right, [0, 0])[1] < placeOf(right, [0.62, 0])[1]);
  assert.ok(placeOf(right, [0, FINISH_M])[0] > placeOf(right, [0, 0])[0]);
});

test("a practice is seen around its robot, however far it has come", () => {
  const [body] = bodiesOf(robot(0, 0, 12.3));
  const view = viewOf([body], { width: 600, height: 400 }, true);
  assert.deepEqual(placeOf(view, body.at).map(Math.round), [300, 200]);
});

test("marks have room for their numbers, and none is where a line has a word", () => {
  const [body] = bodiesOf(robot(0, 0, 0));
  for (const width of [2000, 600, 120]) {
    const view = viewOf([body], { width, height: 300 }, false);
    const ticks = ticksOf(view);
    const gap_px = (ticks[1].y - ticks[0].y) * view.scale;
    assert.ok(Math.abs(gap_px) >= 39, `${gap_px} px`);
    assert.ok(ticks.every(({ y, hasNumber }) => y !== 0 && hasNumber === Math.abs(y - FINISH_M) > 0.06));
  }
});

test("a path has places to the tenth of a pixel", () => {
  const view = { isUpright: false, along: [0, 1], across: [0, 1], scale: 100 };
  assert.equal(pathOf(/** @type {any} */ (view), [[0.12345, 0.5], [1, 1]]), "50.0 12.3L100.0 100.0");
});

test("labels are those of the messages, until their node is removed", () => {
  const labels = new LabelTexts();
  const name = "/world/run/lane1/label";
  labels.take({ type: "LabelMessage", name, props: { text: "Greedy\n0.10 m" } });
  assert.deepEqual([labels.of(0), labels.of(1)], [[""], ["Greedy", "0.10 m"]]);
  labels.take({ type: "SceneNodeUpdateMessage", name, updates: { text: "1. Greedy" } });
  labels.take({ type: "SceneNodeUpdateMessage", name, updates: { font_size: 2 } });
  assert.deepEqual(labels.of(1), ["1. Greedy"]);
  labels.take({ type: "RemoveSceneNodeMessage", name: "/world" });
  assert.deepEqual(labels.of(1), [""]);
});

test("names that would be over another go up a line, and others stay", () => {
  const names = [[0, 60, 50], [40, 90, 52], [80, 120, 50], [30, 70, 49], [0, 60, 90]]
    .map(([left, right, y]) => ({ left, right, y }));
  assert.deepEqual(apart(names, 15).map(({ y }) => y), [50, 35, 50, 20, 90]);
});
