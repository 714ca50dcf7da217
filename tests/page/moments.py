"""Moments of runs as the API tells them, for the tests of what the page says.

Of 15 races and 3 practices.

`make page-moments` computes them anew with the real simulator, stage and timeline, and writes
`moments.json.gz`. `tests/page/test-narrative.js` compares each sentence of the page with them.
"""

import gzip
import json
import random
import sys
from collections.abc import Iterator, Sequence
from datetime import UTC, datetime
from pathlib import Path
from typing import Any

from app.events.run_view import run_view
from app.stage.timeline import timeline
from app.storage.run import Run, State
from hexapods.domain.creatures import CREATURES
from hexapods.domain.disturbances import Limp, Lost
from hexapods.domain.records import to_json
from hexapods.domain.robot import PRESETS
from hexapods.domain.world import World
from hexapods.runs.clocks import CLOCKS, Clock
from hexapods.runs.race_config import Branch, RaceConfig
from hexapods.runs.records import LaneFailed
from hexapods.runs.results import TrainingResult, race_result
from tests.stage.stage_parts import StageParts
from tests.storage.stores import temporary_store

FILE = Path(__file__).parent / "moments.json.gz"
STEPS = 24
A_CLASS = ("greedy", "q-learning", "two-step")
DUEL = ("greedy", "q-learning")


class Races:
    """Runs of a store, computed and shown; `entries` has each with its moments."""

    def __init__(self, parts: StageParts) -> None:
        self._parts, self._chance = parts, random.Random(32)
        self.entries: list[dict[str, Any]] = []

    def race(
        self,
        name: str,
        agents: Sequence[str] = DUEL,
        *,
        state: State = "finished",
        records: int | None = None,
        fails: int | None = None,
        clocks: Sequence[Clock] = ("paper",),
        **fields: Any,
    ) -> Run:
        """Compute a race, whole or so many `records` of it; from record `fails` on a lane fails."""
        parts = self._parts
        fields = {"simulator": "mujoco", **fields}
        run, advance = parts.running_race(tuple(agents), STEPS, **fields)
        parts.store.update(run.id, started_at=datetime.now(UTC), name=name)
        recorded = 0
        while recorded != records and advance():
            recorded += 1
            if recorded == fails:
                parts.recordings.add(run.id, LaneFailed(0, 1 + recorded // len(agents), "it broke"))
                break
        lanes = parts.recordings.race(run.id)
        assert lanes is not None
        assert isinstance(run.config, RaceConfig)
        parts.recordings.finish(run.id)
        done = sum(len(lane.steps) for lane in lanes)
        result = None if state in ("running", "interrupted") else race_result(lanes, run.config)
        error = "No lane could finish the race: it broke." if state == "failed" else None
        ended_at = None if state == "running" else datetime.now(UTC)
        run = parts.store.change(
            run.id, ["running"], state, done=done, result=result, error=error, ended_at=ended_at
        )
        parts.publish(run)
        for clock in clocks:
            race_timeline = to_json(timeline(lanes, (None,) * len(lanes), STEPS, clock))
            self._show(run, clock, race_timeline)
        return run

    def practice(
        self, name: str, state: State, steps: int, total: int = 150, lost: int = 0
    ) -> None:
        """Compute so many steps of a practice; of the last `lost` nothing is recorded."""
        parts = self._parts
        run, advance = parts.running_training(total, evaluate_every=20)
        parts.store.update(run.id, started_at=datetime.now(UTC), name=name)
        for _ in range(steps - lost):
            advance()
        recording = parts.recordings.training(run.id)
        assert recording is not None
        parts.recordings.finish(run.id)
        tests = [
            {
                "step": evaluation.step,
                "distance_m": evaluation.distance_m,
                "epsilon": evaluation.epsilon,
            }
            for evaluation in recording.evaluations
        ]
        at_end = TrainingResult(distance_m=0.123, greedy_distance_m=0.4)
        result = at_end if state in ("finished", "stopped") else None
        run = parts.store.change(
            run.id, ["running"], state, done=steps, result=result, ended_at=datetime.now(UTC)
        )
        parts.publish(run)
        self._show(run, "paper", None, tests)

    def _show(
        self,
        run: Run,
        clock: Clock,
        race_timeline: dict[str, Any] | None,
        tests: Sequence[object] = (),
    ) -> None:
        stage = self._parts.stage
        stage.set(run_id=run.id, clock=clock, playing=False)
        moments = []
        for time_s, ends_at_time_out in self._times(race_timeline):
            stage.set(end_at_time_out=ends_at_time_out, time_s=time_s)
            self._parts.next_frame()
            moments.append({"stage": to_json(stage.state()), "scene": to_json(stage.scene())})
        view = json.loads(json.dumps(run_view(run), default=str))
        self.entries.append(
            {"run": view, "timeline": race_timeline, "tests": list(tests), "moments": moments}
        )

    def _times(self, race_timeline: dict[str, Any] | None) -> Iterator[tuple[float, bool]]:
        """Moments of a run: its start and end, ends of steps as pages name them, and others [s]."""
        chance = self._chance
        if race_timeline is None:
            yield from (
                (time_s, True) for time_s in (0.0, *sorted(chance.uniform(0, 48) for _ in range(8)))
            )
            yield 1e6, True
            return
        ends = sorted({t for lane in race_timeline["lanes"] for t, _ in lane["points"]})
        time_out_s = race_timeline["first_finish_s"]
        yield 0.0, True
        for time_s in chance.sample(ends, min(4, len(ends))):
            yield round(time_s, 3), False
        for _ in range(4):
            yield chance.uniform(0, ends[-1]), False
        if time_out_s is not None:
            yield round(time_out_s, 3), True
            yield time_out_s - 0.05, True
            yield time_out_s + 0.05, False
        yield 1e6, False
        yield 1e6, True


def moments() -> list[dict[str, Any]]:
    """Compute all runs, and return each with its moments as the API tells them."""
    with temporary_store() as store:
        races = Races(StageParts(store))
        for name in ("stiff", "compliant", "slippery", "dog", "centipede"):
            walk: dict[str, Any] = {"robot": PRESETS[name], "gait": CREATURES[name].gait}
            agents = A_CLASS if name == "stiff" else DUEL
            clocks = CLOCKS if name == "stiff" else ("paper",)
            races.race(f"Race of {name}", agents, clocks=clocks, **walk)
        races.race("Stopped", A_CLASS, state="stopped", records=40)
        races.race("Interrupted", state="interrupted", records=27)
        races.race("Failed", state="failed", fails=21)
        races.race("Live", A_CLASS, state="running", records=50)
        races.race("Decided", ("q-learning", "greedy"), state="running", records=47)
        races.race("Alone", ("greedy",))
        races.race("Tie", ("greedy", "greedy", "random-walk"))
        falls = World((Lost(legs=(1, 2, 3), at_step=9),))
        races.race("Falls", ("greedy", "random-walk"), world=falls)
        first = races.race("First")
        limp = World((Limp(legs=(1, 4), at_step=8),))
        races.race("Raced on", branch_from=Branch(first.id, 8), world=limp)
        races.practice("Finished", "finished", 150)
        races.practice("Stopped practice", "stopped", 90)
        races.practice("Interrupted practice", "interrupted", 50, lost=7)
        return races.entries


def main() -> None:
    """Write the file."""
    text = json.dumps(moments(), separators=(",", ":"))
    FILE.write_bytes(gzip.compress(text.encode(), mtime=0))
    sys.stdout.write(f"{FILE.name}: {FILE.stat().st_size // 1024} kB\n")


if __name__ == "__main__":
    main()
