"""Studies, sessions, responses, events and settings."""

import sqlalchemy as sa
from alembic import op

revision = "1"
down_revision = None


def upgrade() -> None:
    """Make the tables; SQLite's own rule keeps answers as they are."""
    _make_studies_and_settings()
    _make_sessions()
    _make_responses()
    op.create_table(
        "events",
        sa.Column("number", sa.Integer, primary_key=True),
        sa.Column("session", sa.String, sa.ForeignKey("sessions.id"), nullable=False),
        sa.Column("kind", sa.String, nullable=False),
        sa.Column("detail", sa.JSON, nullable=False),
        sa.Column("recorded_at", sa.String, nullable=False),
    )
    if op.get_context().dialect.name == "sqlite":
        for change in ("UPDATE", "DELETE"):
            op.execute(
                f"CREATE TRIGGER responses_refuse_{change} BEFORE {change} ON responses"
                " BEGIN SELECT RAISE(ABORT, 'responses are never changed'); END"
            )


def _make_studies_and_settings() -> None:
    op.create_table(
        "studies",
        sa.Column("study_digest", sa.String, primary_key=True),
        sa.Column("stimuli_digest", sa.String, primary_key=True),
        sa.Column("name", sa.String, nullable=False),
        sa.Column("study", sa.JSON, nullable=False),
        sa.Column("manifest", sa.JSON, nullable=False),
        sa.Column("registered_at", sa.String, nullable=False),
    )
    op.create_table(
        "settings",
        sa.Column("key", sa.String, primary_key=True),
        sa.Column("value", sa.String, nullable=False),
    )


def _make_sessions() -> None:
    op.create_table(
        "sessions",
        sa.Column("id", sa.String, primary_key=True),
        sa.Column("study", sa.String, nullable=False, index=True),
        sa.Column("study_digest", sa.String, nullable=False),
        sa.Column("stimuli_digest", sa.String, nullable=False),
        sa.Column("participant", sa.String, nullable=False),
        sa.Column("participant_number", sa.Integer, nullable=False),
        sa.Column("consent_version", sa.String, nullable=False),
        sa.Column("demographics", sa.JSON, nullable=False),
        sa.Column("screen", sa.JSON, nullable=False),
        sa.Column("device", sa.String, nullable=False),
        sa.Column("runner", sa.String, nullable=False),
        sa.Column("simulated", sa.Boolean, nullable=False),
        sa.Column("pilot", sa.Boolean, nullable=False),
        sa.Column("started_at", sa.String, nullable=False),
        sa.Column("completed_at", sa.String),
        sa.Column("completion_code", sa.String),
        sa.Column("token_sha256", sa.String, nullable=False),
        sa.UniqueConstraint("study", "participant_number"),
    )


def _make_responses() -> None:
    op.create_table(
        "responses",
        sa.Column("id", sa.String, primary_key=True),
        sa.Column("study", sa.String, nullable=False, index=True),
        sa.Column("study_digest", sa.String, nullable=False),
        sa.Column("stimuli_digest", sa.String, nullable=False),
        sa.Column("participant", sa.String, nullable=False),
        sa.Column("session", sa.String, sa.ForeignKey("sessions.id"), nullable=False),
        sa.Column("trial_index", sa.Integer, nullable=False),
        sa.Column("phase", sa.String, nullable=False),
        sa.Column("stimuli", sa.JSON, nullable=False),
        sa.Column("answer", sa.JSON(none_as_null=True)),
        sa.Column("reaction_time_s", sa.Float),
        sa.Column("onset_requested_s", sa.Float),
        sa.Column("onset_measured_s", sa.Float),
        sa.Column("frame_interval_s", sa.Float),
        sa.Column("dropped_frames", sa.Integer),
        sa.Column("input", sa.String, nullable=False),
        sa.Column("device", sa.String, nullable=False),
        sa.Column("runner", sa.String, nullable=False),
        sa.Column("simulated", sa.Boolean, nullable=False),
        sa.Column("pilot", sa.Boolean, nullable=False),
        sa.Column("recorded_at", sa.String, nullable=False),
        sa.UniqueConstraint("session", "trial_index"),
    )
