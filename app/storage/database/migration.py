"""Schema migration: upgrade a database to the schema of this version with Alembic."""

import logging
from collections.abc import Iterable
from pathlib import Path

from alembic import command
from alembic.config import Config
from alembic.runtime.migration import MigrationContext
from alembic.script import ScriptDirectory
from sqlalchemy import Connection, MetaData, inspect

from app.storage.database.engine import Database
from hexapods.domain.errors import DamagedFile, InvalidInput

SCRIPT_LOCATION = "app.storage.database:migrations"
CONNECTION = "connection"
"""Key of the open connection among the attributes of Alembic's config (see `migrations/env`)."""
VERSION_TABLE = "version_table"
"""Likewise of the name of the table that has the revision."""
_CORE_VERSION_TABLE = "alembic_version"
_BEFORE_0_3 = frozenset(f"{number:04}" for number in range(1, 11))
"""Revisions of the schemas before 0.3, whose data is not read."""


def migrate(database: Database) -> None:
    """Upgrade the database to this version's schema in one transaction.

    Raises:
        InvalidInput: if a newer version created it, or one before 0.3.
        StorageFailed: if the database is unavailable.
    """
    # Alembic logs two lines at INFO on every start.
    logging.getLogger("alembic").setLevel(logging.WARNING)

    def work(connection: Connection) -> None:
        check_revisions(MigrationContext.configure(connection).get_current_heads())
        config = _config()
        config.attributes[CONNECTION] = connection
        command.upgrade(config, "head")

    database.write(work)


def migrate_feature(database: Database, name: str, folder: Path, tables: MetaData) -> None:
    """Upgrade the tables of a feature in one transaction, and let the database know them.

    The revision is in a table of the feature's own: one that is left out is left as it is.

    Args:
        database: with the core's schema of this version.
        name: of the feature.
        folder: with the revisions of its tables, a chain of Alembic scripts.
        tables: the tables of this version.

    Raises:
        InvalidInput: if a newer version of the feature made its tables.
        DamagedFile: if one of them is missing.
        StorageFailed: if the database is unavailable.
    """
    logging.getLogger("alembic").setLevel(logging.WARNING)

    def work(connection: Connection) -> None:
        version_table = f"{_CORE_VERSION_TABLE}_{name}"
        config = _config()
        config.set_main_option("version_locations", str(folder))
        config.attributes |= {CONNECTION: connection, VERSION_TABLE: version_table}
        options = {"version_table": version_table}
        heads = set(MigrationContext.configure(connection, opts=options).get_current_heads())
        scripts = ScriptDirectory.from_config(config).walk_revisions()
        if unknown := heads - {script.revision for script in scripts}:
            raise InvalidInput(
                f"a newer version of the feature {name} made its tables (their schema is "
                f"{', '.join(sorted(unknown))}); install that version, or leave the feature out by "
                f"HEXAPODS_WITHOUT={name}"
            )
        command.upgrade(config, "head")
        if missing := sorted(tables.tables.keys() - set(inspect(connection).get_table_names())):
            raise DamagedFile(
                f"the database has lost {', '.join(missing)} of the feature {name}; put a backup "
                f"back, or start without the feature by HEXAPODS_WITHOUT={name}, which "
                "keeps the data; what it hid may be shown then"
            )

    database.write(work)
    database.tables += tables.sorted_tables


def check_current(connection: Connection) -> bool:
    """Check that the database has this version's schema; return False if it has none yet.

    Raises:
        InvalidInput: if it has the schema of another version.
    """
    heads = MigrationContext.configure(connection).get_current_heads()
    check_revisions(heads)
    if heads and newest_revision() not in heads:
        raise InvalidInput(
            "an older version of Racing Hexapods made this database; start `hexapods serve` once, "
            "which brings it to this version"
        )
    return bool(heads)


def newest_revision() -> str:
    """Return the revision of this version's schema."""
    return str(ScriptDirectory.from_config(_config()).get_current_head())


def _config() -> Config:
    config = Config()
    config.set_main_option("script_location", SCRIPT_LOCATION)
    # Silences a deprecation warning; the setting matters to Alembic's own command only.
    config.set_main_option("path_separator", "os")
    return config


def check_revisions(revisions: Iterable[str]) -> None:
    """Check that this version can read the tables of the core with these revisions.

    Raises:
        InvalidInput: if a newer version made them, or one before 0.3.
    """
    released = {
        script.revision for script in ScriptDirectory.from_config(_config()).walk_revisions()
    }
    unknown = set(revisions) - released
    if unknown and unknown <= _BEFORE_0_3:
        raise InvalidInput(
            "a version of Racing Hexapods before 0.3 made this database (its schema is "
            f"{', '.join(sorted(unknown))}), which this version does not read; it was left as it "
            "is: open it with the version that made it, or choose another data folder or database"
        )
    if unknown:
        raise InvalidInput(
            f"a newer version of Racing Hexapods made this database (its schema is "
            f"{', '.join(sorted(unknown))}, this version knows up to {newest_revision()}); "
            "install that version, or choose another data folder or database"
        )
