"""Metrics of runs, derived from their events."""

from dataclasses import replace

from app.events.run_metrics import RunMetrics
from app.storage.run import DamagedRun
from tests.features.needing import needs
from tests.storage.stores import experiment, race, training


@needs("experiments")
def test_steps_are_counted_from_a_runs_first_event_on() -> None:
    now = 0.0
    metrics = RunMetrics(now=lambda: now)
    for run in (training("a", done=100), race("b"), experiment("c")):
        metrics.publish_run(run)
        metrics.publish_run(replace(run, done=run.done + 20))
    assert metrics.steps == 40, "trials are no steps"
    assert metrics.steps_per_s == 4
    now = 10.0
    assert metrics.steps_per_s == 0


def test_damaged_run_can_be_published() -> None:
    metrics = RunMetrics()
    subscription = metrics.subscribe()
    damaged = DamagedRun(id="a", kind="training", damaged="its result cannot be read")
    metrics.publish_run(damaged)
    assert [event.run_id for event in subscription.drain()] == ["a"]
