"""The web: how a participant came, and which page has the session open."""

import sqlalchemy as sa
from alembic import op

revision = "3"
down_revision = "2"


def upgrade() -> None:
    """Add the tables of arrivals and leases."""
    op.create_table(
        "arrivals",
        sa.Column("session", sa.String, sa.ForeignKey("sessions.id"), primary_key=True),
        sa.Column("study", sa.String, nullable=False),
        sa.Column("key", sa.String, nullable=False),
        sa.Column("parameters", sa.JSON, nullable=False),
        sa.UniqueConstraint("study", "key"),
    )
    op.create_table(
        "leases",
        sa.Column("session", sa.String, sa.ForeignKey("sessions.id"), primary_key=True),
        sa.Column("page", sa.String, nullable=False),
        sa.Column("renewed_s", sa.Float, nullable=False),
    )
