"""The features of one app, and the calls of the core to all of them."""

import logging
from collections.abc import Collection, Iterable, Iterator
from contextlib import AsyncExitStack
from pathlib import Path
from typing import TYPE_CHECKING

from prometheus_client.metrics_core import Metric
from sqlalchemy import ColumnElement, and_, inspect

from app.feature import Feature, blaming, hidden_ids, stage_members
from app.installed_features import Catalogue
from app.jobs.queue import Owner
from app.setting_fields import PREFIX
from app.storage.database.engine import Database
from app.storage.database.migration import migrate_feature
from app.storage.database.store import RunStore
from hexapods.domain.errors import InvalidInput
from hexapods.domain.records import Record

if TYPE_CHECKING:
    from app.api.deps import Services
    from app.api.identity import Identity, IdentityProvider

_logger = logging.getLogger(__name__)
_HIDE_NOTHING = (Feature.visible_runs, Feature.why_hidden)


class Features:
    """Registry of the features of one app, sorted so that each comes after those that it needs.

    Attributes:
        classes: classes of the features, in this order.
        providers: identity providers of the features that have one.
    """

    def __init__(self, catalogue: Catalogue, store: RunStore) -> None:
        """Migrate the tables of the features to this version; `build` creates the features.

        Args:
            catalogue: classes of the installed features, and of those that are left out.
            store: store of the runs.

        Raises:
            DamagedFile: if a table of a feature is missing.
            InvalidInput: if a newer version made its tables, or two features add something of one
                name.
        """
        self.classes = catalogue.classes
        _check_names(self.classes)
        self.providers: list[IdentityProvider] = []
        self._features: dict[str, Feature] = {}
        self._hiding: list[Feature] = []
        """Features that hide runs: asked about each event, for each client."""
        migrate_tables(self.classes, store.database)
        self._left_out = _LeftOut(catalogue.left_out, store)
        keep_named_robots(catalogue, store)

    def build(self, core: "Services") -> None:
        """Create the features of an app, and collect their identity providers.

        Raises:
            InvalidInput: if a feature cannot be created.
        """
        for feature in self.classes:
            with blaming(feature, "its start"):
                built = self._features[feature.name] = feature(core)
                if (provider := built.provider()) is not None:
                    self.providers.append(provider)
            if (feature.visible_runs, feature.why_hidden) != _HIDE_NOTHING:
                self._hiding.append(built)

    def __iter__(self) -> Iterator[Feature]:
        return iter(self._features.values())

    def get(self, name: str) -> Feature | None:
        """Return a feature by its name; None if it is left out."""
        return self._features.get(name)

    @property
    def page_folders(self) -> dict[str, Path]:
        """Folders of the pages of features of other packages, by the feature's name."""
        return {feature.name: feature.page for feature in self.classes if feature.page is not None}

    def stage_members(self) -> dict[str, Record]:
        """Return the default records that features add to the state of each stage, by name."""
        return {name: kind() for name, kind in stage_members(self.classes).items()}

    def owner_of(self, run_id: str) -> Owner | None:
        """Return the owner of a run for the queue; None if an operator started it.

        If `owner_of` of a feature fails, the feature itself is the owner: no other runs wait for
        that, and the run is not shown to everyone.
        """
        for feature in self:
            try:
                owner = feature.owner_of(run_id)
            except Exception:
                _logger.exception("the feature %s cannot say whose %s is", feature.name, run_id)
                return Owner(feature.name)
            if owner is not None:
                return owner
        return None

    def visible_runs(self, identity: "Identity | None") -> ColumnElement[bool] | None:
        """Return the SQL condition that no feature hides a run from a client; None if none does.

        Raises:
            InvalidInput: if `visible_runs` of a feature fails.
        """
        conditions = [self._left_out.visible_runs]
        for feature in self._hiding:
            with blaming(type(feature), "`visible_runs`"):
                conditions.append(feature.visible_runs(identity))
        hiding = [condition for condition in conditions if condition is not None]
        return and_(*hiding) if hiding else None

    def why_hidden(self, run_id: str, identity: "Identity | None") -> str | None:
        """Return in a sentence why a run is hidden from a client who is no operator; else None.

        Raises:
            InvalidInput: if `why_hidden` of a feature fails.
        """
        for feature in self._hiding:
            with blaming(type(feature), "`why_hidden`"):
                why = feature.why_hidden(run_id, identity)
            if why is not None:
                return why
        return self._left_out.why_hidden(run_id)

    def is_hidden(self, run_id: str | None, identity: "Identity | None") -> bool:
        """Whether a feature hides a run from a client who is no operator; False of None."""
        return run_id is not None and self.why_hidden(run_id, identity) is not None

    async def open(self, stack: AsyncExitStack) -> None:
        """Enter the contexts of all features; the stack exits them.

        Raises:
            InvalidInput: if a feature fails.
        """
        for feature in self:
            with blaming(type(feature), "`open`"):
                await stack.enter_async_context(feature.open())

    def unfinished(self) -> Iterator[str]:
        """Yield the ids of runs that a crash interrupted, and that are to be resumed."""
        for feature in self:
            try:
                yield from feature.unfinished()
            except Exception:  # the runs stay interrupted, and can be resumed by hand
                _logger.exception("the feature %s cannot say which runs go on", feature.name)

    def on_resumed(self) -> None:
        """Let all features go on with the runs that were resumed; those that fail are logged."""
        for feature in self:
            try:
                feature.on_resumed()
            except Exception:
                _logger.exception("the feature %s cannot go on with its runs", feature.name)

    def metrics(self) -> Iterator[Metric]:
        """Yield the metrics of all features; those of a feature that fails are left out."""
        for feature in self:
            try:
                yield from feature.metrics()
            except Exception:
                _logger.exception("the feature %s has no metrics", feature.name)


