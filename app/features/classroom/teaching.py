"""Lets the class of a room teach a robot: starts it, takes presses, sends them to its training."""

import logging
import math
import threading
import time
from contextlib import suppress
from typing import Annotated, Literal, cast

from annotated_types import Ge, Le

from app.answer import Answer, Count
from app.api.deps import Services
from app.features.classroom.card_starts import CardStarts
from app.features.classroom.lesson import Card
from app.features.classroom.press_book import ClassPress, PressBook
from app.features.classroom.room import Room
from app.features.classroom.room_stages import RoomStages
from app.features.classroom.rooms import Rooms
from app.features.classroom.teach import Teach
from app.jobs.submissions import LaneStart, RaceStart, TrainingStart
from app.limits.token_bucket import RateLimiter
from app.storage.errors import Busy, Conflict, Forbidden, NotFound
from app.storage.run import NOT_ENDED, Run
from hexapods.domain.errors import HexapodError
from hexapods.domain.text import MAX_NAME, check_name
from hexapods.runs.config import RACE_STEPS, TrainingConfig
from hexapods.runs.results import RaceResult, TrainingResult

TAUGHT, RIVAL, RACE = "taught", "rival", "race"
RIVALS = {"reward": "reward", "simulated": "simulated person"}
"""What a rival is taught by, in words."""
PART = "teach"
"""Key of the settings of a room's run that is part of a teaching; its value is which one."""
_PRESSES_PER_S, _BURST = 4.0, 8
_EVERY_S = 0.2
_logger = logging.getLogger(__name__)


class StepPresses(Answer):
    """What the class pressed for a step of the robot.

    Attributes:
        step: number of the step, from 0.
        plus, minus: numbers of pupils who pressed + and −; each counts once, with the last press.
        value: mean over those who pressed, from -1 to 1.
    """

    step: Count
    plus: Count
    minus: Count
    value: Annotated[float, Ge(-1), Le(1)]


class TaughtRobot(Answer):
    """A robot of a teaching.

    Attributes:
        run_id: id of its training.
        distance_m: how far it walks in 50 steps now that it has learned [m]: in the race of both
            as soon as that is computed; null before the reveal, but for a teacher.
    """

    run_id: str
    distance_m: float | None


class TeachingView(Answer):
    """How the class of a room teaches a robot on the card that is shown.

    Attributes:
        state: `ready`: nothing was started; `teaching`: presses count; `frozen`; `ended`.
        steps: number of steps of the robot.
        step_s: duration of one in the run's own time [s].
        presses: by step, oldest first.
        taught, rival: the robot of the class, and the one that learns from the reward.
        race_id: id of the race of both; null before the reveal.
    """

    card: Count
    state: Literal["ready", "teaching", "frozen", "ended"]
    steps: Count
    step_s: float
    presses: list[StepPresses]
    taught: TaughtRobot | None
    rival: TaughtRobot | None
    race_id: str | None


class TeachingEvent(Answer):
    """The class has pressed, or its teaching has begun or ended; sent on the room's stage alone.

    Attributes:
        presses: of the steps since the last event.
    """

    card: Count
    presses: list[StepPresses]


