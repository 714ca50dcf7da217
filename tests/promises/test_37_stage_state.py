"""Promise 37: the page tells the truth: what the stage says agrees with the runs' states.

Model-based test: random starts, steps, ends, stops, resumes, shows, seeks, deletions and kills of
the server on a stage with a clock of its own, against a model of what a person expects to see.

Promised: 10,000 sequences. Here 15; in full by `make soak`. The page's words are compared with the
API in `test_37_page.py`.
"""

import json
import random
from collections.abc import Sequence
from dataclasses import dataclass, field
from typing import Any

import pytest

from app.events.bus import Channel, EventBus
from app.stage.stage import ANNOUNCE_AFTER_S, NEXT_AFTER_S, Stage
from app.storage.recordings import Recordings
from app.storage.run import NOT_ENDED, RESUMABLE, STATES, State
from hexapods.domain.records import to_json
from hexapods.runs.lane import LaneConfig
from hexapods.runs.race_config import RaceConfig
from hexapods.runs.recording import LaneRecording
from hexapods.shows.scene_view import scene_view
from tests.promises.length import at_length
from tests.stage.stage_parts import GAIT, StageParts
from tests.storage.stores import temporary_store

pytestmark = pytest.mark.test

SEQUENCES = at_length(15, 10_000)
EVENTS = 25
STEPS = 6
AGENTS = ("greedy", "random-walk")
FRAME_S = 0.25
"""Playback goes on by so much at most in a frame."""
EARLY_ENDS: tuple[State, ...] = tuple(sorted({*STATES} - NOT_ENDED - {"finished"}))
WEIGHTS = {
    "start": 4,
    "compute": 6,
    "finish": 4,
    "end_early": 3,
    "resume": 2,
    "show": 3,
    "seek": 2,
    "watch": 5,
    "wait": 2,
    "stay": 1,
    "keep_watching": 1,
    "delete": 2,
    "kill": 1,
}


@dataclass
class Expected:
    """Expected state: the runs, the one on stage, and whether a person chose it."""

    states: dict[str, State] = field(default_factory=dict)
    """By run, in the order of their starts."""
    steps: dict[str, int] = field(default_factory=dict)
    """By run, the steps that each of its lanes has recorded."""
    stored: dict[str, int] = field(default_factory=dict)
    """By run, the steps that are stored: of an earlier attempt, until a later one stores some."""
    activity: dict[str, int] = field(default_factory=dict)
    """By run, the number of its end among all events, or of its start."""
    on_stage: str | None = None
    is_chosen: bool = False

    @property
    def state(self) -> State | None:
        return None if self.on_stage is None else self.states[self.on_stage]

    @property
    def restored(self) -> str | None:
        """The run that a new server shows: of those last at work, or interrupted with it."""
        order = {run_id: number for number, run_id in enumerate(self.states)}
        runs = sorted(
            order, key=lambda run_id: (self.activity[run_id], order[run_id]), reverse=True
        )
        interrupted = [run_id for run_id in runs if self.states[run_id] == "interrupted"]
        last = interrupted if runs[:1] == interrupted[:1] else []
        recorded = [run_id for run_id in last or runs if self.steps[run_id]]
        return next(iter([*recorded, *last]), None)

    def put(self, run_id: str | None, *, is_chosen: bool) -> None:
        self.on_stage, self.is_chosen = run_id, is_chosen