def migrate_tables(classes: Iterable[type[Feature]], database: Database) -> None:
    """Migrate the tables of features to this version.

    Raises:
        DamagedFile: if a table is missing.
        InvalidInput: if a newer version of a feature made its tables.
        StorageFailed: if the database is unavailable.
    """
    for feature in classes:
        if feature.tables is not None and feature.migrations is not None:
            migrate_feature(database, feature.name, feature.migrations, feature.tables)


def _check_names(classes: Iterable[type[Feature]]) -> None:
    """Check that no feature replaces what another one adds.

    Raises:
        InvalidInput: if two have a table, an event, a member of the stage or an option of one name.
    """
    names: dict[tuple[str, str], str] = {}
    for feature in classes:
        tables = () if feature.tables is None else feature.tables.tables
        added = {
            "table": tables,
            "event": feature.event_bodies,
            "member of the stage": feature.stage_members,
            "option": feature.option_types,
        }
        for what, name in ((kind, name) for kind in added for name in added[kind]):
            if (first := names.setdefault((what, name), feature.name)) != feature.name:
                raise InvalidInput(
                    f"the features {first} and {feature.name} both have the {what} {name}; leave "
                    f"one of both out by {PREFIX}WITHOUT"
                )


def keep_named_robots(catalogue: Catalogue, store: RunStore) -> None:
    """Register the tables of all features that name robots, so that the store keeps these robots.

    A table that is missing, as of a feature that has never been there, names none.
    """
    table_names = set(inspect(store.database.engine).get_table_names())
    for feature in (*catalogue.classes, *catalogue.left_out):
        for noun, columns in feature.robot_users.items():
            if columns[0].table.name in table_names:
                store.robots.users[noun] = columns


class _LeftOut:
    """Runs that are hidden by features which are left out of this server.

    Attributes:
        visible_runs: SQL condition that none of these features hides a run; None if they hide none.
    """

    def __init__(self, classes: Iterable[type[Feature]], store: RunStore) -> None:
        """Read the ids of the hidden runs: while the features are left out, no run is added.

        Raises:
            InvalidInput: if a feature fails to return them: all that it hides would be shown.
        """
        table_names = set(inspect(store.database.engine).get_table_names())
        conditions: list[ColumnElement[bool]] = []
        self._hidden: dict[str, str] = {}
        for feature in classes:
            condition = _visible_when_left_out(feature)
            if condition is None or not _has_tables(feature, table_names):
                continue
            conditions.append(condition)
            self._hidden |= dict.fromkeys(hidden_ids(store, condition), feature.name)
        self.visible_runs = and_(*conditions) if conditions else None

    def why_hidden(self, run_id: str) -> str | None:
        """Return in a sentence why a run is hidden; None if it is not."""
        feature = self._hidden.get(run_id)
        return (
            None
            if feature is None
            else f"The feature {feature} hides this run, and is left out on this server."
        )


def _visible_when_left_out(feature: type[Feature]) -> ColumnElement[bool] | None:
    try:
        return feature.visible_when_left_out()
    except Exception as error:
        raise InvalidInput(
            f"the feature {feature.name} is left out, and cannot say which runs it hides: "
            f"{type(error).__name__}: {error}; mend or uninstall its package"
        ) from error


def _has_tables(feature: type[Feature], table_names: Collection[str]) -> bool:
    """Whether the tables of a feature are there; of a new data folder they are not."""
    missing = set() if feature.tables is None else feature.tables.tables.keys() - table_names
    if missing and len(missing) < len(feature.tables.tables if feature.tables else ()):
        _logger.warning(
            "the database has lost %s of the feature %s, which is left out: runs that it hides are "
            "shown",
            ", ".join(sorted(missing)),
            feature.name,
        )
    return not missing
