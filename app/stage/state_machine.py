"""State machine of the stage: the run shown, why, the progress of its picture, and the playlist.

It is pure: it knows no clock, no recording and no store. `Stage` reports events to it and shows
what it says; what the page says of the stage follows from it (`static/js/narrative/narrative.js`).

    phase     the run on stage     its picture
    empty     none                 robots on the start line
    live      is computed          on its way, behind the computation
    decided   is computed          at its end: a race's photo finish
    showing   has ended            on its way
    ended     has ended            at its end
"""

from collections.abc import Mapping
from dataclasses import dataclass, replace
from typing import Literal, NamedTuple, get_args

from app.storage.run import NOT_ENDED, State

Phase = Literal["empty", "live", "decided", "showing", "ended"]
Origin = Literal["none", "started", "chosen", "automatic", "restored"]
"""Why a run is on stage: it was started, a person chose it, the server replays it by itself, or it
was there when the server started."""
Event = Literal["computed", "continued", "reached-end", "left-end"]

PHASES: tuple[Phase, ...] = get_args(Phase)
TRANSITIONS: Mapping[Phase, Mapping[Event, Phase]] = {
    "empty": {},
    "live": {"computed": "showing", "reached-end": "decided"},
    "decided": {"computed": "ended", "left-end": "live"},
    "showing": {"continued": "live", "reached-end": "ended"},
    "ended": {"continued": "decided", "left-end": "showing"},
}
"""Phase → event → next phase; an event without an entry changes nothing.

`computed`: the run records no more. `continued`: it was resumed. `reached-end`, `left-end`: so did
its picture. Another run is put on stage by `StageState.show`, and taken from it by `remove`.
"""


class StagedRun(NamedTuple):
    """A run of the playlist, with its present state, and whether it has begun to be computed."""

    id: str
    state: State
    has_begun: bool = True

    @property
    def is_computed(self) -> bool:
        """Whether the run is queued, running or paused."""
        return self.state in NOT_ENDED

    @property
    def is_void(self) -> bool:
        """Whether the run ended before it began, as a race with the training that it waited for."""
        return not self.has_begun and not self.is_computed and self.state != "finished"


@dataclass(frozen=True)
class StageState:
    """Content of the stage; immutable.

    Attributes:
        phase: see the table of this module.
        origin: why the run is on stage.
        playlist: the run on stage, and those to be shown after it: a race after its trainings. One
            that ended before it began is not shown after another.
        announced: id of the run that the server will show next unless a person objects.
    """

    phase: Phase = "empty"
    origin: Origin = "none"
    playlist: tuple[StagedRun, ...] = ()
    announced: str | None = None

    @property
    def run(self) -> StagedRun | None:
        """The run on stage."""
        return self.playlist[0] if self.playlist else None

    @property
    def is_held(self) -> bool:
        """Whether a started run does not take the stage: one on the playlist is computed."""
        return any(run.is_computed for run in self.playlist)

    @property
    def may_announce(self) -> bool:
        """Whether the server may show another run by itself.

        Not after a run that a person chose or stopped, or that can be resumed.
        """
        if self.origin == "chosen":
            return False
        if self.run is None:
            return True
        is_last = len(self.playlist) == 1
        return self.phase == "ended" and self.run.state == "finished" and is_last

    def show(self, playlist: tuple[StagedRun, ...], origin: Origin) -> "StageState":
        """Return the state with a playlist on stage; one that begins with the same run goes on."""
        run, playlist = playlist[0], _to_be_shown(playlist)
        if self.run is not None and self.run.id == run.id:
            changed = self.change(run)
            return replace(changed, origin=origin, playlist=playlist, announced=None)
        return StageState("live" if run.is_computed else "showing", origin, playlist)

    def apply(self, event: Event) -> "StageState":
        """Return the state after an event; the same if it changes nothing."""
        phase = TRANSITIONS[self.phase].get(event)
        return self if phase is None else replace(self, phase=phase, announced=None)

    def change(self, run: StagedRun) -> "StageState":
        """Return the state after a run of the playlist has changed its own."""
        changed = _to_be_shown(
            tuple(run if run.id == staged.id else staged for staged in self.playlist)
        )
        if changed == self.playlist:
            return self
        state = replace(self, playlist=changed)
        if changed[0] != run:
            return state
        return state.apply("continued" if run.is_computed else "computed")

    def remove(self, run_id: str) -> "StageState":
        """Return the state after a run was deleted: it leaves the stage, and the announcement."""
        left = tuple(run for run in self.playlist if run.id != run_id)
        announced = None if self.announced == run_id else self.announced
        if self.run is None or self.run.id != run_id:
            return replace(self, playlist=left, announced=announced)
        return self.advance() if left else StageState()

    def advance(self) -> "StageState":
        """Return the state with the next run of the playlist on stage."""
        left = self.playlist[1:]
        return StageState("live" if left[0].is_computed else "showing", self.origin, left)

    def announce(self, run_id: str) -> "StageState":
        """Return the state with a run announced; the same unless `may_announce`."""
        return replace(self, announced=run_id) if self.may_announce else self

    def stay(self) -> "StageState":
        """Return the state with the run kept on stage, as if a person had chosen it."""
        return replace(self, origin="chosen", announced=None)


def _to_be_shown(playlist: tuple[StagedRun, ...]) -> tuple[StagedRun, ...]:
    """Return a playlist without runs after the first that ended before they began."""
    return playlist[:1] + tuple(run for run in playlist[1:] if not run.is_void)
