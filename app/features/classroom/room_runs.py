"""The runs of participants: their owners, their visibility, and their start."""

from collections.abc import Callable, Collection, Iterable, Mapping, Sequence
from contextlib import suppress
from datetime import datetime
from typing import Any

from app.api.answers import ComparisonView
from app.features.classroom.class_race import ClassRace
from app.features.classroom.room import Room, given_key
from app.features.classroom.room_rows import CLASS_SEED, RoomRows, RoomRun, Seat
from app.features.classroom.seats import reserve_seed
from app.jobs.linked_start import LinkedStart
from app.jobs.submissions import Start
from app.storage.database.store import RunStore
from app.storage.errors import Busy, Conflict, NotFound
from app.storage.json_text import is_finite
from app.storage.run import NOT_ENDED, Run
from hexapods.domain.errors import HexapodError
from hexapods.domain.records import from_json

MAX_RUNS = 20
"""Runs of a participant on a card."""
_RETRY_S = 60
_FAILED = ("failed", "stopped")


class RoomRuns:
    """Runs of all participants by id. Reads from any thread; `Rooms` holds its lock for changes."""

    def __init__(self, store: RunStore) -> None:
        """Create an empty table of runs, which `load` fills.

        Args:
            store: store of the runs.
        """
        self._store, self._rows = store, RoomRows(store.database)
        self._runs: dict[str, RoomRun] = {}
        self._unread: set[str] = set()
        """Ids of runs whose rows are damaged; they are hidden from all but operators."""

    def load(self, rooms: Mapping[str, Room]) -> None:
        """Load the runs of the participants of rooms, by code; those of other rooms stay hidden."""
        for run in self._rows.runs(lambda run: _sound(run, rooms)):
            self._runs[run.run_id] = run
            if run.room not in rooms:
                continue
            room = rooms[run.room]
            # Those of who was removed stay, and stay hidden: no newcomer has their seed.
            reserve_seed(room, run.seed)
            room.used_at = max(room.used_at, run.created_at)
            if run.seed in room.participants or run.seed == CLASS_SEED:
                room.runs[run.run_id] = run
        self._unread = self._rows.run_ids() - self._runs.keys()

    def forget(self, room: Room) -> None:
        """Remove the links of a room's runs to participants: all may see these runs then."""
        self._runs = {k: run for k, run in self._runs.items() if run.room != room.code}

    def ids_of(self, room: Room) -> list[str]:
        """Return the ids of all runs of a room, also of removed participants, oldest first."""
        runs = [run for run in list(self._runs.values()) if run.room == room.code]
        return [run.run_id for run in runs if run.answer is None]

    def remove(self, room: Room, seed: int) -> list[str]:
        """Remove the runs of a participant from the room; return the ids of those that go on.

        They stay hidden from all but operators, but for those that were shown before. Races are
        before their trainings.
        """
        runs = [run for run in room.runs.values() if run.seed == seed]
        for run in runs:
            del room.runs[run.run_id]
        stored = [self._find(run) for run in reversed(runs)]
        return [run.id for run in stored if run is not None and run.state in NOT_ENDED]

    def owner_of(self, run_id: str) -> str | None:
        """Return code and seed of the participant who started a run, as text; None without one."""
        run = self._runs.get(run_id)
        return None if run is None else f"{run.room} {run.seed}"

    def is_hidden(self, run_id: str | None, reader: Iterable[Seat]) -> bool:
        """Whether a run is hidden from a reader who is no operator.

        Args:
            run_id: id of the run; None for none.
            reader: the participants that the reader is.
        """
        if run_id in self._unread:
            return True
        run = self._runs.get(run_id or "")
        return run is not None and not run.is_shown and (run.room, run.seed) not in reader

    def note_shown(self, room: Room, runs: Iterable[RoomRun]) -> None:
        """Mark runs of a room as shown to others; the database has them so already."""
        for run in runs:
            self._runs[run.run_id] = room.runs[run.run_id] = run._replace(is_shown=True)

    def interrupted(self, room: Room) -> list[str]:
        """Return the ids of interrupted runs of a room, without trainings that its races need."""
        mains = [run for run in room.runs.values() if run.is_main or run.seed == CLASS_SEED]
        stored = [(main.run_id, self._find(main)) for main in mains]
        return [run_id for run_id, run in stored if run is not None and run.state == "interrupted"]

    def start(
        self,
        room: Room,
        seed: int,
        given: Mapping[str, Any],
        make: Callable[[Room], Start],
        queue: Callable[[Start], Run],
    ) -> Run:
        """Start a run of a participant on the card that is shown; see `Rooms.start`.

        Raises:
            Conflict: if a run of the participant has not ended.
            Busy: if there were too many.
        """
        for alike in _alike(room, seed, room.card, given):
            run = self._find(alike)
            if run is not None and run.state not in _FAILED:
                return run
        self._check_none_goes_on(room, seed)
        _check_few(room, seed, room.card)
        start = LinkedStart(make(room), lambda runs: self._link(room, seed, given, runs))
        try:
            return queue(start)
        except BaseException:
            self._unlink(room, start.links)
            raise

    def start_of_class(
        self, room: Room, given: Mapping[str, Any], start: Start, queue: Callable[[Start], Run]
    ) -> Run:
        """Start a run of the whole class on the card that is shown; see `Rooms.start_of_class`."""

        def link(runs: Sequence[Run]) -> None:
            self._keep(room, [_link_of_class(run, room, given, CLASS_SEED) for run in runs])

        linked = LinkedStart(start, link)
        try:
            return queue(linked)
        except BaseException:
            self._unlink(room, linked.links)
            raise

    def keep_class_race(
        self, room: Room, race: ClassRace, *, run: Run, store_run: Callable[[], object]
    ) -> None:
        """Store the race of the best, the median and the last robot of the card that is shown."""
        self._keep(room, [_link_of_class(run, room, race.given, race.seeds[0])])
        try:
            store_run()
        except BaseException:
            self._unlink(room, [run.id])
            raise

    def answer_of(
        self, room: Room, seed: int, card: int, given: Mapping[str, Any]
    ) -> ComparisonView | None:
        """Return the stored answer of an equal what-if of a participant; None if there is none.

        Raises:
            Busy: if there is none, and the participant has started too much on the card.
        """
        for alike in _alike(room, seed, card, given):
            if alike.answer is not None:
                return alike.answer
        _check_few(room, seed, card)
        return None

    def keep_answer(
        self,
        room: Room,
        seed: int,
        card: int,
        given: Mapping[str, Any],
        *,
        answer: ComparisonView,
        now: datetime,
    ) -> None:
        """Store the answer of a participant's what-if; others see it as they would see a run."""
        number = len(room.runs_of(seed, card))
        row = RoomRun(
            run_id=f"what-if-{room.code}-{seed}-{card}-{number}",
            room=room.code,
            seed=seed,
            card=card,
            given=given,
            is_main=True,
            is_shown=room.shows(seed, card),
            created_at=now,
            answer=answer,
        )
        self._keep(room, [row])

    def _link(self, room: Room, seed: int, given: Mapping[str, Any], runs: Sequence[Run]) -> None:
        """Link runs to their participant before they are stored; a link to no run has no effect."""
        is_shown = room.shows(seed, room.card)
        links = [
            RoomRun(
                run_id=run.id,
                room=room.code,
                seed=seed,
                card=room.card,
                given=given,
                is_main=run is runs[-1],
                is_shown=is_shown,
                created_at=run.created_at,
            )
            for run in runs
        ]
        self._keep(room, links)

    def _keep(self, room: Room, links: Sequence[RoomRun]) -> None:
        self._rows.add_runs(links)
        for link in links:
            self._runs[link.run_id] = room.runs[link.run_id] = link

    def _unlink(self, room: Room, run_ids: Collection[str]) -> None:
        if run_ids:
            with suppress(HexapodError):  # a link to no run has no effect
                self._rows.remove_runs(run_ids)
        for run_id in run_ids:
            self._runs.pop(run_id, None)
            room.runs.pop(run_id, None)

    def _check_none_goes_on(self, room: Room, seed: int) -> None:
        for room_run in room.runs.values():
            run = self._find(room_run) if room_run.is_main and room_run.seed == seed else None
            if run is not None and run.state in NOT_ENDED:
                raise Conflict(f"your {run.kind} is {run.state}; wait for its end", run.state)

    def _find(self, room_run: RoomRun) -> Run | None:
        if room_run.answer is not None:
            return None
        try:
            run = self._store.find(room_run.run_id)
        except NotFound:
            return None
        return run if isinstance(run, Run) else None


