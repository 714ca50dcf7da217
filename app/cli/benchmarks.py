"""Benchmarks of learning and looking ahead, as ratios within one run.

Machines are shared and noisy: what is compared is measured in turns, and the best of several
turns counts, since noise only ever adds.
"""

import os
import time
from collections.abc import Callable, Sequence

import numpy as np
from mujoco.batch import Batch

from app.agents.lookahead import TwoStep
from app.assembly import build_learner, build_walkers
from app.domain.observation import legal_actions, observe
from app.domain.types import Action, FloatArray
from app.physics.mujoco_simulator import MujocoSimulator, MujocoState
from app.runs.clocks import motion_s
from app.runs.config import LaneConfig, RaceConfig, TrainingConfig, WalkingProblem
from app.runs.racing import race
from app.runs.records import LaneStep, StepTaken
from app.runs.training import train
from app.runs.walker import SimulatorExpand, Walker

WALK = WalkingProblem(gait="left-right-origin")
TURNS = 5


def training() -> dict[str, float]:
    """Time of a training without evaluations over that of the bare physics of its substeps."""
    config = TrainingConfig(gait=WALK.gait, steps=200, evaluate_every=0)
    replay = _Replay(threads=1)
    state = replay.simulator.rest()
    for record in train(build_learner(config), config):
        if isinstance(record, StepTaken):
            replay.add([state], [record.action])
            state = replay.simulator.step(state, record.action).state
    whole, bare = [], []
    for _ in range(TURNS):
        learner = build_learner(config)
        began = time.perf_counter()
        for _record in train(learner, config):
            pass
        whole.append(time.perf_counter() - began)
        bare.append(_seconds(replay.run))
    return {
        "training_over_physics": min(whole) / min(bare),
        "training_steps_per_second": config.steps / min(whole),
    }


def look_ahead() -> dict[str, float]:
    """Two-step decisions on one thread and on all, and what of them is not physics."""
    one, everyone, replay = _two_step(threads=1), _two_step(threads=0), _Replay(threads=0)
    _add_layers(replay)
    slow, quick, bare = [], [], []
    for _ in range(TURNS):
        slow.append(_seconds(one.decide))
        quick.append(_seconds(everyone.decide))
        bare.append(_seconds(replay.run))
    return {
        "lookahead_speedup": min(slow) / min(quick),
        "planning_overhead": (min(quick) - min(bare)) / min(quick),
        "two_step_decision_s": min(quick),
        "threads": float(len(os.sched_getaffinity(0))),
    }


def racing() -> dict[str, float]:
    """A two-step lane's decision time over its motion time, in a race."""
    config = RaceConfig(gait=WALK.gait, lanes=(LaneConfig(agent="two-step"),), steps=10)
    walkers = build_walkers(config, [None])
    walkers[0].decide()  # warms its threads up
    records = race(walkers, config.steps, time.perf_counter)
    steps = [record for record in records if isinstance(record, LaneStep)]
    decided = sum(step.decision_s for step in steps)
    return {"two_step_decision_over_motion": decided / sum(map(motion_s, steps))}


class _Replay:
    """Physics alone: the same states and the same commands again, and nothing around them."""

    def __init__(self, threads: int) -> None:
        self.simulator = MujocoSimulator(WALK.robot, WALK.resolved_gait, WALK.grid, threads)
        self._threads = threads
        self._layers: list[tuple[FloatArray, FloatArray]] = []
        self._batches: dict[int, Batch] = {}

    def add(self, states: Sequence[MujocoState], actions: Sequence[Action]) -> None:
        """A layer to be simulated in one call."""
        rows = np.array([state.row for state in states])
        self._layers.append((rows, self.simulator.commands(states, actions)))
        if len(rows) not in self._batches:
            self._batches[len(rows)] = Batch(self.simulator.model, len(rows), self._threads)

    def run(self) -> None:
        """Simulate every layer."""
        for rows, commands in self._layers:
            batch = self._batches[len(rows)]
            batch.state[:] = rows
            batch.rollout(commands.shape[1], commands, record=())


def _add_layers(replay: _Replay) -> None:
    """The two layers of the first decision of a two-step agent."""
    simulator = replay.simulator
    states: list[MujocoState] = [simulator.rest()]
    for _ in range(2):
        legal = [legal_actions(observe(simulator, s, "measured"), len(WALK.grid)) for s in states]
        origins = [s for s, actions in zip(states, legal, strict=True) for _ in actions]
        chosen = [action for actions in legal for action in actions]
        replay.add(origins, chosen)
        states = simulator.expand(origins, chosen).states


def _two_step(threads: int) -> Walker:
    """A walker at rest; its simulator has warmed up."""
    simulator = MujocoSimulator(WALK.robot, WALK.resolved_gait, WALK.grid, threads)
    foresight = SimulatorExpand(simulator, "measured")
    walker = Walker(simulator, TwoStep(foresight), "measured", foresight)
    walker.decide()
    return walker


def _seconds(work: Callable[[], object]) -> float:
    began = time.perf_counter()
    work()
    return time.perf_counter() - began
