"""Learners that are built again from the log of their training, step by step."""

from collections.abc import Sequence
from functools import cache
from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray

from hexapods.agents.registry import BUILT_IN, learns
from hexapods.assembly import build_learner, build_walkers, rebuild_lane, rebuild_learner
from hexapods.domain.disturbances import Limp, SensorNoise
from hexapods.domain.observation import Observation
from hexapods.domain.world import World
from hexapods.runs.config import TrainingConfig, training_config
from hexapods.runs.lane import lane_config
from hexapods.runs.race_config import RaceConfig
from hexapods.runs.racing import race
from hexapods.runs.rebuilding import NotRebuilt, RebuiltLearner
from hexapods.runs.records import LaneStep
from hexapods.runs.tables import Checkpoint, snapshot
from hexapods.runs.training import Learner, train
from hexapods.runs.transition_log import Logged, TransitionLog, Transitions
from tests.quick_robot import HASTY

LEARNERS = [name for name in BUILT_IN if learns(name)]


def config_of(agent: str, observation: Observation = "measured") -> TrainingConfig:
    return training_config(
        agent,
        gait="left-right-origin",
        simulator="kinematic",
        observation=observation,
        steps=80,
        seed=4,
        evaluate_every=25,
    )


@cache
def practised(agent: str, observation: Observation = "measured") -> tuple[Learner, Transitions]:
    """Return a learner after its training, and the log of it."""
    config = config_of(agent, observation)
    learner = build_learner(config)
    learner.logged = []
    for _ in train(learner, config):
        pass
    taken = learner.take_transitions()
    assert taken is not None
    return learner, taken


def agent_state(agent: object) -> dict[str, bytes]:
    state: dict[str, NDArray[Any]] = agent.state()  # type: ignore[attr-defined]
    return {name: array.tobytes() for name, array in state.items()}


def fed(rebuilt: RebuiltLearner, steps: Sequence[Logged]) -> RebuiltLearner:
    for step in steps:
        rebuilt.take(step)
    return rebuilt


def steps_of(log: Transitions) -> list[Logged]:
    return [log.step(number) for number in range(len(log.rewards_m))]


@pytest.mark.parametrize("agent", LEARNERS)
def test_a_rebuilt_learner_is_that_of_the_training_to_the_last_bit(agent: str) -> None:
    learner, log = practised(agent)
    rebuilt = fed(rebuild_learner(config_of(agent)), steps_of(log))

    assert rebuilt.step == 80
    assert agent_state(rebuilt.agent) == agent_state(learner.walker.agent)


@pytest.mark.parametrize("observation", ["commanded", "planned"])
def test_every_reading_of_the_feet_is_rebuilt(observation: Observation) -> None:
    """The linear model reads the plan and the measured cells, whatever the observation is."""
    for agent in ("linear-model", "q-learning"):
        learner, log = practised(agent, observation)
        rebuilt = fed(rebuild_learner(config_of(agent, observation)), steps_of(log))

        assert agent_state(rebuilt.agent) == agent_state(learner.walker.agent)


@pytest.mark.test
@pytest.mark.parametrize("agent", ["q-learning", "linear-model"])
def test_a_disturbed_training_on_mujoco_is_rebuilt_without_physics(agent: str) -> None:
    world = World((SensorNoise(sd_m=0.004), Limp(legs=(1, 4), at_step=12)))
    config = training_config(
        agent,
        gait="left-right-origin",
        robot=HASTY,
        steps=25,
        world=world,
        tolerance=0.1,
        evaluate_every=10,
    )
    learner = build_learner(config)
    learner.logged = []
    for _ in train(learner, config):
        pass
    taken = learner.take_transitions()
    assert taken is not None
    rebuilt = fed(rebuild_learner(config), steps_of(taken))

    assert agent_state(rebuilt.agent) == agent_state(learner.walker.agent)


@pytest.mark.parametrize("agent", LEARNERS)
def test_a_snapshot_goes_on_as_the_learner_did(agent: str) -> None:
    learner, log = practised(agent)
    steps = steps_of(log)
    state = fed(rebuild_learner(config_of(agent)), steps[:33]).snapshot()
    again = rebuild_learner(config_of(agent))
    again.restore(state)
    assert again.step == 33
    fed(again, steps[33:])

    assert agent_state(again.agent) == agent_state(learner.walker.agent)
    assert 1000 < state.size < 300_000


@pytest.mark.parametrize("agent", LEARNERS)
def test_explained_steps_are_those_of_the_training(agent: str) -> None:
    learner, log = practised(agent)
    rebuilt = rebuild_learner(config_of(agent))
    for step in steps_of(log):
        explained = rebuilt.explain(step)
        assert explained.logged == step
        assert explained.update is not None
        assert explained.choice is not None
        assert explained.choice.action == step.action

    assert agent_state(rebuilt.agent) == agent_state(learner.walker.agent)


