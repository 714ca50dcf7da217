"""A data folder with rows in every table, as the server's own parts write them."""

from app.api.answers import ComparisonView, SeedsView
from app.features.classroom.lesson import Lesson, read_lesson
from app.features.classroom.lesson_rows import LessonRows
from app.features.classroom.lessons import Lessons
from app.features.classroom.room_rows import RoomRows, RoomRun
from app.features.classroom.rooms import Rooms
from app.features.demo.rows import VisitorRows, VisitorRun
from app.features.tournaments.judge import outcome_of
from app.features.tournaments.tournament import EnteredTable, Entrant
from app.features.tournaments.tournaments import Tournaments
from app.storage.database.store import RunStore
from app.storage.run import TABLE, IdempotencyKey
from app.storage.sessions import Sessions
from app.storage.stored_robot import StoredRobot
from hexapods.domain.gait import GaitSpec
from hexapods.domain.robot import document_of, robot
from hexapods.domain.robot_documents import id_of
from hexapods.tournaments.entry import EntryConfig
from hexapods.tournaments.judging import Judgement
from hexapods.tournaments.rules import TournamentRules
from hexapods.tournaments.tournament_file import sha256_of
from tests.features.experiments.ended_experiments import ended_experiment
from tests.storage.ended_runs import ended_race, ended_training
from tests.storage.stores import training

TOKEN = "a-token-for-tests"
TRAINING, RACE, EXPERIMENT = "00000000000t1", "00000000000r1", "00000000000e1"
OF_ROOM, OF_VISITOR = "00000000000p1", "00000000000v1"
VISITOR = 64 * "a"
TAUGHT = "Taught"
"""Title of the room that is open."""
_SEEDS = SeedsView(
    settings={"alpha": 0.5},
    steps_per_episode=50,
    distances_m=[0.25, 0.25],
    walkers=1.0,
    iqm_m=0.25,
)
COMPARISON = ComparisonView(seeds=2, greedy_m=0.5, compute_s=0.5, chosen=_SEEDS, default=_SEEDS)
"""Answer of a what-if."""


def lesson(title: str) -> Lesson:
    """Return a lesson that asks, and lets the class practise."""
    asks = {"text": "a", "ask": {"kind": "number", "text": ""}}
    state = {"form": {"gait": "left-right-origin", "simulator": "kinematic", "steps": 5}}
    runs = {"text": "b", "state": state, "go": "what-if"}
    return read_lesson({"title": title, "cards": [asks, runs]})


def fill(store: RunStore, copies: int) -> None:
    """Put a row into each table, and several into those whose rows cannot simply be copied.

    Args:
        store: an empty one.
        copies: number of robots, and of rooms that have ended.
    """
    for run_id in (TRAINING, OF_ROOM, OF_VISITOR):
        ended_training(store, run_id, run_id, steps=20)
    ended_race(store, RACE, TRAINING)
    ended_experiment(store, EXPERIMENT)
    store.create(training("00000000000k1"), key=IdempotencyKey("a key", 64 * "b"))
    store.change("00000000000k1", {"queued"}, "stopped")
    store.baselines.add(64 * "c", 0.5)
    Sessions(store.sessions, TOKEN).open()
    _add_robots(store, copies)
    Lessons(LessonRows(store)).add(lesson("A lesson"))
    code = _fill_rooms(store, copies)
    _fill_tournaments(store, code)
    created_at = store.get(OF_VISITOR).created_at
    VisitorRows(store.database).add([VisitorRun(OF_VISITOR, VISITOR, 20, True, created_at)])


def _add_robots(store: RunStore, count: int) -> None:
    gait = GaitSpec(right_leg=1, left_leg=4, pairs=((1, 4), (2, 6), (3, 5)))
    for number in range(count):
        document = document_of(robot({"femur_m": 0.08 + number / 10_000}))
        about = StoredRobot(
            id=id_of(document),
            name=f"Robot {number}",
            gait=gait,
            guesses=("Its legs were guessed.",),
            repairs=("Its mass was missing.",),
            choices={"legs": 6},
            file="robot.urdf",
        )
        store.robots.add(document, about)


def _fill_rooms(store: RunStore, ended: int) -> str:
    """Add a room that goes on, with all that belongs to one, and empty ones that have ended."""
    rooms = Rooms(store)
    for number in range(ended):
        rooms.end(rooms.create(lesson(f"Room {number}")).code)
    code = rooms.create(lesson(TAUGHT)).code
    rooms.join(code)
    rooms.predict(code, 0, 0, 0.25)
    rooms.show_card(code, 1)
    rooms.ask(code, 0, {"alpha": 0.5}, lambda: COMPARISON, card=1)
    rooms.show_card(code, 0)
    (room_run,) = rooms.get(code).runs.values()
    of_room: RoomRun = room_run._replace(run_id=OF_ROOM, card=0, answer=None)
    RoomRows(store.database).add_runs([of_room])
    return code


def _fill_tournaments(store: RunStore, code: str) -> None:
    """Add a tournament that has ended, with a table that has entered."""
    tournaments = Tournaments(store)
    rules = TournamentRules(
        gait="left-right-origin", simulator="kinematic", steps=20, draws=5, tables=True
    )
    tournament = tournaments.create(rules, "Cup", code, 6)
    data = store.artifact(TRAINING, TABLE) or b""
    table = EnteredTable(TRAINING, sha256_of(data), data)
    entry = EntryConfig(agent="q-learning", table=table.sha256)
    tournaments.enter(tournament.id, Entrant(0), entry, table)
    tournaments.end(tournament.id)
    for number in tournament.entries:
        for draw in range(rules.draws):
            tournaments.keep(tournament, number, draw, Judgement(0.1 + draw / 10 + number))
    judged = {entry.number: entry.in_order() for entry in tournament.judged}
    tournaments.finish(tournament, outcome_of((rules, tournament.secret, judged)))
