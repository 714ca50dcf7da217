"""The seam between the core and its features: what a feature may add, and which there are.

A feature is a package `app/features/NAME` with a module `feature` that has a subclass of `Feature`
as `FEATURE`, or a class that another package names in the entry-point group `hexapods.features`.
The core asks its features, and names none of them; HEXAPODS_WITHOUT leaves some out.
"""

import importlib
import pkgutil
from collections.abc import Callable, Collection, Iterable, Iterator, Mapping, Sequence
from contextlib import AbstractAsyncContextManager, AsyncExitStack, nullcontext
from datetime import datetime
from importlib.metadata import EntryPoint, entry_points
from pathlib import Path
from typing import TYPE_CHECKING, Any, ClassVar

from fastapi import APIRouter
from prometheus_client.metrics_core import Metric
from pydantic import BaseModel
from sqlalchemy import ColumnElement, MetaData, and_
from starlette.requests import Request
from starlette.responses import Response
from starlette.routing import BaseRoute

from app.jobs.queue import Owner
from app.jobs.submissions import Start
from app.settings import PREFIX, Settings
from app.storage.database.migration import migrate_feature
from app.storage.database.store import RunStore
from hexapods.domain.errors import InvalidInput

if TYPE_CHECKING:
    from app.api.deps import Services, StartRequest
    from app.api.identity import Identity, IdentityProvider

GROUP = "hexapods.features"
"""Entry-point group of features of other packages."""
_PACKAGE = "app.features"
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
        damage_advice: by name of its tables, what helps against damaged rows.
        state_events: names of its events of which only the newest counts.
        event_bodies: models of the data of its events, by the event's name.
        page: of another package the folder with its part of the page: `feature.json` and its
            modules; that of the others is `static/features/NAME`.
        option_types: types of what `options` returns, by name.
        core: the services of the core.
    """

    name: ClassVar[str]
    needs: ClassVar[Sequence[str]] = ()
    uses: ClassVar[Sequence[str]] = ()
    tables: ClassVar[MetaData | None] = None
    migrations: ClassVar[Path | None] = None
    damage_advice: ClassVar[Mapping[str, str]] = {}
    state_events: ClassVar[Collection[str]] = ()
    event_bodies: ClassVar[Mapping[str, type[BaseModel]]] = {}
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
    def options(cls) -> Mapping[str, Any]:
        """Return what it adds to `GET /options`."""
        return {}

    @classmethod
    def complete_schema(cls, schemas: dict[str, Any]) -> None:
        """Add schemas to the description of the API that FastAPI does not find by itself."""

    @classmethod
    def read_rows(cls, store: RunStore) -> None:
        """Read all its rows, so that those that are damaged are known."""

    @classmethod
    def checks(cls) -> Mapping[str, Callable[[Settings], str]]:
        """Return its checks of `hexapods doctor`, by their titles."""
        return {}

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
        """Return what knows the feature's clients, and which runs are hidden from whom."""
        return None

    def visible_runs(self, identity: "Identity | None") -> ColumnElement[bool] | None:
        """Return the condition that a run is one that a client, no operator, may see; None for all.

        Args:
            identity: of the client; None for a spectator.
        """
        del identity
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