def test_the_choice_of_an_on_policy_learner_is_explained_with_the_step_before() -> None:
    _, log = practised("sarsa")
    steps = steps_of(log)
    rebuilt = fed(rebuild_learner(config_of("sarsa")), steps[:10])
    can_explain = []
    for number, explain_next in ((10, False), (11, True)):
        rebuilt.take(steps[number], explain_next=explain_next)
        can_explain.append(rebuilt.can_explain)
    assert can_explain == [False, True]
    explained = rebuilt.explain(steps[12])

    assert explained.choice is not None
    assert explained.choice.action == steps[12].action


def test_rates_that_were_changed_are_changed_again() -> None:
    config = config_of("q-learning")
    learner = build_learner(config)
    learner.logged = []
    for _ in train(learner, config):
        if learner.step == 30:
            learner.walker.agent.tune(alpha=0.9, epsilon=0.0)  # type: ignore[attr-defined]
    taken = learner.take_transitions()
    assert taken is not None
    rebuilt = rebuild_learner(config)
    for number, step in enumerate(steps_of(taken)):
        if number == 30:
            rebuilt.tune({"step": 30, "pace": 3.0, "settings": {"alpha": 0.9, "epsilon": 0.0}})
        rebuilt.take(step)

    assert agent_state(rebuilt.agent) == agent_state(learner.walker.agent)
    with pytest.raises(NotRebuilt, match=r"step \d+ cannot be explained"):
        fed(rebuild_learner(config), steps_of(taken))


def test_a_training_that_continues_is_rebuilt_from_the_table_it_continues() -> None:
    config = config_of("sarsa-lambda")
    first, _ = practised("sarsa-lambda")
    table = snapshot(first, config)
    learner = build_learner(config, table)
    learner.logged = []
    for _ in train(learner, config):
        pass
    taken = learner.take_transitions()
    assert taken is not None
    rebuilt = fed(rebuild_learner(config, table), steps_of(taken))

    assert agent_state(rebuilt.agent) == agent_state(learner.walker.agent)


@pytest.mark.parametrize("keep_learning", [False, True])
@pytest.mark.parametrize("agent", ["sarsa", "q-learning", "linear-model"])
def test_a_lane_is_rebuilt_from_its_recording(agent: str, keep_learning: bool) -> None:
    learner, _ = practised(agent)
    table: Checkpoint = snapshot(learner, config_of(agent))
    lane = lane_config(agent, keep_learning=keep_learning, has_training=True)
    config = RaceConfig(gait="left-right-origin", simulator="kinematic", lanes=(lane,), steps=20)
    (walker,) = build_walkers(config, [table])
    records = [record for record in race([walker], 20, lambda: 0.0) if isinstance(record, LaneStep)]
    rebuilt = rebuild_lane(config, 0, table)
    for record, after in zip(records, [*records[1:], None], strict=True):
        seen = () if after is None else after.observation
        explained = rebuilt.explain(
            Logged(
                record.observation, record.observation, record.action, record.reward_m, seen, seen
            )
        )
        assert (explained.update is None) == (not keep_learning or after is None)

    if keep_learning:
        assert agent_state(rebuilt.agent) == agent_state(walker.agent)


def test_a_log_grows_by_parts_and_is_cut_where_a_training_resumes() -> None:
    _, whole = practised("q-learning")
    log = TransitionLog()
    log.extend(part_of(whole, 0, 30))
    log.extend(part_of(whole, 20, 50))  # a part that is sent again

    assert len(log) == 50
    with pytest.raises(ValueError, match="follow step 60, not step 50"):
        log.extend(part_of(whole, 60, 70))
    assert [log.part(0, 99).step(n) for n in range(50)] == steps_of(whole)[:50]
    assert log.part(10, 12).step(1) == whole.step(11)
    cut = log.truncated(40)
    assert cut is not None
    assert len(cut) == 40
    cut.extend(part_of(whole, 40, 80))
    assert [cut.part(0, 80).step(n) for n in range(80)] == steps_of(whole)
    assert log.truncated(51) is None


def test_steps_that_cannot_be_are_refused() -> None:
    _, whole = practised("q-learning")
    whole.check(3, 5)

    stays = whole.actions.copy()
    stays[7] = 1, whole.observed[7][1]
    for changed, reason in (
        (whole._replace(actions=stays), "not allowed"),
        (whole._replace(actions=stays[:5]), "do not fit together"),
        (whole._replace(rewards_m=np.full(80, np.nan)), "cannot be done"),
        (whole._replace(observed=np.full((81, 3), 9, np.uint8)), "on no foot grid"),
        (whole._replace(actions=stays.astype(float)), "no numbers of cells"),
    ):
        with pytest.raises(ValueError, match=reason):
            changed.check(3, 5)


def part_of(log: Transitions, first: int, end: int) -> Transitions:
    return Transitions(
        first,
        log.observed[first : end + 1],
        log.measured[first : end + 1],
        log.actions[first:end],
        log.rewards_m[first:end],
    )
