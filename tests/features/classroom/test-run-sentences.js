// What a participant's phone says of the own run.
import assert from "node:assert/strict";
import { test } from "node:test";
import { participantRunNarrative } from "../../../static/features/classroom/room/run-sentences.js";
import { options } from "../../../static/js/store.js";
import { makeRun, OPTIONS } from "../../page/options.js";

options.value = OPTIONS;

test("on a phone nothing is said of how far a run came before its picture is there", () => {
  const of = (/** @type {object} */ changes, hasArrived = false) => participantRunNarrative({
    run: makeRun({ progress: { done: 150, total: 150 }, ...changes }), distance_m: 0.123, isAway: false, hasArrived,
  });
  assert.deepEqual([of({}).state, of({}).distance], ["arriving", undefined]);
  assert.deepEqual([of({}, true).state, of({}, true).distance], ["arrived", "0.12\u00a0m"]);
  assert.equal(of({ state: "running" }).words, "It practises: step 150 of 150");
  const waiting = of({ state: "queued", queue_position: 3 });
  assert.equal(waiting.words, "Your robot waits for its turn. Place 3 in the queue.");
  assert.ok(of({ state: "stopped" }, true).isBad);
});
