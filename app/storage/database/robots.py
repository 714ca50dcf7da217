"""Stored robots: rows of the `robots` table, and documents and uploads in files beside it."""

import itertools
import logging
import threading
import time
from collections.abc import Iterable, Iterator, Mapping, Sequence
from contextlib import contextmanager, suppress
from dataclasses import replace
from datetime import datetime
from pathlib import Path
from typing import Any, NamedTuple

from sqlalchemy import (
    Column,
    ColumnElement,
    Connection,
    String,
    cast,
    delete,
    func,
    inspect,
    or_,
    select,
    true,
    update,
)

from app.storage.database.columns import DELETED_AT, not_deleted
from app.storage.database.deletions import Deletions
from app.storage.database.engine import Database
from app.storage.database.rows import forget_configs
from app.storage.database.schema import ROBOTS, RUNS
from app.storage.database.stored_rows import DecodedRows, put_rows, read_rows, rows_in
from app.storage.disk_space import DiskSpace
from app.storage.errors import Conflict, NotFound, StorageFailed, StorageFull
from app.storage.stored_robot import MAX_ROBOTS, StoredRobot, distinct_name
from hexapods.domain.errors import HexapodError
from hexapods.domain.records import from_json, to_json
from hexapods.domain.robot import Robot
from hexapods.domain.robot_documents import ENDING, is_id
from hexapods.domain.robot_library import LIBRARY
from hexapods.domain.text import check_name
from hexapods.files import is_disk_full, write_atomically

