"""Schema 0010: answers of what-ifs of participants of rooms."""

import sqlalchemy as sa
from alembic import op

revision = "0010"
down_revision = "0009"


def upgrade() -> None:
    """Add their column; what was kept before are runs."""
    op.add_column("room_runs", sa.Column("answer", sa.JSON(none_as_null=True)))
