"""Revision core_0003: stored robots that were deleted stay for a while, to be restored."""

import sqlalchemy as sa
from alembic import op

revision = "core_0003"
down_revision = "core_0002"


def upgrade() -> None:
    """Add the time of a robot's deletion."""
    op.add_column("robots", sa.Column("deleted_at", sa.DateTime(timezone=True)))
