"""The store's tables as queries see them; `migrations` beside it makes and changes them."""

import sqlalchemy as sa

metadata = sa.MetaData()
studies = sa.Table(
    "studies",
    metadata,
    sa.Column("study_digest", sa.String, primary_key=True),
    sa.Column("stimuli_digest", sa.String, primary_key=True),
    sa.Column("name", sa.String, nullable=False),
    sa.Column("study", sa.JSON, nullable=False),
    sa.Column("manifest", sa.JSON, nullable=False),
    sa.Column("registered_at", sa.String, nullable=False),
)
sessions = sa.Table(
    "sessions",
    metadata,
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
    sa.Column("withdrawn_at", sa.String),
    sa.UniqueConstraint("study", "participant_number"),
)
responses = sa.Table(
    "responses",
    metadata,
    sa.Column("id", sa.String, primary_key=True),
    sa.Column("study", sa.String, nullable=False, index=True),
    sa.Column("study_digest", sa.String, nullable=False),
    sa.Column("stimuli_digest", sa.String, nullable=False),
    sa.Column("participant", sa.String, nullable=False),
    sa.Column("session", sa.ForeignKey("sessions.id"), nullable=False),
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
events = sa.Table(
    "events",
    metadata,
    sa.Column("number", sa.Integer, primary_key=True),
    sa.Column("session", sa.ForeignKey("sessions.id"), nullable=False),
    sa.Column("kind", sa.String, nullable=False),
    sa.Column("detail", sa.JSON, nullable=False),
    sa.Column("recorded_at", sa.String, nullable=False),
)
arrivals = sa.Table(
    "arrivals",
    metadata,
    sa.Column("session", sa.ForeignKey("sessions.id"), primary_key=True),
    sa.Column("study", sa.String, nullable=False),
    sa.Column("key", sa.String, nullable=False),
    sa.Column("parameters", sa.JSON, nullable=False),
    sa.UniqueConstraint("study", "key"),
)
leases = sa.Table(
    "leases",
    metadata,
    sa.Column("session", sa.ForeignKey("sessions.id"), primary_key=True),
    sa.Column("page", sa.String, nullable=False),
    sa.Column("renewed_s", sa.Float, nullable=False),
)
settings = sa.Table(
    "settings",
    metadata,
    sa.Column("key", sa.String, primary_key=True),
    sa.Column("value", sa.String, nullable=False),
)
