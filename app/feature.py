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
        name: name of the feature, in HEXAPODS_WITHOUT and of its folders.
        needs: names of the features that it needs.
        uses: names of features that are made before it, if they are there.
        tables: its tables, which `migrations` creates.
        migrations: folder with its Alembic scripts: a chain of revisions of its own.
        robot_users: columns of its tables that name robots, by the noun of a row. A robot that is
            named there is not deleted, also while the feature is left out.
        damage_advice: advice against damaged rows, by the name of the table.
        state_events: names of its events of which only the newest counts.
        event_bodies: records of the data of its events, by the event's name.
        stage_members: records that each stage keeps for it, by their name in the stage's state:
            operators set them by `PUT /stage`, `stage` events report them. They begin with their
            defaults.
        page: folder with its part of the page, `feature.json` and modules, if it is of another
            package; None for `static/features/NAME`.
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
        """Build the feature's services, after those of the core and of features that it needs."""
        self.core = core

    @classmethod
    def routers(cls, agents: tuple[str, ...]) -> Sequence[APIRouter]:
        """Return the feature's routes of the API, whose paths are below `/api/v1`.

        Args:
            agents: names of the registered agents.
        """
        del agents
        return ()

    def pages(self) -> Sequence[BaseRoute]:
        """Return the feature's routes outside of the API."""
        return ()

    def robots_txt(self) -> str | None:
        """Return the text of `robots.txt`; None for that of another feature, or the default."""
        return None

    @classmethod
    def start_kinds(cls, agents: tuple[str, ...]) -> Sequence["StartKind"]:
        """Return the kinds of runs that the feature adds and that can be started; see `routers`.

        Its module `run_kind` has how such a run is stored, computed and shown.
        """
        del agents
        return ()

    @classmethod
    def routers_of_start(cls, start: "StartKind") -> Sequence[APIRouter]:
        """Return the feature's routes about a kind of run that can be started; see `routers`."""
        del start
        return ()

    @classmethod
    def options(cls, agents: tuple[str, ...]) -> Mapping[str, Any]:
        """Return the members that the feature adds to the response of `GET /options`.

        A member with the name of an object of the core, such as `limits`, is merged into it.

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
        """Read all rows of the feature, so that damaged ones are found."""

    def open(self) -> AbstractAsyncContextManager[None]:
        """Return the feature's lifespan context, entered after the core's, before the first job."""
        return nullcontext()

    def close(self) -> None:
        """End long work as the server stops; called before the context of `open` is exited."""

    def owner_of(self, run_id: str) -> Owner | None:
        """Return the owner of a run for the queue; None if no client of the feature started it."""
        del run_id
        return None

    def provider(self) -> "IdentityProvider | None":
        """Return the provider of identities of the feature's clients; None if it has no clients."""
        return None

    def visible_runs(self, identity: "Identity | None") -> ColumnElement[bool] | None:
        """Return the SQL condition that a client, no operator, may see a run; None for all runs.

        Args:
            identity: identity of the client; None for a spectator.
        """
        del identity
        return None

    def why_hidden(self, run_id: str, identity: "Identity | None") -> str | None:
        """Return in a sentence why a run is hidden from a client; None if it is not.

        It must agree with `visible_runs`, by which this default queries the database. A feature
        that hides runs looks them up in memory: each request about a run and each event calls it.

        Args:
            run_id: id of the run, or any other text in its place.
            identity: identity of a client, no operator; None for a spectator.
        """
        condition = self.visible_runs(identity)
        is_visible = condition is None or run_id not in hidden_ids(self.core.store, condition)
        return None if is_visible else f"This run is hidden by the feature {self.name}."

    @classmethod
    def visible_when_left_out(cls) -> ColumnElement[bool] | None:
        """Return the SQL condition that a run is not hidden while the feature is left out.

        Operators alone see the others then. None if the feature hides no run.
        """
        return None

    def start_run(
        self, request: Request, start_request: "StartRequest", start: Start
    ) -> Response | None:
        """Start a run for a client of the feature's; None for clients that it does not know."""
        del request, start_request, start
        return None

    def adopt(self, run_ids: Sequence[str]) -> None:
        """Make an operator the owner of runs with these ids, as they were imported."""

    def unfinished(self) -> Iterable[str]:
        """Return the ids of runs that a crash interrupted, and that are to be resumed."""
        return ()

    def on_resumed(self) -> None:
        """Go on with what belongs to the runs of `unfinished`, which are queued again now."""

    def delete_before(self, time: datetime, delete_runs: DeleteRuns) -> Iterable[str]:
        """Delete data that was not used since a time, on servers that keep data for a limited time.

        Returns:
            names of the deleted things, for `forget`.
        """
        del time, delete_runs
        return ()

    async def forget(self, names: Iterable[str]) -> None:
        """Close, on the event loop, the open resources of what `delete_before` has deleted."""

    def metrics(self) -> Iterable[Metric]:
        """Yield the feature's metrics for Prometheus."""
        return ()


def hidden_ids(store: RunStore, condition: ColumnElement[bool]) -> frozenset[str]:
    """Return the ids of the runs that a condition hides."""
    query = select(RUNS.c.id).where(not_(condition))
    return frozenset(store.database.read(lambda c: c.execute(query).scalars().all()))


@contextmanager
def blaming(feature: type[Feature], what: str) -> Iterator[None]:
    """Name a feature whose code raises an unexpected error, and how to start without it.

    Args:
        feature: the feature whose code runs in this context.
        what: name of the part of the feature that runs, in words.

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