class Features:
    """The features of one app, in an order in which each comes after those that it needs.

    Attributes:
        classes: theirs.
        providers: of identities, of those that know clients.
    """

    def __init__(self, classes: tuple[type[Feature], ...], store: RunStore) -> None:
        """Bring the tables of these features to this version; `build` makes the features.

        Raises:
            DamagedFile: if a table of one is missing.
        """
        self.classes = classes
        self.providers: list[IdentityProvider] = []
        self._features: dict[str, Feature] = {}
        for feature in classes:
            if feature.tables is not None and feature.migrations is not None:
                migrate_feature(store.database, feature.name, feature.migrations, feature.tables)

    def build(self, core: "Services") -> None:
        """Make the features of an app."""
        for feature in self.classes:
            made = self._features[feature.name] = feature(core)
            if (provider := made.provider()) is not None:
                self.providers.append(provider)

    def __iter__(self) -> Iterator[Feature]:
        return iter(self._features.values())

    def get(self, name: str) -> Feature | None:
        """Return a feature by its name; None if it is left out."""
        return self._features.get(name)

    @property
    def pages_of_others(self) -> dict[str, Path]:
        """Folders of the pages of those of other packages, by name."""
        return {one.name: one.page for one in self.classes if one.page is not None}

    def owner_of(self, run_id: str) -> Owner | None:
        """Return who waits for a run; None for an operator."""
        return next((o for one in self if (o := one.owner_of(run_id)) is not None), None)

    def visible_runs(self, identity: "Identity | None") -> ColumnElement[bool] | None:
        """Return the condition that a run is one that no feature hides; see `Feature`."""
        conditions = [
            condition
            for feature in self
            if (condition := feature.visible_runs(identity)) is not None
        ]
        return and_(*conditions) if conditions else None

    def is_hidden(self, run_id: str | None, identity: "Identity | None") -> bool:
        """Whether a feature hides a run from a client who is no operator; False of None."""
        return run_id is not None and any(
            provider.why_hidden(run_id, identity) is not None for provider in self.providers
        )

    async def open(self, stack: AsyncExitStack) -> None:
        """Enter all features, to be left with the stack."""
        for feature in self:
            await stack.enter_async_context(feature.open())


def load(without: Collection[str] = ()) -> tuple[type[Feature], ...]:
    """Return the classes of all features but some, each after those that it needs.

    Args:
        without: names of those to leave out.

    Raises:
        InvalidInput: if there is no feature of such a name, one needs another that is left out, or
            two have the same name.
    """
    available = _available()
    unknown = sorted(set(without) - available.keys())
    if unknown:
        raise InvalidInput(
            f"{PREFIX}WITHOUT names no feature by {unknown[0]!r}; there are "
            f"{', '.join(sorted(available))}"
        )
    kept = {name: feature for name, feature in available.items() if name not in without}
    ordered: dict[str, type[Feature]] = {}
    for name in kept:
        _add(name, kept, available, ordered)
    return tuple(ordered.values())


def _add(
    name: str,
    kept: Mapping[str, type[Feature]],
    available: Mapping[str, type[Feature]],
    ordered: dict[str, type[Feature]],
    waiting: tuple[str, ...] = (),
) -> None:
    """Add a feature to those that are ordered, after those that it needs and uses.

    Of features that need each other, whose names are in `waiting`, one is first.
    """
    if name in (*ordered, *waiting):
        return
    waiting += (name,)
    for needed in kept[name].needs:
        if needed not in kept:
            where = "is left out" if needed in available else "is not installed"
            raise InvalidInput(
                f"the feature {name} needs {needed}, which {where}; leave {name} out too, by "
                f"{PREFIX}WITHOUT"
            )
        _add(needed, kept, available, ordered, waiting)
    for used in kept[name].uses:
        if used in kept:
            _add(used, kept, available, ordered, waiting)
    ordered[name] = kept[name]


def _available() -> dict[str, type[Feature]]:
    """Return the classes of all features that are installed, by name."""
    package = importlib.import_module(_PACKAGE)
    modules = [f"{_PACKAGE}.{one.name}.feature" for one in pkgutil.iter_modules(package.__path__)]
    classes = [(name, importlib.import_module(name).FEATURE) for name in sorted(modules)]
    classes += [(entry.value, _loaded(entry)) for entry in entry_points(group=GROUP)]
    available: dict[str, type[Feature]] = {}
    for origin, feature in classes:
        if feature.name in available:
            raise InvalidInput(
                f"two features are called {feature.name}, one of them in {origin}; uninstall one"
            )
        available[feature.name] = feature
    return available


def _loaded(entry: EntryPoint) -> type[Feature]:
    try:
        feature = entry.load()
    except Exception as error:
        raise InvalidInput(
            f"the feature {entry.name} of {entry.value} cannot be imported: {error}; mend or "
            "uninstall its package"
        ) from error
    if not (isinstance(feature, type) and issubclass(feature, Feature)):
        raise InvalidInput(f"{entry.value} is no subclass of app.feature.Feature")
    return feature
