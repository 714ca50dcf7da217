// The draft of What if: tried beside the settings of the next run, which it changes only when it is used.
import assert from "node:assert/strict";
import { beforeEach, test } from "node:test";
import { installOnly } from "../../page/features.js";
import { OPTIONS } from "../../page/options.js";
import { options, role } from "../../../static/js/store.js";
import { form, openForm, setField, trainingBody } from "../../../static/js/form.js";
import { page, read, write } from "../../../static/js/page-state.js";

await installOnly("what_if");
const { applyDraft, differences, discardDraft, discardUntried, draft, triable, triedValue, tryValue, untried } =
  await import("../../../static/features/what_if/draft.js");
const { whatIfBody } = await import("../../../static/features/what_if/what-if.js");

beforeEach(() => {
  options.value = OPTIONS;
  role.value = "operator";
  page.form.value = new URLSearchParams();
  openForm();
  discardDraft();
});

/** Settings of a what-if. */
const tried = () => /** @type {any} */ (whatIfBody()).settings;

test("what is tried is in the what-if, and not in the next run", () => {
  const next = trainingBody();
  tryValue("alpha", 0.9);
  tryValue("steps", 60);
  assert.deepEqual([tried().alpha, whatIfBody().steps], [0.9, 60]);
  assert.deepEqual(trainingBody(), next);
  assert.equal(String(page.form.value), "");
  assert.deepEqual(differences.value.map(({ field, value, next: before }) => [field, value, before]), [
    ["alpha", 0.9, form.value.alpha], ["steps", 60, form.value.steps],
  ]);
});

test("it is taken into the next run when it is used, and dropped when it is discarded", () => {
  tryValue("alpha", 0.9);
  discardDraft();
  assert.deepEqual([differences.value, triedValue("alpha")], [[], form.value.alpha]);
  tryValue("alpha", 0.9);
  applyDraft();
  assert.deepEqual([form.value.alpha, differences.value, page.tried.value], [0.9, [], []]);
});

test("a value that is the next run's is no part of it, whichever came first", () => {
  tryValue("alpha", 0.9);
  tryValue("alpha", /** @type {number} */ (form.value.alpha));
  assert.deepEqual(page.tried.value, []);
  tryValue("alpha", 0.9);
  setField("alpha", 0.9);
  assert.deepEqual(differences.value, []);
});

test("the link has it, and one that is opened tries the same", () => {
  tryValue("alpha", 0.9);
  tryValue("steps", 60);
  assert.equal(write(), "?tried=alpha=0.9,steps=60");
  discardDraft();
  read({ search: "?tried=alpha=0.9,steps=60", hash: "" });
  assert.deepEqual(draft.value, { alpha: 0.9, steps: 60 });
});

test("what a link says in vain is told with what is valid, and can be dropped", () => {
  read({ search: "?tried=alhpa=0.9,steps=many,alpha=0.8", hash: "" });
  assert.deepEqual(draft.value, { alpha: 0.8 });
  assert.equal(untried.value.length, 2);
  assert.equal(untried.value[0], `alhpa=0.9 (valid: ${Object.keys(triable.value).join(", ")})`);
  assert.match(untried.value[1], /^steps=many \(/);
  discardUntried();
  assert.deepEqual([page.tried.value, untried.value], [["alpha=0.8"], []]);
});

test("settings that another learner lacks are not tried with it", () => {
  tryValue("alpha", 0.9);
  setField("agent", "tracer");
  assert.ok("alpha" in triable.value, "this one has it");
  page.tried.value = ["nothing=1"];
  assert.deepEqual(differences.value, []);
});