UPLOAD_ENDING = ".upload"
"""Ending of the files that robots were read from."""
FOUND_ENDING = ".found"
"""Ending of the files with the findings in these files, in JSON."""
_ENDINGS = (ENDING, UPLOAD_ENDING, FOUND_ENDING)
# From the time [ms], so that versions increase across restarts of the server.
_versions = itertools.count(time.time_ns() // 1_000_000)
_logger = logging.getLogger(__name__)


class RobotOrigin(NamedTuple):
    """The file that a robot was read from.

    Attributes:
        upload: the file.
        found: findings in the file, in JSON.
    """

    upload: bytes
    found: bytes


class RobotStore:
    """Stores robots. Thread-safe.

    A document is written before its row, and deleted after it: a crash leaves at most a file
    without a row, which the next start deletes. A robot that is deleted keeps row and files while
    it can be restored; its name is free at once.

    Attributes:
        users: columns of one table that may name robots, by the noun of its rows.
        version: version of the list of robots; a greater one after each change.
    """

    def __init__(
        self, database: Database, folder: Path, disk_space: DiskSpace, deletions: Deletions
    ) -> None:
        """Use the `robots` table of a database, and a folder for the files.

        Args:
            database: database with the table.
            folder: folder for these files alone; must exist before the first write.
            disk_space: checked before each write.
            deletions: deletes robots so that they can be restored for a while.
        """
        self._database, self._folder, self._disk_space = database, folder, disk_space
        self._deletions = deletions
        deletions.purges[ROBOTS.name] = self._purge
        # Lock of changes: a robot must not be deleted between its document's writing and its row's.
        self.lock = threading.RLock()
        self.users: dict[str, Sequence[Column[Any]]] = {"run": (RUNS.c.config, RUNS.c.result)}
        self._described: set[str] = set()
        self.version = next(_versions)

    @contextmanager
    def known(self) -> Iterator[None]:
        """Add the robots to this process's library within the context, with their names."""
        LIBRARY.add_folder(self._folder)
        try:
            self._describe(self.stored(hidden=True))
            LIBRARY.withdraw(self._folder, self._database.read(_deleted_ids))
            yield
        finally:
            LIBRARY.remove_folder(self._folder)
            LIBRARY.forget(self._described)

    def stored(self, *, hidden: bool = False) -> Sequence[StoredRobot]:
        """Return the robots in the order in which they were stored.

        Args:
            hidden: whether hidden ones are listed too.
        """
        order = ROBOTS.c.created_at, ROBOTS.c.id
        robots = read_rows(self._database, ROBOTS, _decode, *order).sound
        return [robot for robot in robots if hidden or not robot.hidden]

    def readable(self, *, hidden: bool = False) -> Sequence[StoredRobot]:
        """Return the robots of `stored` whose documents can be read; others are logged."""
        stored = self.stored(hidden=hidden)
        damaged = damaged_robots(stored)
        for robot in stored:
            if robot.id in damaged:
                _logger.warning(
                    "robot %s (%s) is left out: %s", robot.id, robot.name, damaged[robot.id]
                )
        return [robot for robot in stored if robot.id not in damaged]

    def get(self, robot_id: str) -> StoredRobot:
        """Return a stored robot.

        Raises:
            NotFound: if there is no such robot, or its row is damaged.
        """
        return self._database.read(lambda connection: _fetch(connection, robot_id))

    def find(self, text: str) -> StoredRobot | None:
        """Return the robot of this id or name, without regard to case; None if there is none."""
        robots = self.stored(hidden=True)
        wanted = text.casefold()
        return next(
            (robot for robot in robots if wanted in (robot.id, robot.name.casefold())), None
        )

    def document(self, robot_id: str) -> bytes:
        """Return the document of a stored robot.

        Raises:
            NotFound: if there is no such robot.
            DamagedFile: if it is damaged.
        """
        return LIBRARY.find(self.get(robot_id).id)

    def origin(self, robot_id: str) -> RobotOrigin | None:
        """Return the file that a stored robot was read from; None if it was made here.

        Raises:
            NotFound: if there is no such robot.
        """
        self.get(robot_id)
        try:
            upload = self._path(robot_id, UPLOAD_ENDING).read_bytes()
            return RobotOrigin(upload, self._path(robot_id, FOUND_ENDING).read_bytes())
        except OSError:
            return None

    def add(
        self, document: bytes, about: StoredRobot, origin: RobotOrigin | None = None
    ) -> tuple[StoredRobot, bool]:
        """Store a robot, unless it is stored already; then it is hidden no longer.

        Args:
            document: document of the robot, validated.
            about: fields that are stored beside the document.
            origin: the file that it was read from, if it was.

        Returns:
            the robot as stored, and whether it is new.

        Raises:
            Conflict: if another robot has this name.
            StorageFull: if there are too many, or too little disk space.
        """
        with self.lock:
            with suppress(NotFound):
                stored = self.get(about.id)
                return (self.change(stored.id, hidden=False) if stored.hidden else stored), False
            if distinct_name(about.name, self._names()) != about.name:
                raise _name_taken(about.name)
            with self.adding([(about, document)], origin) as new:
                self._database.write(lambda connection: self.insert(connection, new))
            return about, True

    @contextmanager
    def adding(
        self, robots: Iterable[tuple[StoredRobot, bytes]], origin: RobotOrigin | None = None
    ) -> Iterator[Sequence[StoredRobot]]:
        """Write the files of robots that are not stored, whose rows are inserted in the context.

        Args:
            robots: each with its document; its name is made distinct.
            origin: the file that all of them were read from, if they were.

        Yields:
            the robots whose rows are to be inserted.
        """
        robots = list(robots)
        if not robots:  # as of most imports, which need not wait for each other
            yield []
            return
        with self.lock:
            # One that was deleted gives way to the same robot.
            ids = [robot.id for robot, _ in robots]
            self._deletions.purge_rows(ROBOTS, ROBOTS.c.id.in_(ids))
            names, new = self._names(), dict[str, tuple[StoredRobot, bytes]]()
            stored = {robot.id for robot in self.stored(hidden=True)}
            for robot, document in robots:
                if robot.id not in (*stored, *new):
                    named = replace(robot, name=distinct_name(robot.name, names))
                    names.append(named.name)
                    new[robot.id] = named, document
            self._deletions.make_room(ROBOTS, MAX_ROBOTS, len(new))
            try:
                for robot, document in new.values():
                    self._write_files(robot.id, document, origin)
                yield [robot for robot, _ in new.values()]
            except StorageFailed:
                raise  # it may have been committed; if it was not, the next start deletes the files
            except BaseException:
                for robot_id in new:
                    self._remove_files(robot_id)
                raise
            self._describe(robot for robot, _ in new.values())

    def _write_files(self, robot_id: str, document: bytes, origin: RobotOrigin | None) -> None:
        files = {ENDING: document}
        if origin is not None:
            files |= {UPLOAD_ENDING: origin.upload, FOUND_ENDING: origin.found}
        self._disk_space.check(sum(map(len, files.values())))
        try:
            for ending, data in files.items():
                write_atomically(self._path(robot_id, ending), data)
        except OSError as error:
            self._remove_files(robot_id)
            if is_disk_full(error):
                raise StorageFull("the disk of the data folder is full; make room there") from error
            raise StorageFailed(
                f"a file cannot be written to the data folder ({error.strerror})"
            ) from error

    def _remove_files(self, robot_id: str) -> None:
        # A file that stays is deleted by the next start.
        for ending in _ENDINGS:
            with suppress(OSError):
                self._path(robot_id, ending).unlink()

    def insert(self, connection: Connection, robots: Sequence[StoredRobot]) -> None:
        """Insert rows within a transaction.

        Raises:
            StorageFull: if there would be too many.
        """
        count = connection.execute(select(func.count()).select_from(ROBOTS)).scalar_one()
        if count + len(robots) > MAX_ROBOTS:
            raise StorageFull(f"at most {MAX_ROBOTS} robots are stored; delete some that none use")
        put_rows(connection, ROBOTS, [_encode(robot) for robot in robots])

    def check(self, connection: Connection, robots: Iterable[Robot]) -> None:
        """Check within a transaction that the stored ones of some robots have a row.

        Raises:
            NotFound: if a robot was deleted.
        """
        for robot in robots:
            if robot.id is not None:
                self.check_not_deleted(connection, robot.id)
                _fetch(connection, robot.id)

    def check_not_deleted(self, connection: Connection, text: str) -> None:
        """Check within a transaction that a text, such as a config in JSON, names no deleted robot.

        What names one cannot be decoded, and so tells no robots for `check`.

        Raises:
            NotFound: if it names one that can still be restored.
        """
        for robot_id in _deleted_ids(connection):
            if robot_id in text:
                raise NotFound(f"the robot {robot_id} was deleted: restore it first")

    def change(self, robot_id: str, **fields: Any) -> StoredRobot:
        """Change fields that are stored beside a robot's document, and return the robot.

        Raises:
            NotFound: if there is no such robot.
            Conflict: if another robot has the name.
        """
        with self.lock:
            changed = replace(self.get(robot_id), **fields)
            if distinct_name(changed.name, self._names(robot_id)) != changed.name:
                raise _name_taken(changed.name)
            values = {name: value for name, value in _encode(changed).items() if name in fields}
            statement = update(ROBOTS).where(ROBOTS.c.id == robot_id).values(values)
            self._database.write(lambda connection: connection.execute(statement))
            self._describe([changed])
            return changed

    def replace(
        self, robot_id: str, document: bytes, about: StoredRobot, origin: RobotOrigin
    ) -> StoredRobot:
        """Store a robot in the place of another, whose name it takes, at once.

        The other is deleted; one that runs use is kept, hidden, under another name. A robot that
        is stored already keeps its name.

        Args:
            robot_id: id of the other.
            document: document of the robot.
            about: fields that are stored beside the document.
            origin: the file that both were read from.

        Raises:
            NotFound: if there is no such robot.
            StorageFull: if there is too little disk space.
        """
        with self.lock:
            old = self.get(robot_id)
            if about.id == old.id:
                fields = ("gait", "guesses", "repairs", "choices")
                return self.change(old.id, **{name: getattr(about, name) for name in fields})
            earlier = distinct_name(f"{old.name[:80]}, earlier", self._names())
            is_used = False

            def work(connection: Connection) -> None:
                nonlocal is_used
                is_used = bool(self._users_of(connection, old.id))
                is_old = ROBOTS.c.id == old.id
                if is_used:
                    connection.execute(update(ROBOTS).where(is_old).values(name=earlier, hidden=1))
                else:
                    connection.execute(delete(ROBOTS).where(is_old))
                if new:
                    self.insert(connection, [replace(about, name=old.name)])
                else:
                    shown = update(ROBOTS).where(ROBOTS.c.id == about.id).values(hidden=0)
                    connection.execute(shown)

            with self.adding([(about, document)], origin) as new:
                self._database.write(work)
            if not is_used:
                self._remove_files(old.id)
                LIBRARY.forget([old.id])
            self._describe(self.stored(hidden=True))
            return self.get(about.id)

    def delete(self, robot_id: str) -> datetime | None:
        """Delete a robot so that it can be restored for a while; also one whose row is damaged.

        Returns:
            until when; None if it is gone at once, as the disk is full.

        Raises:
            NotFound: if there is no such robot.
            Conflict: if runs, or something else, use it.
        """

        def row(connection: Connection) -> ColumnElement[bool]:
            rows, users = _rows(connection, robot_id), self._users_of(connection, robot_id)
            if not (rows.sound or rows.damaged):
                raise _not_here(robot_id)
            name = rows.sound[0].name if rows.sound else robot_id
            is_hidden = bool(rows.sound) and rows.sound[0].hidden
            for noun, count in users.items():
                counted_users = f"a {noun} uses" if count == 1 else f"{count:,} {noun}s use"
                raise Conflict(
                    f"{counted_users} {name}, and could not be shown without it; hide it instead, "
                    f"or delete {f'that {noun}' if count == 1 else f'those {noun}s'} first",
                    "hidden" if is_hidden else "used",
                )
            return ROBOTS.c.id == robot_id

        with self.lock:
            until = self._deletions.delete(ROBOTS, row)
            LIBRARY.withdraw(self._folder, [robot_id])
            self._changed()
        return until

    def restore(self, robot_id: str) -> StoredRobot:
        """Bring a robot back that was deleted lately, and return it; one that is there stays.

        Raises:
            NotFound: if there is no such robot, or it was deleted too long ago.
            Conflict: if another robot has its name by now.
        """
        with self.lock:
            names = self._names(robot_id)

            def fetch(connection: Connection) -> StoredRobot:
                robot = _fetch(connection, robot_id)
                if distinct_name(robot.name, names) != robot.name:
                    raise Conflict(
                        f"there is a robot named {robot.name!r} by now; give that one another "
                        "name, and restore this one again",
                        "name",
                    )
                return robot

            robot = self._deletions.restore(ROBOTS, lambda _: ROBOTS.c.id == robot_id, fetch)
            self._describe([robot])
            return robot

    def _purge(self, is_purged: ColumnElement[bool]) -> int:
        statement = delete(ROBOTS).where(is_purged).returning(ROBOTS.c.id)
        with self.lock:
            ids = self._database.write(lambda c: c.execute(statement).scalars().all())
            for robot_id in filter(is_id, ids):
                self._remove_files(robot_id)
        return len(ids)

    def delete_orphans(self) -> int:
        """Delete files without a row, and unfinished ones; only safe before the first write.

        Returns:
            the number of deleted files.
        """
        query = select(ROBOTS.c.id)
        ids = set(self._database.read(lambda connection: connection.execute(query).scalars().all()))
        orphans = [
            path
            for path in self._folder.iterdir()
            if path.suffix not in _ENDINGS or path.stem not in ids
        ]
        for path in orphans:
            with suppress(OSError):
                path.unlink()
        return len(orphans)

    def _describe(self, robots: Iterable[StoredRobot]) -> None:
        for robot in robots:
            LIBRARY.reinstate(self._folder, [robot.id])
            LIBRARY.describe(robot.id, robot.about)
            self._described.add(robot.id)
        self._changed()

    def _changed(self) -> None:
        self.version = next(_versions)
        forget_configs()  # which have the robots' names

    def _names(self, robot_id: str | None = None) -> list[str]:
        """Return the names of all robots, or of all but one."""
        return [robot.name for robot in self.stored(hidden=True) if robot.id != robot_id]

    def _users_of(self, connection: Connection, robot_id: str) -> dict[str, int]:
        """Return the number of rows that name a robot, by their noun; without zeros."""
        counts = {}
        for noun, columns in self.users.items():
            named = (cast(column, String).contains(robot_id) for column in columns)
            table = columns[0].table
            # A row that is restored later is refused without its robot.
            is_user = or_(*named) & _is_there(connection, table)
            query = select(func.count()).select_from(table).where(is_user)
            counts[noun] = int(connection.execute(query).scalar_one())
        return {noun: count for noun, count in counts.items() if count}

    def _path(self, robot_id: str, ending: str) -> Path:
        if not is_id(robot_id):
            raise NotFound(f"there is no robot {robot_id!r}")
        return self._folder / f"{robot_id}{ending}"


def damaged_robots(robots: Iterable[StoredRobot]) -> Mapping[str, str]:
    """Return, by id, why the documents of some robots cannot be read; those that can are absent."""
    reasons = {}
    for robot in robots:
        try:
            robot.robot  # noqa: B018 - reads the document
        except HexapodError as error:
            reasons[robot.id] = str(error)
    return reasons


def _name_taken(name: str) -> Conflict:
    return Conflict(f"there is a robot named {name!r} already; choose another name", "name")


def _fetch(connection: Connection, robot_id: str) -> StoredRobot:
    rows = _rows(connection, robot_id)
    if not rows.sound:
        raise _not_here(robot_id)
    robot: StoredRobot = rows.sound[0]
    return robot


def _is_there(connection: Connection, table: Any) -> ColumnElement[bool]:
    """Return the condition that a row of a table was not deleted.

    The table of a feature that is left out may be one of an earlier version, without that column.
    """
    names = {column["name"] for column in inspect(connection).get_columns(table.name)}
    return not_deleted(table) if DELETED_AT in names else true()


def _deleted_ids(connection: Connection) -> list[str]:
    """Return the ids of the robots that were deleted, and can still be restored."""
    query = select(ROBOTS.c.id).where(ROBOTS.c[DELETED_AT].is_not(None))
    return [robot_id for robot_id in connection.execute(query).scalars() if is_id(robot_id)]


def _rows(connection: Connection, robot_id: str) -> DecodedRows:
    return rows_in(connection, ROBOTS, _decode, where=ROBOTS.c.id == robot_id)


def _not_here(robot_id: str) -> NotFound:
    return NotFound(f"there is no robot {robot_id!r} (any more)")


def _encode(robot: StoredRobot) -> dict[str, Any]:
    return {**to_json(robot), "hidden": int(robot.hidden), "created_at": robot.created_at}


def _decode(**row: Any) -> StoredRobot:
    """Return the robot of a row; raises HexapodError or ValueError if it is damaged."""
    if not is_id(row["id"]):
        raise ValueError("id: it is no id of a robot")
    if not check_name(row["name"]):
        raise ValueError("name: it is empty")
    return from_json(StoredRobot, {**row, "hidden": bool(row["hidden"])})
