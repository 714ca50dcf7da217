"""Revision core_0002: runs that were deleted stay for a while, to be restored."""

import sqlalchemy as sa
from alembic import op

revision = "core_0002"
down_revision = "core_0001"


def upgrade() -> None:
    """Add the time of a run's deletion."""
    op.add_column("runs", sa.Column("deleted_at", sa.DateTime(timezone=True)))
