"""What-if service: trials, cache, limits, and the pool of worker processes."""

import os
import signal
import threading
import time
from collections.abc import Iterator
from dataclasses import replace
from typing import Any

import psutil
import pytest

from app.features.what_if.what_if import (
    MAX_WAITING,
    SEEDS,
    SPECTATORS_LIMIT_S,
    WhatIf,
    WhatIfRequester,
)
from app.jobs.process_pool import NICENESS, ProcessPool
from app.storage.errors import Busy
from hexapods.agents.registry import BUILT_IN, learns
from hexapods.domain.disturbances import SensorNoise
from hexapods.domain.errors import InvalidInput
from hexapods.domain.settings import SettingValues
from hexapods.domain.world import World
from hexapods.experiments.plan import trial_seed
from hexapods.experiments.trial import TrialConfig, run_trial
from hexapods.runs.config import TrainingConfig, training_config
from tests.jobs.waiting import wait_until

SHORT = training_config(gait="left-right-origin", steps=40)


def changed(settings: dict[str, float], **fields: Any) -> TrainingConfig:
    """Return the training with other settings of its agent."""
    return replace(SHORT, **fields, settings=SHORT.settings | settings)


@pytest.fixture(scope="module")
def pool() -> Iterator[ProcessPool]:
    running = ProcessPool(count=2)
    yield running
    running.close()


@pytest.fixture(scope="module")
def what_if(pool: ProcessPool) -> WhatIf:
    return WhatIf(pool)


def distances(training: TrainingConfig) -> list[float]:
    """Compute the expected distances in a plain loop."""
    kinematic = replace(training, simulator="kinematic", evaluate_every=0)
    seeds = [trial_seed(0, 0, number) for number in range(SEEDS)]
    trials = [TrialConfig(training=replace(kinematic, seed=seed)) for seed in seeds]
    return [run_trial(trial).distances_m[0] for trial in trials]


@pytest.mark.promises
def test_thirty_kinematic_seeds_run_of_each_variant(what_if: WhatIf) -> None:
    chosen = changed({"alpha": 0.9, "epsilon_end": 0.2})
    answer = what_if.ask(chosen)
    assert answer.seeds == 30
    assert answer.greedy_m == pytest.approx(24.833 * 0.02, abs=1e-5)
    assert answer.chosen.distances_m == distances(chosen)
    assert answer.default.distances_m == distances(SHORT)
    assert (answer.chosen.settings["alpha"], answer.default.settings["alpha"]) == (
        0.9,
        0.3,
    )
    for half in (answer.chosen, answer.default):
        far = [metres for metres in half.distances_m if metres >= answer.greedy_m / 2]
        assert half.walkers == len(far) / 30


@pytest.mark.promises
def test_variants_differ_in_settings_only(what_if: WhatIf) -> None:
    answer = what_if.ask(replace(SHORT, observation="commanded"))
    commanded = replace(SHORT, observation="commanded")
    assert answer.default.distances_m == distances(commanded)
    assert answer.chosen == answer.default


@pytest.mark.promises
def test_all_walk_in_the_world_as_it_is_in_the_end(what_if: WhatIf) -> None:
    noise = SensorNoise(sd_m=0.02)
    later = replace(SHORT, world=World((replace(noise, at_step=30),)))
    assert (
        what_if.ask(later).greedy_m == what_if.ask(replace(SHORT, world=World((noise,)))).greedy_m
    )
    assert what_if.ask(later).chosen.distances_m == distances(later)


@pytest.mark.parametrize("agent", [name for name in BUILT_IN if learns(name)])
def test_any_learner_can_be_asked_about(agent: str, what_if: WhatIf) -> None:
    training = training_config(gait="left-right-origin", agent=agent, steps=3, tolerance=0.03)
    answer = what_if.ask(training)
    assert len(answer.chosen.distances_m) == 30
    assert answer.chosen == answer.default
    assert training.settings.keys() == answer.chosen.settings.keys()


def test_cached_trials_are_not_run_again(what_if: WhatIf, pool: ProcessPool) -> None:
    first = what_if.ask(SHORT)
    pids = pool.pids
    # Neither seed, pace nor simulator counts.
    again = what_if.ask(replace(SHORT, seed=7, pace=3.0, evaluate_every=0, simulator="kinematic"))
    assert replace(again, compute_s=first.compute_s) == first
    assert pool.pids == pids
    lower = min(psutil.Process().nice() + NICENESS, 19)
    assert all(psutil.Process(pid).nice() == lower for pid in pids)


