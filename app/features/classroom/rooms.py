"""What happens in rooms: a teacher directs them; participants join, answer and start."""

from collections.abc import Callable, Iterable, Mapping
from typing import Any

from app.api.answers import ComparisonView
from app.features.classroom.class_race import ClassRace, class_race_of
from app.features.classroom.questions import check_answer
from app.features.classroom.room import CardAction, Room
from app.features.classroom.room_registry import RoomRegistry
from app.features.classroom.room_rows import ParticipantRow, PredictionRow, Seat
from app.features.classroom.seats import (
    Joined,
    free_seat,
    key_of,
    new_key,
    new_participant,
)
from app.jobs.submissions import Start
from app.storage.errors import Conflict, Forbidden, NotFound
from app.storage.run import Run


class Rooms(RoomRegistry):
    """The rooms of a server, and what happens in them. Thread-safe."""

    # ---- of the teacher

    def show_card(self, code: str, number: int) -> Room:
        """Show a card.

        Raises:
            NotFound: if there is no such room, or no such card.
            Conflict: if the room has ended.
        """
        with self._lock:
            room = self.get(code)
            # What the stage shows is of the card before.
            changes = {} if number == room.card else {"spotlight": None}
            return self._change(code, lambda room: room.check_card(number), card=number, **changes)

    def freeze(self, code: str, is_frozen: bool) -> Room:
        """Forbid answers and starts in a room, or permit them again; errors as `show_card`."""
        return self._change(code, is_frozen=is_frozen)

    def reveal(self, code: str, number: int, *, spotlight: str | None = None) -> Room:
        """Reveal the answers and runs of a card to all participants; errors as `show_card`.

        Args:
            code: code of the room.
            number: number of the card.
            spotlight: id of the class's race, which is in the light from this moment on; None to
                leave the light as it is.
        """
        with self._lock:
            room = self.get(code)
            room.check_card(number)
            room.check_open()
            numbers = room.revealed_with(number)
            approved = {
                seed for seed, participant in room.participants.items() if participant.is_approved
            }
            runs = [r for r in room.runs.values() if r.card == number and r.seed in approved]
            lit = room.spotlight if spotlight is None else spotlight
            self._rows.change_room(
                room.code,
                {"revealed": sorted(room.revealed | numbers), "spotlight": lit},
                [run.run_id for run in runs],
            )
            room.revealed |= numbers
            room.spotlight = lit
            self._runs.note_shown(room, runs)
        self._changed(room)
        return room

    def spotlight(self, code: str, run_id: str | None) -> Room:
        """Store which run is on the room's stage; all participants may see it from then on.

        Raises:
            NotFound: if it is no run of the room, or was deleted.
            Conflict: if the room has ended, or the participant is not approved yet.
        """
        with self._lock:
            room = self.get(code)
            room.check_open()
            runs = []
            if run_id is not None:
                if run_id not in room.runs or room.runs[run_id].answer is not None:
                    raise NotFound(f"the room {room.code} has no run {run_id!r}")
                runs = [room.runs[run_id]]
                self._store.find(run_id)  # it may have been deleted
                participant = room.participants.get(runs[0].seed)
                if participant is not None and not participant.is_approved:
                    raise Conflict(f"{participant.name} is not approved yet; approve first", "open")
            self._rows.change_room(room.code, {"spotlight": run_id}, [run.run_id for run in runs])
            room.spotlight = run_id
            self._runs.note_shown(room, runs)
        self._changed(room)
        return room

    def start_of_class(
        self,
        code: str,
        card: int,
        given: Mapping[str, Any],
        start: Start,
        queue: Callable[[Start], Run],
    ) -> Run:
        """Start a run of the whole class on the card that is shown, which all may see.

        Args:
            code: code of the room.
            card: number of the card that is meant.
            given: what the run is, by name.
            start: the start.
            queue: queues it.

        Raises:
            NotFound: if there is no such room.
            Forbidden: if another card is shown.
            Conflict: if it has ended.
        """
        with self._lock:
            room = self.get(code)
            _check_shown(room, card)
            room.check_open()
            run = self._runs.start_of_class(room, given, start, queue)
        self._changed(room)
        return run

    def race_together(
        self, code: str, card: int, race: ClassRace, *, run: Run, store_run: Callable[[], object]
    ) -> bool:
        """Store the race of the best, the median and the last robot of the card that is shown.

        Args:
            code: code of the room.
            card: number of the card.
            race: the race.
            run: the race as a run.
            store_run: stores the run.

        Returns:
            whether it was stored; not if the card has one, or another card is shown.

        Raises:
            NotFound: if there is no such room.
            Conflict: if it has ended.
            StorageFull, StorageFailed: if it cannot be stored.
        """
        with self._lock:
            room = self.get(code)
            if class_race_of(room, card) is not None or room.card != card:
                return False
            self._runs.keep_class_race(room, race, run=run, store_run=store_run)
        return True

    def note_watched(self, code: str, seed: int, run_id: str) -> None:
        """Note that a participant has seen a run of theirs to its end.

        Raises:
            NotFound: if there is no such room, or the participant has no such run.
        """
        room = self.get(code)
        run = room.runs.get(run_id)
        if run is None or run.seed != seed:
            raise NotFound(f"the participant has no run {run_id[:20]!r} in the room {room.code}")
        if run_id not in room.watched:
            room.watched.add(run_id)
            self.on_changed(room)

    def change_participant(
        self, code: str, seed: int, *, is_name_hidden: bool | None, is_approved: bool | None
    ) -> Room:
        """Hide or show the name of a participant, and approve; None leaves it as it is.

        Raises:
            NotFound: if there is no such room or participant.
            Conflict: if the room has ended.
        """
        flags: dict[str, Any] = {"is_name_hidden": is_name_hidden, "is_approved": is_approved}
        changes = {name: value for name, value in flags.items() if value is not None}
        with self._lock:
            room = self.get(code)
            room.check_open()
            participant = room.participant(seed)._replace(**changes)
            participant_runs = [run for run in room.runs.values() if run.seed == seed]
            runs = [r for r in participant_runs if is_approved and r.card in room.revealed]
            self._rows.change_participant(room.code, seed, changes, [run.run_id for run in runs])
            room.participants[seed] = participant
            self._runs.note_shown(room, runs)
        self._changed(room)
        return room

    def remove_participant(self, code: str, seed: int) -> list[str]:
        """Remove a participant: the seat, the name and all answers; runs stay, and stay hidden.

        Returns:
            the ids of the runs that go on, which are to be stopped: races before their trainings.

        Raises:
            NotFound: if there is no such room or participant.
            Conflict: if the room has ended.
        """
        with self._lock:
            room = self.get(code)
            room.check_open()
            room.participant(seed)
            lit = room.runs.get(room.spotlight or "")
            if lit is not None and lit.seed == seed:
                self._rows.change_room(room.code, {"spotlight": None})
                room.spotlight = None
            going_on = self._remove(room, seed)
        self._changed(room)
        return going_on

    def _remove(self, room: Room, seed: int) -> list[str]:
        self._rows.delete_participant(room.code, seed)
        self._seats.remove(room, seed)
        self.on_seat_taken((room.code, seed))
        return self._runs.remove(room, seed)

    def _change(
        self, code: str, check: Callable[[Room], object] = Room.check_open, **changes: Any
    ) -> Room:
        with self._lock:
            room = self.get(code)
            room.check_open()
            check(room)
            self._rows.change_room(room.code, changes)
            for name, value in changes.items():
                setattr(room, name, value)
        self._changed(room)
        return room

    # ---- of participants

    def join(self, code: str, key: str = "", request_key: str | None = None) -> Joined:
        """Add a participant to a room; one who was in it before keeps name and seed by the key.

        Args:
            code: code of the room.
            key: key of a participant who was in it before; "" for none.
            request_key: idempotency key of the request, a secret: with it the same request, of
                which the answer was lost, finds the participant of the first again.

        Raises:
            NotFound: if there is no such room.
            Conflict: if it has ended.
            Busy: if it is full.
        """
        with self._lock:
            room = self.get(code)
            room.check_open()
            seated = self._seated(room, key, request_key)
            if seated is not None:
                return seated
            requested = None if request_key is None else key_of(room.code, request_key)
            if requested is None or self._seats.has(requested):
                requested = new_key()
            unused = free_seat(room, lambda seed: self._is_in_use(room, seed))
            if unused is not None:
                self._remove(room, unused)
            joined = new_participant(room, self._choose, self._now(), requested)
            self._rows.add_participant(joined.participant)
            self._seats.add(room, joined.participant)
        self._changed(room)
        return joined

    def _is_in_use(self, room: Room, seed: int) -> bool:
        return self._has_acted(room, seed) or self.is_here((room.code, seed))

    def _has_acted(self, room: Room, seed: int) -> bool:
        return room.has_acted(seed) or self.has_entered((room.code, seed))

    def _seated(self, room: Room, key: str, request_key: str | None) -> Joined | None:
        requested = "" if request_key is None else key_of(room.code, request_key)
        for seat_key in (key, requested):
            seat = self._seats.of(room, seat_key)
            if seat is not None:
                return Joined(seat, seat_key, is_new=False)
        return None

    def leave(self, code: str, seed: int) -> None:
        """Remove a participant from a room; their answers and runs stay.

        Raises:
            NotFound: if there is no such room.
            Forbidden: if the participant was removed, or has left.
        """
        with self._lock:
            room, now = self.get(code), self._now()
            room.check_seated(seed)
            if self._has_acted(room, seed):
                self._rows.change_participant(room.code, seed, {"left_at": now})
                room.participants[seed] = room.participants[seed]._replace(left_at=now)
                self.on_seat_taken((room.code, seed))
            else:
                self._remove(room, seed)
        self._changed(room)

    def seat(self, code: str, key: str) -> ParticipantRow | None:
        """Return the participant of a room by the key of the cookie; None if none has it."""
        room = self._rooms.get(code)
        return None if room is None else self._seats.of(room, key)

    def predict(self, code: str, seed: int, card: int, value: Any) -> Any:
        """Store a participant's answer to the question of the card that is shown.

        Raises:
            NotFound: if there is no such card.
            Forbidden: if the card is not shown, or asks nothing, or the participant was removed.
            Conflict: if it was answered or revealed before, or the room has ended or is frozen.
            InvalidInput: if the value is no answer to the question.
        """
        with self._lock:
            room = self.get(code)
            room.check_seated(seed)
            _check_shown(room, card)
            _check_allowed(room, "predict")
            room.check_going_on()
            ask = room.deck[card].ask
            answer = None if ask is None else check_answer(ask, value)
            if (seed, card) in room.predictions:
                raise Conflict(
                    f"you have answered card {card} already; an answer stays", "answered"
                )
            if card in room.revealed:
                raise Conflict(f"card {card} is revealed; it takes no more answers", "revealed")
            self._rows.add_prediction(PredictionRow(room.code, seed, card, answer, self._now()))
            room.predictions[seed, card] = answer
        self._changed(room)
        return answer

    def check_run(self, code: str, card: int | None = None) -> Room:
        """Return the room, if the card that is shown lets its participants start a run.

        Args:
            code: code of the room.
            card: number of the card that is meant; None for the one that is shown.

        Raises:
            NotFound: if there is no such card.
            Forbidden: if another card is shown, or it runs nothing.
            Conflict: if the room has ended or is frozen.
        """
        room = self.get(code)
        _check_shown(room, card)
        _check_allowed(room, "run")
        room.check_going_on()
        return room

    def start(
        self,
        code: str,
        seed: int,
        given: Mapping[str, Any],
        make: Callable[[Room], Start],
        queue: Callable[[Start], Run],
        *,
        card: int | None = None,
    ) -> Run:
        """Start the run of the card that is shown; return a participant's equal run again.

        Args:
            code: code of the room.
            seed: seed of the participant.
            given: settings that the participant gave, by name, as they were checked.
            make: makes the start.
            queue: queues it.
            card: number of the card that is meant; None for the one that is shown.

        Raises:
            NotFound, Forbidden, Conflict: as `check_run`; also if the participant was removed, or a
                run of theirs has not ended.
            Busy: if there were too many.
        """
        with self._lock:
            room = self.check_run(code, card)
            room.check_seated(seed)
            run = self._runs.start(room, seed, given, make, queue)
        self._changed(room)
        return run

    def ask(
        self,
        code: str,
        seed: int,
        given: Mapping[str, Any],
        compute: Callable[[], ComparisonView],
        *,
        card: int,
    ) -> ComparisonView:
        """Compute and store the answer of the what-if of the card that is shown; see `start`.

        Args:
            code: code of the room.
            seed: seed of the participant.
            given: settings that the participant gave, by name, as they were checked.
            compute: computes the answer, which may take seconds; it is called without a lock.
            card: number of the card.

        Raises:
            NotFound, Forbidden, Conflict: as `check_run`.
            Busy: if there were too many.
        """
        with self._lock:
            stored_answer = self._runs.answer_of(self.check_run(code, card), seed, card, given)
        if stored_answer is not None:
            return stored_answer
        answer = compute()
        with self._lock:
            # It was asked while the card was shown, so it is kept whatever is shown now.
            room = self.get(code)
            room.check_seated(seed)
            stored_answer = self._runs.answer_of(room, seed, card, given)
            if stored_answer is not None:
                return stored_answer
            self._runs.keep_answer(room, seed, card, given, answer=answer, now=self._now())
        self._changed(room)
        return answer

    # ---- visibility of runs

    def owner_of(self, run_id: str) -> str | None:
        """Return code and seed of the participant who started a run, as text; None without one."""
        return self._runs.owner_of(run_id)

    def is_hidden(self, run_id: str | None, reader: Iterable[Seat]) -> bool:
        """Whether a run is hidden from a reader who is no operator.

        Args:
            run_id: id of the run; None for none.
            reader: the participants that the reader is.
        """
        return self._runs.is_hidden(run_id, reader)

    def unfinished(self) -> list[str]:
        """Return the ids of interrupted runs of open rooms, without trainings that races need."""
        with self._lock:
            return [run_id for room in self.open_rooms() for run_id in self._runs.interrupted(room)]


def _check_shown(room: Room, card: int | None) -> None:
    if card is not None:
        room.check_card(card)
        if card != room.card:
            raise Forbidden(f"card {card} is not shown; the class is at card {room.card}")


def _check_allowed(room: Room, action: CardAction) -> None:
    if (refusal := room.refusal(action)) is not None:
        raise Forbidden(refusal)
