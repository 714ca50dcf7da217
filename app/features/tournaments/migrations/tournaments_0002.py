"""Revision tournaments_0002: tournaments that were deleted stay for a while, to be restored."""

import sqlalchemy as sa
from alembic import op

revision = "tournaments_0002"
down_revision = "tournaments_0001"


def upgrade() -> None:
    """Add the time of a tournament's deletion."""
    op.add_column("tournaments", sa.Column("deleted_at", sa.DateTime(timezone=True)))
