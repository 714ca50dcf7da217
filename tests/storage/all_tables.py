"""The tables of the database: those of the core, and those of all features."""

from collections.abc import Mapping

from sqlalchemy import MetaData, Table

from app.installed_features import load
from app.storage.database.schema import METADATA

ALL_METADATA: list[MetaData] = [
    METADATA,
    *(feature.tables for feature in load().classes if feature.tables is not None),
]
ALL_TABLES: Mapping[str, Table] = {
    table.name: table for metadata in ALL_METADATA for table in metadata.sorted_tables
}
"""By name, those that others need first."""
