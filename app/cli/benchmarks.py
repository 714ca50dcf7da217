"""Benchmarks of learning and look-ahead, as ratios within one run.

Machines are shared and noisy: the compared measurements alternate, and the minimum over several
rounds is used, since noise only adds time.
"""

import statistics
import time
from collections.abc import Callable, Sequence

import mujoco
import numpy as np
from mujoco.batch import Batch

from hexapods.agents.lookahead import TwoStep
from hexapods.assembly import build_learner, build_walkers
from hexapods.domain.observation import legal_actions, observe
from hexapods.domain.types import Action, FloatArray
from hexapods.drawing.replay_encoding import encode_frames
from hexapods.machine import cores
from hexapods.physics.mjcf import compile_visual_model
from hexapods.physics.mujoco_simulator import MujocoSimulator, MujocoState
from hexapods.runs.config import TrainingConfig, WalkingProblem
from hexapods.runs.lane import LaneConfig
from hexapods.runs.race_config import RaceConfig
from hexapods.runs.racing import race, record_race
from hexapods.runs.records import LaneStep, StepTaken
from hexapods.runs.training import train
from hexapods.runs.walker import SimulatorExpand, Walker
from hexapods.shows.race_show import RaceShow
from hexapods.shows.replay import FRAMES_PER_S, SEGMENT_FRAMES, Replay
from hexapods.shows.scene_spec import PAPERS_LANES, race_scene
from hexapods.shows.show import RunLabel

WALK = WalkingProblem(gait="left-right-origin")
ROUNDS = 5


def training() -> dict[str, float]:
    """Measure the time of a training without evaluations, relative to its physics alone.

    Also how long physics takes relative to a model with the geoms that are only drawn.
    """
    config = TrainingConfig(gait=WALK.gait, steps=200, evaluate_every=0)
    replay = _Replay(threads=1)
    drawn = _Replay(threads=1, model=compile_visual_model(WALK.robot))
    state = replay.simulator.rest()
    for record in train(build_learner(config), config):
        if isinstance(record, StepTaken):
            replay.add([state], [record.action])
            drawn.add([state], [record.action])
            state = replay.simulator.step(state, record.action).state
    training_s, physics_s, drawn_s = [], [], []
    for _ in range(ROUNDS):
        learner = build_learner(config)
        began = time.perf_counter()
        for _record in train(learner, config):
            pass
        training_s.append(time.perf_counter() - began)
        physics_s.append(_seconds(replay.run))
        drawn_s.append(_seconds(drawn.run))
    robot = WALK.robot
    substeps = config.steps * (robot.swing_substeps + robot.shift_substeps)
    return {
        "training_over_physics": min(training_s) / min(physics_s),
        "physics_substeps_per_second": substeps / min(physics_s),
        "physics_over_all_that_is_drawn": min(physics_s) / min(drawn_s),
        "training_steps_per_second": config.steps / min(training_s),
    }


def look_ahead() -> dict[str, float]:
    """Measure two-step decisions on one and on all threads, and their overhead over physics."""
    one_thread, parallel, replay = _two_step(threads=1), _two_step(threads=0), _Replay(threads=0)
    _add_layers(replay)
    single_s, parallel_s, physics_s = [], [], []
    for _ in range(ROUNDS):
        single_s.append(_seconds(one_thread.decide))
        parallel_s.append(_seconds(parallel.decide))
        physics_s.append(_seconds(replay.run))
    return {
        "lookahead_speedup": min(single_s) / min(parallel_s),
        "planning_overhead": (min(parallel_s) - min(physics_s)) / min(parallel_s),
        "two_step_decision_s": min(parallel_s),
        "threads": float(cores()),
    }


def racing() -> dict[str, float]:
    """Measure a two-step lane's decision time relative to its motion time, in a race."""
    config = RaceConfig(gait=WALK.gait, lanes=(LaneConfig(agent="two-step"),), steps=10)
    walkers = build_walkers(config, [None])
    walkers[0].decide()  # warm-up of its threads
    records = race(walkers, config.steps, time.perf_counter)
    steps = [record for record in records if isinstance(record, LaneStep)]
    decided = sum(step.decision_s for step in steps)
    walked = sum(float(step.motion.time_s[-1]) for step in steps)
    return {"two_step_decision_over_motion": decided / walked}


class _Replay:
    """Simulates recorded states and commands again, as a baseline of physics alone."""

    def __init__(self, threads: int, model: mujoco.MjModel | None = None) -> None:
        self.simulator = MujocoSimulator(WALK.robot, WALK.resolved_gait, WALK.grid, threads)
        self._model = model or self.simulator.model
        self._threads = threads
        self._layers: list[tuple[FloatArray, FloatArray]] = []
        self._batches: dict[int, Batch] = {}

    def add(self, states: Sequence[MujocoState], actions: Sequence[Action]) -> None:
        """Add a layer of states and actions, which `run` simulates in one call."""
        rows = np.array([state.row for state in states])
        self._layers.append((rows, self.simulator.commands(states, actions)))
        if len(rows) not in self._batches:
            self._batches[len(rows)] = Batch(self._model, len(rows), self._threads)

    def run(self) -> None:
        """Simulate every layer."""
        for rows, commands in self._layers:
            batch = self._batches[len(rows)]
            batch.state[:] = rows
            batch.rollout(commands.shape[1], commands, record=())


def _add_layers(replay: _Replay) -> None:
    """Add the two layers of a two-step agent's first decision."""
    simulator = replay.simulator
    states: list[MujocoState] = [simulator.rest()]
    for _ in range(2):
        legal = [legal_actions(observe(simulator, s, "measured"), len(WALK.grid)) for s in states]
        origins = [s for s, actions in zip(states, legal, strict=True) for _ in actions]
        chosen = [action for actions in legal for action in actions]
        replay.add(origins, chosen)
        states = simulator.expand(origins, chosen).states


def _two_step(threads: int) -> Walker:
    """Return a two-step walker at rest, with a warmed-up simulator."""
    simulator = MujocoSimulator(WALK.robot, WALK.resolved_gait, WALK.grid, threads)
    expand = SimulatorExpand(simulator, "measured")
    walker = Walker(simulator, TwoStep(expand), "measured", expand)
    walker.decide()
    return walker


def _seconds(function: Callable[[], object]) -> float:
    began = time.perf_counter()
    function()
    return time.perf_counter() - began


def picture() -> dict[str, float]:
    """Measure what a second of the picture of three walking robots takes, and its size."""
    lanes = tuple(LaneConfig(agent=agent) for agent in PAPERS_LANES)
    config = RaceConfig(gait=WALK.gait, simulator="kinematic", lanes=lanes)
    walkers = build_walkers(config, [None] * len(lanes))
    recorded = list(record_race(walkers, config, time.perf_counter))[-1]
    # Without thinking times, so that every robot moves in every frame.
    show = RaceShow(race_scene(config), config.steps, "free", lambda: recorded)
    replay = Replay(show, RunLabel(None, "Race"))
    taken_s, sizes = [], []
    for number in range(ROUNDS):
        times_s = replay.segment_times_s(0, number)
        began_s = time.process_time()
        sizes.append(len(encode_frames(replay, times_s)))
        taken_s.append(time.process_time() - began_s)
    segment_s = SEGMENT_FRAMES / FRAMES_PER_S
    return {
        "picture_encoding_share": min(taken_s) / segment_s,
        "picture_bytes_per_second": statistics.median(sizes) / segment_s,
    }