class Teaching:
    """Teachings of all rooms. Thread-safe."""

    def __init__(self, core: Services) -> None:
        """Begin with none.

        Args:
            core: services of the server.
        """
        self._core = core
        self._lock = threading.RLock()
        self._books: dict[str, PressBook] = {}
        """By id of a training that is taught."""
        self._to_race: set[str] = set()
        """Ids of trainings that are taught, whose race begins once they have ended."""
        self._limiter = RateLimiter(_BURST, _PRESSES_PER_S)

    @property
    def _rooms(self) -> Rooms:
        return self._core.of(Rooms)

    def follow_again(self) -> None:
        """Follow the teachings of open rooms that go on after a start of the server."""
        for room in self._rooms.open_rooms():
            run = None if room.shown.teach is None else self._part(room, TAUGHT)
            if run is not None and run.state in NOT_ENDED:
                with suppress(Conflict, NotFound):  # it has ended meanwhile
                    self._book_of(room, run)

    # ---- of the teacher

    def start(self, code: str) -> Room:
        """Start both robots of the card that is shown, and show that of the class on the stage.

        Raises:
            NotFound: if there is no such room.
            Forbidden: if the card teaches nothing.
            Conflict: if the room has ended or is frozen, or the class teaches already.
            Busy: if the queue is full.
        """
        with self._lock:
            room = self._rooms.get(code)
            _check_teaches(room)
            room.check_going_on()
            run = self._part(room, TAUGHT)
            if run is not None and run.state in NOT_ENDED:
                raise Conflict("the class teaches already; end that first", run.state)
            # The rival first: it takes a second, while the other one holds a core for minutes.
            rival = self._begin(room, RIVAL)
            try:
                taught = self._begin(room, TAUGHT)
            except HexapodError:
                self._end(rival)
                raise
            self._follow(room, taught)
        return room

    def _begin(self, room: Room, part: str) -> Run:
        start = self._training(room.shown, part)
        return self._rooms.start_of_class(
            room.code, room.card, {PART: part}, start, self._core.jobs.start
        )

    def _end(self, run: Run | None) -> None:
        if run is not None and run.state in NOT_ENDED:
            with suppress(Conflict, NotFound):  # it has ended meanwhile
                self._core.jobs.stop(run.id)

    def stop(self, code: str, *, is_announced: bool = True) -> Room:
        """End the teaching of the card that is shown, if there is one; what was learned stays.

        Args:
            code: code of the room.
            is_announced: whether pages are told; not where another card is shown at once, since
                they would ask for the teaching of a card that has gone by.

        Raises:
            NotFound: if there is no such room.
        """
        room = self._rooms.get(code)
        for part in (TAUGHT, RIVAL):
            self._end(self._part(room, part))
        if is_announced and room.shown.teach is not None:
            self._publish(room, [])
        return room

    def freeze(self, room: Room) -> None:
        """Hold the robot of a room that is frozen, or let it go on."""
        # Locked, so that of a stop and a start at once the last one holds.
        with self._lock:
            run = self._part(room, TAUGHT)
            if run is None or run.state not in NOT_ENDED:
                return
            with suppress(HexapodError):  # it has ended meanwhile, or too many are paused
                if room.is_frozen:
                    self._core.jobs.pause(run.id)
                elif run.state == "paused":
                    self._core.jobs.resume(run.id)
        self._publish(room, [])

    def race(self, room: Room) -> None:
        """End the teaching of a room whose card is revealed; then both robots race on its stage.

        They race once, however often they are sent.
        """
        with self._lock:
            taught, rival = self._part(room, TAUGHT), self._part(room, RIVAL)
            if taught is None or rival is None or taught.id in self._to_race:
                return
            if self._race_of(room, taught) is not None:
                return
            self._to_race.add(taught.id)
        args = room, room.card, [taught, rival]
        threading.Thread(target=self._race, args=args, daemon=True).start()

    def _race(self, room: Room, card: int, runs: list[Run]) -> None:
        """Start the race once both robots have ended; errors are logged: all else is revealed."""
        try:
            for run in runs:
                self._end(run)
            self._publish(room, [])
            while any(self._core.store.get(run.id).state in NOT_ENDED for run in runs):
                time.sleep(_EVERY_S)
            config = _config(runs[0])
            race = RaceStart(
                walk=config.walk(),
                lanes=[LaneStart(config.agent, training_id=run.id) for run in runs],
                steps=RACE_STEPS,
                seed=0,
                name=_name(room, "the class and the reward"),
            )
            run = self._rooms.start_of_class(
                room.code, card, {PART: RACE}, race, self._core.jobs.start
            )
            self._show(room, run)
            self._publish(room, [])
        except HexapodError as error:
            _logger.info("the robots of the room %s do not race: %s", room.code, error)
        finally:
            self._to_race.discard(runs[0].id)

    # ---- of participants

    def press(self, code: str, seed: int, run_id: str, at_s: float, value: int) -> int:
        """Take a press of a participant; return the number of the step that it is about.

        Args:
            code: code of the room.
            seed: seed of the participant.
            run_id: id of the training in the participant's picture.
            at_s: time of the run in the picture when it was pressed [s].
            value: 1 or −1.

        Raises:
            Forbidden: if the card teaches nothing, or the participant was removed.
            Conflict: if the room is frozen, nothing is taught, another robot is, or the moment is
                not shown yet, or over.
            Busy: if the participant presses too often.
        """
        room = self._rooms.get(code)
        room.check_seated(seed)
        _check_teaches(room)
        room.check_going_on()
        wait_s = self._limiter.take(f"{room.code} {seed}")
        if wait_s > 0:
            raise Busy("you press faster than steps can be judged; slow down", math.ceil(wait_s))
        run = _being_taught(self._part(room, TAUGHT))
        if run.id != run_id:
            raise Conflict("another robot is taught now; press for the one that you see", "other")
        book = self._book_of(room, run)
        shown = self._steps_shown(room, run)
        if shown is None:
            raise Conflict("the robot is not on the stage yet; press for what you see", "early")
        return book.add(seed, at_s / _config(run).robot.step_s, value, shown)

    def _book_of(self, room: Room, run: Run) -> PressBook:
        """Return the open presses of a run, which is followed again after a start of the server.

        Raises:
            NotFound, Conflict: if the run has ended meanwhile.
        """
        with self._lock:
            if run.id not in self._books:
                self._follow(room, _being_taught(self._core.store.get(run.id)))
            return self._books[run.id]

    # ---- of all

    def view(self, code: str, *, is_teacher: bool) -> TeachingView:
        """Return the teaching of the card that is shown.

        Raises:
            NotFound: if there is no such room, or the card teaches nothing.
        """
        room = self._rooms.get(code)
        teach = room.shown.teach
        if teach is None:
            raise NotFound(f"card {room.card} teaches nothing")
        run = self._part(room, TAUGHT)
        race = None if run is None else self._race_of(room, run)
        is_distance_shown = is_teacher or room.card in room.revealed
        config = self._training(room.shown, TAUGHT).config
        return TeachingView(
            card=room.card,
            state=_state(room, run),
            steps=teach.steps,
            step_s=config.robot.step_s,
            presses=[] if run is None else _presses(room, run),
            taught=_robot(run, race, is_distance_shown=is_distance_shown),
            rival=_robot(self._part(room, RIVAL), race, is_distance_shown=is_distance_shown),
            race_id=None if race is None else race.id,
        )

    def _part(self, room: Room, part: str) -> Run | None:
        """Return the newest run of a part of the teaching of the card that is shown."""
        ids = [
            run.run_id
            for run in list(room.runs.values())
            if run.card == room.card and run.given.get(PART) == part
        ]
        if not ids:
            return None
        try:
            run = self._core.store.find(ids[-1])
        except NotFound:
            return None
        return run if isinstance(run, Run) else None

    def _race_of(self, room: Room, taught: Run) -> Run | None:
        """Return the race of a robot that was taught; None while it has not raced."""
        race = self._part(room, RACE)
        return race if race is not None and taught.id in race.lane_training_ids else None

    def _training(self, card: Card, part: str) -> TrainingStart:
        """Return the start of the training of a part."""
        rival = cast(Teach, card.teach).rival
        trainer, by = ("people", "class") if part == TAUGHT else (rival, RIVALS[rival])
        name = _titled(card.title, f"taught by the {by}")
        return self._core.of(CardStarts).teaching(card, trainer, name)

    def _follow(self, room: Room, run: Run) -> None:
        """Show a training on the stage, and send it what the class presses until it ends."""
        room.pressed[run.id] = _presses(room, run)
        book = self._books[run.id] = PressBook(run.done)
        self._show(room, run)
        self._publish(room, [])
        args, name = (room, room.card, run.id, book), f"teaching {room.code}"
        threading.Thread(target=self._send, args=args, name=name, daemon=True).start()

    def _send(self, room: Room, card: int, run_id: str, book: PressBook) -> None:
        try:
            while (run := self._core.store.get(run_id)).state in NOT_ENDED:
                time.sleep(_EVERY_S)
                shown = self._steps_shown(room, run)
                if shown is None:
                    continue
                seeds = {participant.seed for participant in room.present}
                if presses := book.close(shown, seeds):
                    self._send_presses(room, run_id, presses)
        except HexapodError as error:  # the run was deleted
            _logger.info("the teaching of the room %s has ended: %s", room.code, error)
        finally:
            with self._lock:
                self._books.pop(run_id, None)
            self._publish(room, [])
        with self._lock:
            newest = self._part(room, TAUGHT)
            is_shown = card == room.card and newest is not None and newest.id == run_id
            if is_shown and card in room.revealed:
                self.race(room)  # it was taught once more after the reveal

    def _send_presses(self, room: Room, run_id: str, presses: list[ClassPress]) -> None:
        pairs = [[press.at_step, press.value] for press in presses]
        try:
            self._core.jobs.change(run_id, {"presses": pairs})
        except HexapodError as error:  # it has ended meanwhile, or its process is busy
            _logger.info("presses of the room %s came to nothing: %s", room.code, error)
            return
        shown = [
            StepPresses(step=p.step, plus=p.plus, minus=p.minus, value=p.value) for p in presses
        ]
        room.pressed[run_id] += shown
        self._publish(room, shown)

    def _steps_shown(self, room: Room, run: Run) -> float | None:
        """Return the steps of a run that are done in the picture; None if it shows another."""
        shared = self._core.of(RoomStages).of(room.code)
        if shared is None:
            return None
        state = shared.stage.state()
        if state.run_id != run.id:
            return None
        return state.playhead.time_at(shared.stage.now()) / _config(run).robot.step_s

    def _show(self, room: Room, run: Run) -> None:
        shared = self._core.of(RoomStages).of(room.code)
        if shared is not None:
            shared.stage.set(run_id=run.id, playing=True, speed="time-lapse")

    def _publish(self, room: Room, presses: list[StepPresses]) -> None:
        shared = self._core.of(RoomStages).of(room.code)
        if shared is not None:
            event = TeachingEvent(card=room.card, presses=presses)
            shared.channel.publish("teaching", event)


