"""Test set-up: a stage with a fake clock, and runs computed by the kinematic simulator."""

import time
from collections.abc import Callable
from datetime import UTC, datetime
from typing import Any

import numpy as np

from app.events.bus import Channel, EventBus
from app.events.event_records import DeletedRun
from app.stage.stage import Stage
from app.storage.database.store import RunStore
from app.storage.recordings import Recordings
from app.storage.run import NOT_ENDED, Run
from hexapods.assembly import build_learner, build_walkers
from hexapods.runs.config import TrainingConfig, training_config
from hexapods.runs.lane import LaneConfig
from hexapods.runs.race_config import RaceConfig
from hexapods.runs.racing import race
from hexapods.runs.recording import LaneRecording
from hexapods.runs.records import StepTaken
from hexapods.runs.training import train
from hexapods.shows.stage_frame import StageFrame

AdvanceRun = Callable[[], bool]
"""Computes a run's next step; False at the end."""

FRAME_S = 1 / 30
GAIT = "left-right-origin"


class StageParts:
    """A stage with its store, recordings and bus; runs advance by steps, playback by frames."""

    def __init__(self, store: RunStore) -> None:
        self.now = 100.0
        self.store, self.recordings, self.bus = store, Recordings(store), EventBus()
        self.channel = Channel(self.bus)
        self.stage = Stage(self.store, self.recordings, self.channel, now=lambda: self.now)
        self._run_count = 0

    def watch(self, seconds: float) -> list[StageFrame]:
        """Advance the clock and return every frame."""
        frames = []
        for _ in range(round(seconds / FRAME_S)):
            self.now += FRAME_S
            frames.append(self.stage.frame())
        return frames

    def watch_to_end(self, at_most_s: float = 200.0) -> list[StageFrame]:
        """Return every frame until the show has ended."""
        frames: list[StageFrame] = []
        while not self.stage.state().ended:
            frames += self.watch(FRAME_S)
            assert len(frames) < at_most_s / FRAME_S, "the show does not end"
        return frames

    def next_frame(self) -> StageFrame:
        """Return the frame 0.2 s later."""
        return self.watch(0.2)[-1]

    def create(self, config: TrainingConfig | RaceConfig, **fields: Any) -> Run:
        """Store a queued run without a recording."""
        self._run_count += 1
        kind = "race" if isinstance(config, RaceConfig) else "training"
        lanes = config.lanes if isinstance(config, RaceConfig) else ()
        fields = {
            "name": f"{kind.title()} {self._run_count}",
            "id": f"{kind}{self._run_count:06}",
            "total": config.steps,
            "lane_training_ids": tuple(None for _ in lanes),
            **fields,
        }
        run = Run(kind=kind, config=config, **fields)
        self.store.create(run)
        return run

    def set_state(self, run: Run, state: Any) -> None:
        """Change a run's state from any state, and publish it."""
        ended_at = None if state in NOT_ENDED else datetime.now(UTC)
        before = self.store.get(run.id).state
        self.publish(self.store.change(run.id, [before], state, ended_at=ended_at))

    def publish(self, run: Run) -> None:
        """Publish a run that changed, as jobs do."""
        self.bus.publish_run(run)

    def delete(self, run: Run) -> None:
        """Delete an ended run."""
        self.store.delete(run.id)
        self.recordings.discard(run.id)
        self.bus.publish("run-deleted", DeletedRun(id=run.id), run.id)

    def finished_race(
        self, agents: tuple[str, ...] = ("greedy", "two-step"), steps: int = 12, **fields: Any
    ) -> Run:
        """Compute a whole race."""
        run, advance = self.running_race(agents, steps, **fields)
        return self._finish(run, advance)

    def running_race(
        self, agents: tuple[str, ...] = ("greedy", "two-step"), steps: int = 12, **fields: Any
    ) -> tuple[Run, AdvanceRun]:
        """Return a running race, and a function that computes the next step of one lane.

        Args:
            agents: of the lanes.
            steps: of each lane.
            fields: of the config; its simulator is the kinematic one by default.
        """
        lanes = tuple(LaneConfig(agent=agent) for agent in agents)
        fields = {"gait": GAIT, "simulator": "kinematic", **fields}
        config = RaceConfig(lanes=lanes, steps=steps, **fields)
        run = self.create(config, state="running")
        walkers = build_walkers(config, [None] * len(lanes))
        poses = [w.simulator.pose(w.state).astype(np.float32) for w in walkers]
        self.recordings.begin_race(
            run.id, [LaneRecording(a, pose) for a, pose in zip(agents, poses, strict=True)]
        )
        records = race(walkers, steps, time.perf_counter)

        def advance() -> bool:
            record = next(records, None)
            if record is not None:
                self.recordings.add(run.id, record)
            return record is not None

        return run, advance

    def _finish(self, run: Run, advance: AdvanceRun) -> Run:
        while advance():
            pass
        self.set_state(run, "finished")
        return run

    def finished_training(self, steps: int = 100, **fields: Any) -> Run:
        """Compute a whole training."""
        run, advance = self.running_training(steps, **fields)
        return self._finish(run, advance)

    def running_training(self, steps: int = 100, **fields: Any) -> tuple[Run, AdvanceRun]:
        """Return a running training, and a function that computes its next step."""
        config = training_config(
            **{"gait": GAIT, "simulator": "kinematic", "steps": steps, **fields}
        )
        run = self.create(config, state="running")
        learner = build_learner(config)
        pose = learner.walker.simulator.pose(learner.walker.state)
        self.recordings.begin_training(run.id, pose.astype(np.float32))
        records = train(learner, config, record=True)

        def advance() -> bool:
            for record in records:
                self.recordings.add(run.id, record)
                if isinstance(record, StepTaken):
                    return True
            return False

        return run, advance