def _link_of_class(run: Run, room: Room, given: Mapping[str, Any], seed: int) -> RoomRun:
    """Return the link of a run of the whole class on the card that is shown, which all may see."""
    return RoomRun(
        run_id=run.id,
        room=room.code,
        seed=seed,
        card=room.card,
        given=given,
        is_main=False,
        is_shown=True,
        created_at=run.created_at,
    )


def _sound(run: RoomRun, rooms: Mapping[str, Room]) -> RoomRun:
    """Check a stored run, or what-if, and return it decoded.

    Raises:
        ValueError, NotFound: if the row is damaged.
    """
    given: Any = run.given
    if not isinstance(given, Mapping) or not is_finite(given):
        raise ValueError("given: it is no object of settings")
    answer: Any = run.answer
    if answer is not None:
        if not is_finite(answer):
            raise ValueError("answer: it has a number that is not finite")
        run = run._replace(answer=from_json(ComparisonView, answer))
    if run.room in rooms:
        rooms[run.room].check_card(run.card)
    return run


def _alike(room: Room, seed: int, card: int, given: Mapping[str, Any]) -> list[RoomRun]:
    """Return the runs and what-ifs of a participant on a card with the same settings."""
    key = given_key(given)
    return [run for run in room.runs_of(seed, card) if given_key(run.given) == key]


def _check_few(room: Room, seed: int, card: int) -> None:
    if len(room.runs_of(seed, card)) >= MAX_RUNS:
        raise Busy(f"you have started {MAX_RUNS} runs on this card, the most", _RETRY_S)