def _presses(room: Room, run: Run) -> list[StepPresses]:
    """Return the presses of a run; after a start of the server their means alone."""
    if run.id in room.pressed:
        return list(room.pressed[run.id])
    recorded = [press for change in run.changes for press in change.get("presses", ())]
    return [
        StepPresses(step=int(at_step), plus=int(value > 0), minus=int(value < 0), value=value)
        for at_step, value in recorded
    ]


def _titled(title: str | None, part: str) -> str:
    return check_name(f"{title or 'A class teaches'} · {part}"[:MAX_NAME])


def _name(room: Room, part: str) -> str:
    return _titled(room.shown.title or room.lesson.title, part)


def _config(run: Run) -> TrainingConfig:
    return cast(TrainingConfig, run.config)


def _check_teaches(room: Room) -> None:
    if (refusal := room.refusal("press")) is not None:
        raise Forbidden(refusal)


def _being_taught(run: Run | None) -> Run:
    """Return a training that goes on.

    Raises:
        Conflict: if there is none, or it has ended.
    """
    if run is None or run.state not in NOT_ENDED:
        raise Conflict("nothing is taught now; wait for the teacher to start", "ended")
    return run


def _state(room: Room, run: Run | None) -> Literal["ready", "teaching", "frozen", "ended"]:
    if run is None:
        return "ready"
    if run.state not in NOT_ENDED:
        return "ended"
    return "frozen" if room.is_frozen else "teaching"


def _robot(run: Run | None, race: Run | None, *, is_distance_shown: bool) -> TaughtRobot | None:
    if run is None:
        return None
    if not is_distance_shown:
        return TaughtRobot(run_id=run.id, distance_m=None)
    raced = race.result.lanes if race is not None and isinstance(race.result, RaceResult) else ()
    walked = {lane.training_id: lane.total_distance_m for lane in raced}
    evaluated = run.result.distance_m if isinstance(run.result, TrainingResult) else None
    return TaughtRobot(
        run_id=run.id, distance_m=evaluated if walked.get(run.id) is None else walked[run.id]
    )
