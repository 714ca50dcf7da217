"""The seam between the core and its features: all that a feature may add.

A feature is a package `app/features/NAME` with a module `feature` that has a subclass of `Feature`
as `FEATURE`, or a class that another package names in the entry-point group `hexapods.features`.
The core asks its features (`active_features`), and names none of them; HEXAPODS_WITHOUT leaves some
out (`installed_features`). Settings (`feature_settings`), commands (`cli.commands`) and kinds of
runs (`storage.run_kind`) of a feature are no members of the class: they are in modules of their
own, which commands read without a server.
"""

from collections.abc import Callable, Collection, Iterable, Iterator, Mapping, Sequence
from contextlib import (
    AbstractAsyncContextManager,
    contextmanager,
    nullcontext,
)
from datetime import datetime
from pathlib import Path
from typing import TYPE_CHECKING, Any, ClassVar

from fastapi import APIRouter
from prometheus_client.metrics_core import Metric
from sqlalchemy import Column, ColumnElement, MetaData, not_, select
from starlette.requests import Request
from starlette.responses import Response
from starlette.routing import BaseRoute

from app.answer import Answer
from app.jobs.queue import Owner
from app.jobs.submissions import Start
from app.setting_fields import PREFIX
from app.storage.database.schema import RUNS
from app.storage.database.store import RunStore
from hexapods.domain.errors import HexapodError, InvalidInput
from hexapods.domain.records import Record

if TYPE_CHECKING:
    from app.api.deps import Services, StartRequest
    from app.api.identity import Identity, IdentityProvider
    from app.api.starts import StartKind

DeleteRuns = Callable[[Iterable[str]], Collection[str]]
"""Stops and deletes runs by their ids, and returns the ids of those that are gone."""


