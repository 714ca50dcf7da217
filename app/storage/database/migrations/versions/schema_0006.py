"""Schema 0006: stored robots."""

import sqlalchemy as sa
from alembic import op

revision = "0006"
down_revision = "0005"


def upgrade() -> None:
    """Add their table; existing rows are unchanged."""
    is_postgresql = op.get_bind().dialect.name == "postgresql"
    text = sa.String(collation="C" if is_postgresql else None)
    op.create_table(
        "robots",
        sa.Column("id", text, primary_key=True),
        sa.Column("name", text, nullable=False),
        sa.Column("hidden", sa.BigInteger(), nullable=False, server_default="0"),
        sa.Column("gait", sa.JSON(none_as_null=True)),
        sa.Column("guesses", sa.JSON(), nullable=False),
        sa.Column("repairs", sa.JSON(), nullable=False),
        sa.Column("choices", sa.JSON(none_as_null=True)),
        sa.Column("file", text),
        sa.Column("created_at", sa.DateTime(timezone=True), nullable=False),
    )