class Audience:
    """Drives a stage by random events, and compares it with what is expected after each."""

    def __init__(self, parts: StageParts, lanes: Sequence[LaneRecording], seed: int) -> None:
        self._parts, self._lanes, self._chance = parts, lanes, random.Random(seed)
        self._expected, self._events = Expected(), 0
        self._begin()

    def drive(self) -> None:
        for _ in range(EVENTS):
            (name,) = self._chance.choices(list(WEIGHTS), list(WEIGHTS.values()))
            self._events += 1
            getattr(self, name)()
            self._watch(FRAME_S)
            self._check()
        for run_id in list(self._expected.states):
            if self._expected.states[run_id] == "running":
                self._end(run_id, "stopped")
            self._parts.delete(self._parts.store.get(run_id))

    def start(self) -> None:
        parts, expected = self._parts, self._expected
        lanes = tuple(LaneConfig(agent=agent) for agent in AGENTS)
        config = RaceConfig(gait=GAIT, simulator="kinematic", lanes=lanes, steps=STEPS)
        run = parts.create(config, state="running")
        self._begin_recording(run.id)
        is_free = expected.state not in NOT_ENDED
        assert parts.stage.offer(run.id) == is_free
        if is_free:
            expected.put(run.id, is_chosen=False)

    def compute(self) -> None:
        if run_id := self._any("running"):
            left = STEPS - self._expected.steps[run_id]
            self._compute(run_id, self._chance.randint(0, left))

    def finish(self) -> None:
        if run_id := self._any("running"):
            self._compute(run_id, STEPS - self._expected.steps[run_id])
            self._end(run_id, "finished")

    def end_early(self) -> None:
        run_id = self._any("running")
        if run_id and self._expected.steps[run_id] < STEPS:
            self._end(run_id, self._chance.choice(EARLY_ENDS))

    def resume(self) -> None:
        parts, expected = self._parts, self._expected
        if run_id := self._any(*sorted(RESUMABLE)):
            parts.set_state(parts.store.get(run_id), "queued")
            expected.states[run_id] = "queued"
            if expected.state not in NOT_ENDED or run_id == expected.on_stage:
                expected.put(run_id, is_chosen=False)
            parts.stage.offer(run_id)
            self._watch(FRAME_S)
            self._check()
            self._begin_recording(run_id)
            parts.set_state(parts.store.get(run_id), "running")

    def show(self) -> None:
        if run_id := self._any():
            self._parts.stage.set(run_id=run_id)
            self._expected.put(run_id, is_chosen=True)

    def seek(self) -> None:
        self._parts.stage.set(time_s=self._chance.uniform(0, 12))

    def watch(self) -> None:
        self._watch(6.0)

    def wait(self) -> None:
        self._watch(ANNOUNCE_AFTER_S + NEXT_AFTER_S + 1)

    def stay(self) -> None:
        self._parts.stage.set(stay=True)
        self._expected.is_chosen = True

    def keep_watching(self) -> None:
        self._parts.stage.set(end_at_time_out=False)

    def delete(self) -> None:
        if run_id := self._any("finished", *EARLY_ENDS):
            self._parts.delete(self._parts.store.get(run_id))
            del self._expected.states[run_id], self._expected.steps[run_id]
            if run_id == self._expected.on_stage:
                self._expected.put(None, is_chosen=False)

    def kill(self) -> None:
        """End the server without its having time to do anything, and start another."""
        expected = self._expected
        for run_id, state in expected.states.items():
            if state in NOT_ENDED:
                self._parts.recordings.save(run_id)
                expected.steps[run_id] = expected.steps[run_id] or expected.stored.get(run_id, 0)
                expected.stored[run_id] = expected.steps[run_id]
                expected.states[run_id] = "interrupted"
                expected.activity[run_id] = self._events
        self._parts.store.interrupt_all()
        self._begin()
        expected.put(expected.restored, is_chosen=False)

    def _begin(self) -> None:
        parts = self._parts
        parts.recordings, parts.bus = Recordings(parts.store), EventBus()
        self._stage_events = parts.bus.subscribe(names=frozenset({"stage"}))
        parts.stage = Stage(
            parts.store, parts.recordings, Channel(parts.bus), now=lambda: parts.now
        )
        parts.stage.restore()
        self._newest: dict[str, Any] = to_json(parts.stage.state())

    def _any(self, *states: State) -> str | None:
        states_by_run = self._expected.states.items()
        runs = [run_id for run_id, state in states_by_run if not states or state in states]
        return self._chance.choice(runs) if runs else None

    def _begin_recording(self, run_id: str) -> None:
        empty = [LaneRecording(lane.agent, lane.rest_qpos) for lane in self._lanes]
        self._parts.recordings.begin_race(run_id, empty)
        self._expected.states[run_id], self._expected.steps[run_id] = "running", 0
        self._expected.activity.setdefault(run_id, self._events)

    def _compute(self, run_id: str, steps: int) -> None:
        done = self._expected.steps[run_id]
        for step in range(done, done + steps):
            for lane in self._lanes:
                self._parts.recordings.add(run_id, lane.steps[step])
        self._expected.steps[run_id] += steps

    def _end(self, run_id: str, state: State) -> None:
        self._parts.recordings.finish(run_id)
        self._parts.set_state(self._parts.store.get(run_id), state)
        self._expected.states[run_id] = state
        self._expected.stored[run_id] = self._expected.steps[run_id]
        self._expected.activity[run_id] = self._events

    def _watch(self, seconds: float) -> None:
        """Draw frames; the run changes by itself only if that was announced."""
        parts, expected = self._parts, self._expected
        for _ in range(round(seconds / FRAME_S)):
            announced = parts.stage.state().announced
            parts.now += FRAME_S
            frame = parts.stage.frame()
            if announced is not None:
                assert not expected.is_chosen
                assert expected.state in ("finished", None)
            if frame.replay and announced is not None and frame.run_id == announced.run_id:
                expected.put(frame.run_id, is_chosen=False)
            assert frame.run_id == expected.on_stage

    def _check(self) -> None:
        """Compare what the stage says with what is expected."""
        expected = self._expected
        stage, frame = self._parts.stage.state(), self._parts.stage.frame()
        events = self._stage_events.drain()
        self._newest = json.loads(events[-1].data) if events else self._newest
        for name, value in to_json(stage).items():
            is_published = name not in ("time_s", "announced", "sent_s", "playhead")
            assert not is_published or value == self._newest[name], "what pages were told last"
        # The feed of the picture tells of a new playhead, with the next piece or by an event.
        playhead = self._parts.stage.picture().playhead
        rate = max(1.0, playhead.rate_at(self._parts.now))
        assert playhead.time_at(self._parts.now) == pytest.approx(frame.time_s, abs=0.15 * rate)
        assert stage.run_id == frame.run_id == expected.on_stage
        assert stage.live == (expected.state in NOT_ENDED)
        assert (stage.origin == "chosen") == expected.is_chosen
        assert stage.ended == frame.ended
        if expected.on_stage is None:
            assert (stage.phase, frame.label) == ("empty", "On the start line")
            return
        done, is_live = expected.steps[expected.on_stage], expected.state in NOT_ENDED
        moves, at_end = ("live", "decided") if is_live else ("showing", "ended")
        assert stage.phase == (at_end if stage.ended else moves)
        lanes = scene_view(frame).lanes
        assert all(lane.step <= min(done + is_live, STEPS) for lane in lanes)
        # Lanes compute one after the other, so a time-out is known once both have all their steps.
        assert (frame.time_out_s is None) == (done < STEPS)
        assert not any(lane.done for lane in lanes) or done == STEPS
        is_over = stage.ended and expected.state in EARLY_ENDS
        assert any(lane.halted for lane in lanes) <= (expected.state in EARLY_ENDS)
        if is_over and 0 < done < STEPS:
            assert all(lane.halted for lane in lanes)
            assert frame.label.endswith(f", {expected.state} at step {done} of {STEPS}")


@pytest.mark.timeout(at_length(300, 7200))
def test_stage_says_what_is_so_after_any_sequence() -> None:
    with temporary_store() as store:
        parts = StageParts(store)
        race = parts.finished_race(AGENTS, STEPS)
        lanes = parts.recordings.race(race.id) or []
        parts.delete(race)
        for seed in range(SEQUENCES):
            Audience(parts, lanes, seed).drive()