@pytest.mark.parametrize(
    ("more", "words"),
    [
        ({"agent": "greedy"}, "does not learn"),
        ({"steps": 2_001}, "at most 2,000"),
        ({"divisions": 6, "grid_side_m": 0.03}, "fewer divisions"),
        ({"agent": "no.such:Agent"}, "no.such"),
        ({"grid_side_m": 0.5}, "reach"),
        ({"agent": "tests.own_agents:Clumsy", "settings": SettingValues({})}, "I tripped"),
    ],
)
def test_invalid_training_is_refused_with_the_reason(
    what_if: WhatIf, more: dict[str, Any], words: str
) -> None:
    with pytest.raises(InvalidInput, match=words):
        what_if.ask(replace(SHORT, **more))
    assert what_if.ask(SHORT).seeds == 30


def test_killed_worker_fails_one_request_only(what_if: WhatIf, pool: ProcessPool) -> None:
    def kill_at_work() -> None:
        for pid in pool.pids:
            os.kill(pid, signal.SIGKILL)

    with pytest.raises(Busy, match="try again"):
        what_if.ask(changed({"alpha": 0.32}), WhatIfRequester(check=kill_at_work))
    what_if.ask(changed({"alpha": 0.31}))
    pids = pool.pids
    for pid in pids:
        os.kill(pid, signal.SIGKILL)
    wait_until(lambda: not any(map(psutil.pid_exists, pids)))
    assert what_if.ask(changed({"alpha": 0.32})).chosen.settings["alpha"] == 0.32


# A world is planned anew after each step, with a discount that hardly converges.
HEAVY = training_config(
    gait="left-right-origin", agent="posterior-sampling", steps=2000, plan_every=1, gamma=0.9999999
)


def test_work_that_takes_too_long_is_refused_before_it_begins(what_if: WhatIf) -> None:
    charged: list[float] = []
    spectator = WhatIfRequester(is_operator=False, charge=charged.append)
    with pytest.raises(InvalidInput, match="may take 10 s; choose fewer steps"):
        what_if.ask(HEAVY, spectator)
    # Timed, not computed.
    assert 0 < sum(charged) < SPECTATORS_LIMIT_S
    with pytest.raises(InvalidInput, match="may take 60 s"):
        what_if.ask(HEAVY)


def test_only_computing_is_charged(what_if: WhatIf) -> None:
    charged: list[float] = []
    spectator = WhatIfRequester(is_operator=False, charge=charged.append)
    first = what_if.ask(changed({"alpha": 0.43}), spectator)
    assert 0 < charged[0] <= first.compute_s
    assert what_if.ask(changed({"alpha": 0.43}), spectator).compute_s == 0.0
    assert len(charged) == 1


@pytest.mark.promises
def test_waiting_for_a_core_is_neither_charged_nor_refused(
    what_if: WhatIf, monkeypatch: pytest.MonkeyPatch
) -> None:
    """The trials take a fraction of a second, on a machine that does something else meanwhile."""
    limit_s = 1.5
    monkeypatch.setattr("app.features.what_if.what_if.SPECTATORS_LIMIT_S", limit_s)
    charged: list[float] = []
    slow = WhatIfRequester(is_operator=False, check=lambda: time.sleep(2), charge=charged.append)
    answer = what_if.ask(changed({"alpha": 0.435}), slow)
    assert charged[0] < limit_s < answer.compute_s


def test_nothing_is_computed_for_a_client_that_has_left(what_if: WhatIf, pool: ProcessPool) -> None:
    def left() -> None:
        raise Busy("the client has closed its connection", 1)

    with pytest.raises(Busy, match="closed its connection"):
        what_if.ask(changed({"alpha": 0.44}), WhatIfRequester(check=left))
    charged: list[float] = []
    what_if.ask(changed({"alpha": 0.44}), WhatIfRequester(charge=charged.append))
    assert charged, "it was not computed before"


@pytest.mark.promises
def test_too_many_waiting_requests_are_refused_as_busy(what_if: WhatIf) -> None:
    answers: list[Any] = []

    def ask(number: int) -> None:
        try:
            answers.append(
                what_if.ask(
                    replace(SHORT, steps=100, settings=SHORT.settings | {"gamma": number / 50})
                )
            )
        except Busy as busy:
            answers.append(busy)

    threads = [threading.Thread(target=ask, args=(n,)) for n in range(2 * MAX_WAITING)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    refusals = [answer for answer in answers if isinstance(answer, Busy)]
    assert len(answers) == 2 * MAX_WAITING
    assert MAX_WAITING - 2 <= len(refusals) <= MAX_WAITING - 1
    assert all(busy.retry_after_s > 0 for busy in refusals)
