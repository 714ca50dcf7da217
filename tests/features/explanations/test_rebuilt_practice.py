"""Moving a learner through its practice: forward, back, by snapshots, within limits."""

import random
from collections.abc import Callable

import numpy as np
import pytest

from app.features.explanations import rebuilt_practice
from app.features.explanations.rebuilt_practice import RebuiltPractice
from app.storage.errors import Busy
from hexapods.assembly import rebuild_learner
from hexapods.domain.errors import HexapodError
from hexapods.runs.rebuilding import LearnerSnapshot, NotRebuilt, RebuiltLearner
from hexapods.runs.transition_log import Logged, Transitions
from tests.runs.test_rebuilding import agent_state, config_of, fed, practised, steps_of


class Steps:
    """Steps of a training, as the service reads them from its log."""

    def __init__(self, log: Transitions) -> None:
        self.logged = steps_of(log)

    def __len__(self) -> int:
        return len(self.logged)

    def step(self, number: int) -> Logged:
        return self.logged[number]


def steps_by(agent: str) -> Steps:
    return Steps(practised(agent)[1])


def practice_of(agent: str) -> RebuiltPractice:
    return RebuiltPractice(lambda: rebuild_learner(config_of(agent)))


def states_after(agent: str, steps: int) -> dict[str, bytes]:
    log = steps_of(practised(agent)[1])
    return agent_state(fed(rebuild_learner(config_of(agent)), log[:steps]).agent)


@pytest.mark.parametrize("agent", ["q-learning", "sarsa", "r-max", "linear-model"])
def test_any_order_of_moments_shows_the_same_learner(
    agent: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(rebuilt_practice, "SNAPSHOT_EVERY_S", 0.001)
    practice, steps, order = practice_of(agent), steps_by(agent), random.Random(3)
    for _ in range(12):
        step = order.randint(1, 80)
        explained = practice.explain(step, steps, ())
        assert explained.step == step
        assert explained.choice is not None
        assert explained.choice.action == steps.step(step - 1).action
        moment = order.randint(0, 80)
        learner = practice.learner_at(moment, steps, ())
        assert agent_state(learner.agent) == states_after(agent, moment)


def test_stepping_back_begins_at_the_nearest_snapshot(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(rebuilt_practice, "SNAPSHOT_EVERY_S", 0.0)
    calls: list[int] = []

    def new() -> RebuiltLearner:
        calls.append(1)
        return rebuild_learner(config_of("q-learning"))

    practice, steps = RebuiltPractice(new), steps_by("q-learning")
    practice.learner_at(80, steps, ())
    nearest = max(snapshot.step for snapshot in practice._snapshots if snapshot.step <= 60)
    restored: list[int] = []
    restore: Callable[..., None] = RebuiltLearner.restore

    def spy(learner: RebuiltLearner, snapshot: LearnerSnapshot) -> None:
        restored.append(snapshot.step)
        restore(learner, snapshot)

    monkeypatch.setattr(RebuiltLearner, "restore", spy)
    practice.learner_at(60, steps, ())
    # How far apart snapshots are depends on their times: there may be one of the next step.
    next_snapshot = min(
        (snapshot.step for snapshot in practice._snapshots if snapshot.step > 60), default=80
    )
    practice.learner_at(min(61, next_snapshot - 1), steps, ())

    assert len(calls) == 2
    assert restored == [nearest]


def test_snapshots_are_thinned_out_to_their_limit(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(rebuilt_practice, "SNAPSHOT_EVERY_S", 0.0)
    monkeypatch.setattr(rebuilt_practice, "MAX_SNAPSHOT_BYTES", 30_000)
    practice, steps = practice_of("q-learning"), steps_by("q-learning")
    practice.learner_at(80, steps, ())

    assert sum(snapshot.size for snapshot in practice._snapshots) <= 30_000
    assert agent_state(practice.learner_at(30, steps, ()).agent) == states_after("q-learning", 30)


def test_a_long_way_is_gone_in_parts(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(rebuilt_practice, "WORK_S", 0.0)
    practice, steps, refusals = practice_of("q-learning"), steps_by("q-learning"), []
    for _ in range(500):
        try:
            learner = practice.learner_at(40, steps, ())
            break
        except Busy as busy:
            refusals.append(str(busy))

    assert agent_state(learner.agent) == states_after("q-learning", 40)
    assert "ask again" in refusals[0]
    assert any("of 40 steps are done" in refusal for refusal in refusals)


def test_a_practice_that_forgot_steps_or_changes_is_another() -> None:
    practice, steps = practice_of("q-learning"), steps_by("q-learning")
    change = {"step": 5, "settings": {"alpha": 0.5}}
    practice.learner_at(4, steps, (change,))
    assert practice.fits(steps, (change,))
    assert practice.fits(steps, ())  # it was not made yet
    practice.learner_at(6, steps, (change,))
    assert practice.fits(steps, (change, {"step": 9, "settings": {"alpha": 0.1}}))
    assert not practice.fits(steps, ())
    fewer = steps_by("q-learning")
    del fewer.logged[5:]
    assert not practice.fits(fewer, (change,))
    with pytest.raises(NotRebuilt, match=r"step \d+ cannot be explained"):
        practice.learner_at(80, steps, (change,))


def test_an_agent_that_raises_is_named_in_the_error(monkeypatch: pytest.MonkeyPatch) -> None:
    practice, steps = practice_of("q-learning"), steps_by("q-learning")
    learner = practice.learner_at(3, steps, ())

    def breaks(*arguments: object) -> None:
        raise ZeroDivisionError("no luck")

    monkeypatch.setattr(learner.agent, "learn", breaks)
    with pytest.raises(HexapodError, match=r"step 4 .* failed .*ZeroDivisionError: no luck"):
        practice.learner_at(5, steps, ())
    assert agent_state(practice.learner_at(5, steps, ()).agent) == states_after("q-learning", 5)


@pytest.mark.parametrize("agent", ["q-learning", "sarsa"])
def test_the_newest_step_of_a_walk_is_learned_from_once_it_is_known_what_followed(
    agent: str,
) -> None:
    practice, steps = practice_of(agent), steps_by(agent)
    newest = steps.logged[20]
    steps.logged[20] = newest._replace(next_observation=(), next_measured=())
    assert practice.explain(21, steps, ()).update is None
    steps.logged[20] = newest

    assert agent_state(practice.learner_at(30, steps, ()).agent) == states_after(agent, 30)


def test_states_differ_between_moments() -> None:
    """So that the comparisons above compare something."""
    assert states_after("q-learning", 10) != states_after("q-learning", 11)
    assert np.frombuffer(states_after("q-learning", 10)["q"]).size > 0