class Feature:
    """Base class of features. One object is made for each app; each member does nothing by default.

    Attributes:
        name: of the feature, in HEXAPODS_WITHOUT and of its folders.
        needs: names of the features without which it cannot be.
        uses: names of features that are made before it, if they are there.
        tables: its tables, which `migrations` creates.
        migrations: folder with its Alembic scripts: a chain of revisions of its own.
        robot_users: by noun of what names robots in one of its tables, the columns that do. Such a
            robot is not deleted, also while the feature is left out.
        damage_advice: by name of its tables, what helps against damaged rows.
        state_events: names of its events of which only the newest counts.
        event_bodies: records of the data of its events, by the event's name.
        stage_members: records that each stage keeps for it, by their name in the stage's state:
            operators set them by `PUT /stage`, who watches is told of them. They begin with their
            defaults.
        page: of another package the folder with its part of the page: `feature.json` and its
            modules; that of the others is `static/features/NAME`.
        option_types: types of what `options` returns, by name: `defaults.NAME` of a default.
        core: the services of the core.
    """

    name: ClassVar[str]
    needs: ClassVar[Sequence[str]] = ()
    uses: ClassVar[Sequence[str]] = ()
    tables: ClassVar[MetaData | None] = None
    migrations: ClassVar[Path | None] = None
    robot_users: ClassVar[Mapping[str, Sequence[Column[Any]]]] = {}
    damage_advice: ClassVar[Mapping[str, str]] = {}
    state_events: ClassVar[Collection[str]] = ()
    event_bodies: ClassVar[Mapping[str, type[Answer]]] = {}
    stage_members: ClassVar[Mapping[str, type[Record]]] = {}
    option_types: ClassVar[Mapping[str, Any]] = {}
    page: ClassVar[Path | None] = None

    def __init__(self, core: "Services") -> None:
        """Build its services; those of the core, and the features that it needs, are there."""
        self.core = core

    @classmethod
    def routers(cls, agents: tuple[str, ...]) -> Sequence[APIRouter]:
        """Return its routes of the API, whose paths are below `/api/v1`.

        Args:
            agents: names of the registered agents.
        """
        del agents
        return ()

    def pages(self) -> Sequence[BaseRoute]:
        """Return its routes outside of the API."""
        return ()

    def robots_txt(self) -> str | None:
        """Return what crawlers may read, in place of nothing; None to leave that to others."""
        return None

    @classmethod
    def start_kinds(cls, agents: tuple[str, ...]) -> Sequence["StartKind"]:
        """Return the kinds of runs that it adds and that can be started; see `routers`.

        How such a run is stored, computed and shown is in its module `run_kind`.
        """
        del agents
        return ()

    @classmethod
    def routers_of_start(cls, start: "StartKind") -> Sequence[APIRouter]:
        """Return its routes of the API about a kind of run that can be started; see `routers`."""
        del start
        return ()

    @classmethod
    def options(cls, agents: tuple[str, ...]) -> Mapping[str, Any]:
        """Return what it adds to `GET /options`.

        What has the name of an object of the core, such as `limits`, is added to that object.

        Args:
            agents: names of the registered agents.
        """
        del agents
        return {}

    @classmethod
    def complete_schema(cls, schemas: dict[str, Any]) -> None:
        """Add schemas to the description of the API that FastAPI does not find by itself."""

    @classmethod
    def read_rows(cls, store: RunStore) -> None:
        """Read all its rows, so that those that are damaged are known."""

    def open(self) -> AbstractAsyncContextManager[None]:
        """Return what runs with the app: entered after the core's parts, before the first job."""
        return nullcontext()

    def close(self) -> None:
        """End what takes long, as the server stops; called before what `open` returned is left."""

    def owner_of(self, run_id: str) -> Owner | None:
        """Return who waits for a run; None if it is nobody whom the feature knows."""
        del run_id
        return None

    def provider(self) -> "IdentityProvider | None":
        """Return what knows the feature's clients."""
        return None

    def visible_runs(self, identity: "Identity | None") -> ColumnElement[bool] | None:
        """Return the condition that a run is one that a client, no operator, may see; None for all.

        Args:
            identity: of the client; None for a spectator.
        """
        del identity
        return None

    def why_hidden(self, run_id: str, identity: "Identity | None") -> str | None:
        """Return in a sentence why a run is hidden from a client; None if it is not.

        It must agree with `visible_runs`, which it asks the database for; a feature that hides runs
        knows by itself which, as each request about a run and each event asks this.

        Args:
            run_id: of the run, or anything else in its place.
            identity: of a client, no operator; None for a spectator.
        """
        condition = self.visible_runs(identity)
        is_visible = condition is None or run_id not in hidden_ids(self.core.store, condition)
        return None if is_visible else f"This run is hidden by the feature {self.name}."

    @classmethod
    def visible_when_left_out(cls) -> ColumnElement[bool] | None:
        """Return the condition that a run is not hidden while the feature is left out.

        Who could see the others is not known then, but for operators. None if it hides no run.
        """
        return None

    def start_run(
        self, request: Request, start_request: "StartRequest", start: Start
    ) -> Response | None:
        """Start a run for a client of the feature's; None for clients that it does not know."""
        del request, start_request, start
        return None

    def adopt(self, run_ids: Sequence[str]) -> None:
        """Take note that runs with these ids are an operator's now, as they were imported."""

    def unfinished(self) -> Iterable[str]:
        """Return the ids of runs that are to go on, which a crash of the server interrupted."""
        return ()

    def delete_before(self, time: datetime, delete_runs: DeleteRuns) -> Iterable[str]:
        """Delete what has not been used since a time, as a server does that keeps nothing for long.

        Returns:
            names of what is gone, for `forget`.
        """
        del time, delete_runs
        return ()

    async def forget(self, names: Iterable[str]) -> None:
        """Close on the event loop what was open for what `delete_before` has deleted."""

    def metrics(self) -> Iterable[Metric]:
        """Yield its metrics for Prometheus."""
        return ()


def hidden_ids(store: RunStore, condition: ColumnElement[bool]) -> frozenset[str]:
    """Return the ids of the runs that a condition hides."""
    query = select(RUNS.c.id).where(not_(condition))
    return frozenset(store.database.read(lambda c: c.execute(query).scalars().all()))


@contextmanager
def blaming(feature: type[Feature], what: str) -> Iterator[None]:
    """Name a feature whose code raises an unexpected error, and how to start without it.

    Args:
        feature: whose code runs in this context.
        what: of the feature fails, in words.

    Raises:
        InvalidInput: in place of that error.
    """
    try:
        yield
    except HexapodError:
        raise
    except Exception as error:
        raise InvalidInput(
            f"the feature {feature.name} fails in {what}: {type(error).__name__}: {error}; "
            f"start without it by {PREFIX}WITHOUT={feature.name}"
        ) from error


def stage_members(features: Iterable[type[Feature]]) -> dict[str, type[Record]]:
    """Return the records that each stage keeps for features, by their name in the stage's state."""
    return {name: kind for feature in features for name, kind in feature.stage_members.items()}
