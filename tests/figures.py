"""Runs behind the figures of the specification; module-level, so that a pool can do them."""

from collections.abc import Callable, Iterable
from concurrent.futures import ProcessPoolExecutor
from typing import Any, TypeVar

import numpy as np

from hexapods.assembly import build_learner, build_walkers
from hexapods.domain.observation import Observation
from hexapods.domain.robot import robot
from hexapods.domain.types import FloatArray
from hexapods.processes import process_context
from hexapods.runs.config import TrainingConfig, training_config
from hexapods.runs.lane import LaneConfig
from hexapods.runs.race_config import RaceConfig
from hexapods.runs.tables import Checkpoint, from_bytes, snapshot, to_bytes
from hexapods.runs.training import evaluate, train, walk
from tests.promises.length import at_length

T = TypeVar("T")
R = TypeVar("R")

H_M = 0.02
"""Half the side of the default foot grid, in which kinematic distances are given."""
GREEDY_H = 24.833
MEASURED_STEPS = at_length((250, 500), (250, 500, 1000))
NINE_CELLS_STEPS = at_length((500,), (250, 500, 1000))
COMMANDED_STEPS = at_length((1000,), (500, 1000))
BLOCK_STEPS = (250, 500, 750, 1000)
_FEW = {
    "measured 250": 120,
    "measured 500": 200,
    "nine cells 500": 120,
    "commanded 1000": 100,
    "blocks": 200,
}
"""The gate's number of seeds of each row: enough for its figures."""
WORKERS = 2


def in_a_pool(run: Callable[[T], R], over: Iterable[T], chunk: int = 1) -> list[R]:
    """`run` of each, in order."""
    with ProcessPoolExecutor(WORKERS, mp_context=process_context()) as pool:
        return list(pool.map(run, over, chunksize=chunk))


def seeds_of(row: str) -> int:
    """Return how many seeds a row has."""
    return at_length(_FEW.get(row, 0), 1000)


def interquartile_mean(values: FloatArray) -> float:
    """Mean of the middle half."""
    quarter, ordered = len(values) // 4, np.sort(values)
    return float(ordered[quarter : len(values) - quarter].mean())


def look_ahead(run: tuple[str, str, str, dict[str, Any]]) -> float:
    """Distance of an agent in 50 steps [m]: agent, gait, simulator, conditions."""
    agent, gait, simulator, has = run
    config = RaceConfig(
        gait=gait,
        simulator=simulator,  # type: ignore[arg-type]
        robot=robot(has),
        lanes=(LaneConfig(agent=agent),),
    )
    (walker,) = build_walkers(config, [None], threads=1)
    distance_m, _ = walk(walker, record=False)
    return distance_m


def practise(config: TrainingConfig) -> float:
    """Distance of a learner in 50 steps after its practice [m]."""
    learner = build_learner(config)
    for _ in train(learner, config):
        pass
    return evaluate(learner, config, 0.0).distance_m


def _kinematic(seed: int, steps: int, observation: Observation, divisions: int = 2) -> Any:
    return training_config(
        gait="left-right-origin",  # the law is the same in all gaits
        simulator="kinematic",
        seed=seed,
        steps=steps,
        observation=observation,
        divisions=divisions,
        evaluate_every=0,
    )


def kinematic_rows(seed: int) -> dict[str, float]:
    """Return a seed's entry in every row of kinematic Q-learning that has this seed [h]."""
    practices = {
        **{f"measured {steps}": _kinematic(seed, steps, "measured") for steps in MEASURED_STEPS},
        **{
            f"nine cells {steps}": _kinematic(seed, steps, "measured", 3)
            for steps in NINE_CELLS_STEPS
        },
        **{f"commanded {steps}": _kinematic(seed, steps, "commanded") for steps in COMMANDED_STEPS},
    }
    distances_m = {
        row: practise(config) for row, config in practices.items() if seed < seeds_of(row)
    }
    if seed < seeds_of("blocks"):
        distances_m |= _blocks(seed)
    return {name: metres / H_M for name, metres in distances_m.items()}


def _blocks(seed: int) -> dict[str, float]:
    """Practise in blocks as in the paper's Figure 4: learn 250 steps, save, load, learn 250."""
    config, distances_m = _kinematic(seed, 250, "commanded"), {}
    table: Checkpoint | None = None
    for steps in BLOCK_STEPS:
        learner = build_learner(config, table)
        for _ in train(learner, config):
            pass
        distances_m[f"block {steps}"] = evaluate(learner, config, 0.0).distance_m
        table = from_bytes(to_bytes(snapshot(learner, config)), "block.npz")
    return distances_m
