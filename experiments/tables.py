"""The store's tables, and how a database with them is opened."""

from pathlib import Path
from sqlite3 import Connection as SqliteConnection

import sqlalchemy as sa
from sqlalchemy.engine import Connection, Engine, make_url

from algorithms.errors import InputError

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
settings = sa.Table(
    "settings",
    metadata,
    sa.Column("key", sa.String, primary_key=True),
    sa.Column("value", sa.String, nullable=False),
)


def _refuse_changes(_: sa.Table, connection: Connection, **__: object) -> None:
    """Make append-only the database's own rule, whoever writes to it."""
    for change in ("UPDATE", "DELETE"):
        connection.exec_driver_sql(
            f"CREATE TRIGGER responses_refuse_{change} BEFORE {change} ON responses"
            " BEGIN SELECT RAISE(ABORT, 'responses are never changed'); END"
        )


sa.event.listen(responses, "after_create", _refuse_changes)


def open_database(path_or_url: str | Path, *, must_exist: bool) -> Engine:
    """Open a database, making it and its tables where they do not exist.

    Parameters
    ----------
    path_or_url
        A SQLite file, or the SQLAlchemy URL of a SQLite database.
    must_exist
        Refuse to make a new one.

    Raises
    ------
    InputError
        If it does not exist, cannot be opened, or is no database.
    """
    url = _url_of(path_or_url)
    if url.get_backend_name() != "sqlite":
        raise InputError(f"store: {url.get_backend_name()!r} given, a SQLite file accepted")
    file = Path(url.database or "")
    if must_exist and not file.is_file():
        raise InputError(f"{file}: there is no response store")
    engine = sa.create_engine(url)
    sa.event.listen(engine, "connect", _on_connect)
    sa.event.listen(engine, "begin", _on_begin)
    try:
        metadata.create_all(engine)
    except sa.exc.DBAPIError as error:
        engine.dispose()
        raise InputError(f"{file}: cannot be used as a response store ({error.orig})") from None
    return engine


def _url_of(path_or_url: str | Path) -> sa.URL:
    text = str(path_or_url)
    if "://" not in text:
        return sa.URL.create("sqlite", database=text)
    try:
        return make_url(text)
    except sa.exc.ArgumentError:
        raise InputError(f"store: {text!r} is neither a file nor a database URL") from None


def _on_connect(connection: SqliteConnection, _: object) -> None:
    # The driver's own transactions would begin late; ours begin with the first statement.
    connection.isolation_level = None
    cursor = connection.cursor()
    cursor.execute("PRAGMA journal_mode=WAL")
    cursor.execute("PRAGMA synchronous=FULL")
    cursor.execute("PRAGMA foreign_keys=ON")
    cursor.execute("PRAGMA busy_timeout=20000")
    cursor.close()


def _on_begin(connection: Connection) -> None:
    # Taking the write lock at once avoids the deadlock of two readers that both want to write.
    connection.exec_driver_sql("BEGIN IMMEDIATE")
