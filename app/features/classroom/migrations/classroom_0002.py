"""Revision classroom_0002: lessons that were deleted stay for a while, to be restored."""

import sqlalchemy as sa
from alembic import op

revision = "classroom_0002"
down_revision = "classroom_0001"


def upgrade() -> None:
    """Add the time of a lesson's deletion."""
    op.add_column("lessons", sa.Column("deleted_at", sa.DateTime(timezone=True)))
