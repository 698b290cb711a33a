"""Opening the database of a response store: SQLite or PostgreSQL, made or brought up to date."""

import sqlite3
import tempfile
from contextlib import closing
from pathlib import Path
from typing import Final

import sqlalchemy as sa
from sqlalchemy.engine import Connection, Engine, make_url

from algorithms.errors import InputError
from algorithms.files import make_folder

SCHEMA: Final = "3"
"""The newest revision in `experiments.storage.migrations`."""

_ACCEPTED = "a SQLite file or a postgresql:// URL accepted"
# Any number will do that nobody else takes in this database.
_WRITER_LOCK = sa.text("SELECT pg_advisory_xact_lock(1953656173)")


def open_database(path_or_url: str | Path, *, must_exist: bool) -> Engine:
    """Open a store's database; an empty one is filled, one of an older schema brought up to date.

    Parameters
    ----------
    path_or_url
        A SQLite file, or the SQLAlchemy URL of a SQLite or PostgreSQL database. A SQLite file is
        made where it does not exist; a PostgreSQL database must be there, if only empty.
    must_exist
        Refuse to make a new store.

    Raises
    ------
    InputError
        If it does not exist, cannot be opened, is no database, or is of a newer schema.
    """
    url = _url_of(path_or_url)
    shown = url.database if is_sqlite(url) else url.render_as_string(hide_password=True)
    if must_exist and is_sqlite(url) and not Path(url.database or "").is_file():
        raise InputError(f"{shown}: there is no response store")
    engine = _engine(url)
    try:
        _bring_up(engine, str(shown), must_exist=must_exist)
    except sa.exc.DBAPIError as error:
        engine.dispose()
        reason = str(error.orig).splitlines()[0]
        raise InputError(f"{shown}: cannot be used as a response store ({reason})") from None
    except InputError:
        engine.dispose()
        raise
    return engine


def is_sqlite(url: sa.URL) -> bool:
    """Return whether a database is a SQLite file."""
    return url.get_backend_name() == "sqlite"


def reading(engine: Engine) -> Engine:
    """Return the same database for transactions that only read: they wait for no writer."""
    return engine.execution_options(reading=True)


def take_turns(connection: Connection) -> None:
    """Let what one transaction reads and then writes be the work of no other one meanwhile.

    SQLite's transactions that write take turns as they are; PostgreSQL's do where they ask.
    """
    if connection.dialect.name == "postgresql":
        connection.execute(_WRITER_LOCK)


def back_up(path_or_url: str | Path, copy: Path) -> None:
    """Copy a SQLite store to a file, as it is at one moment, while others go on writing to it.

    Parameters
    ----------
    path_or_url
        The store.
    copy
        Where the copy goes; it appears there only once it is whole.

    Raises
    ------
    InputError
        If the store is not a SQLite file that is there, or the copy is already there or cannot be
        written.
    """
    url = _url_of(path_or_url)
    if not is_sqlite(url):
        raise InputError("store: a SQLite file accepted; PostgreSQL has pg_dump for this")
    if copy.exists():
        raise InputError(f"{copy}: is already there")
    open_database(path_or_url, must_exist=True).dispose()
    with tempfile.TemporaryDirectory(dir=make_folder(copy.parent), prefix=".backup-") as folder:
        whole = Path(folder) / "copy"
        with (
            closing(sqlite3.connect(url.database or "")) as source,
            closing(sqlite3.connect(whole)) as target,
        ):
            source.backup(target)
            target.execute("PRAGMA journal_mode=DELETE")  # one file, nothing beside it
        whole.replace(copy)


def _url_of(path_or_url: str | Path) -> sa.URL:
    text = str(path_or_url)
    if "://" not in text:
        return sa.URL.create("sqlite", database=text)
    try:
        url = make_url(text)
    except (sa.exc.ArgumentError, ValueError):
        raise InputError(f"store: {text!r} is neither a file nor a database URL") from None
    name = url.get_backend_name()
    if name not in ("sqlite", "postgresql"):
        raise InputError(f"store: {name!r} given, {_ACCEPTED}")
    return url if is_sqlite(url) else url.set(drivername="postgresql+psycopg")


def _engine(url: sa.URL) -> Engine:
    if is_sqlite(url):
        engine = sa.create_engine(url)
        sa.event.listen(engine, "connect", _on_sqlite_connect)
        sa.event.listen(engine, "begin", _on_sqlite_begin)
        return engine
    # Whatever the server's settings say, a commit returns when it is on the disk.
    durable = {"options": "-c synchronous_commit=on", "application_name": "trompe"}
    return sa.create_engine(url, pool_pre_ping=True, connect_args=durable)


def _on_sqlite_connect(connection: sqlite3.Connection, _: object) -> None:
    # The driver's own transactions would begin late; ours begin with the first statement.
    connection.isolation_level = None
    cursor = connection.cursor()
    cursor.execute("PRAGMA journal_mode=WAL")
    cursor.execute("PRAGMA synchronous=FULL")
    cursor.execute("PRAGMA foreign_keys=ON")
    cursor.execute("PRAGMA busy_timeout=20000")
    # Answers that are erased because someone withdrew leave no bytes in free pages.
    cursor.execute("PRAGMA secure_delete=ON")
    cursor.close()


def _on_sqlite_begin(connection: Connection) -> None:
    # Taking the write lock at once avoids the deadlock of two readers that both want to write.
    only_reads = connection.get_execution_options().get("reading", False)
    connection.exec_driver_sql("BEGIN" if only_reads else "BEGIN IMMEDIATE")


def _bring_up(engine: Engine, shown: str, *, must_exist: bool) -> None:
    with reading(engine).begin() as connection:
        found = _schema_of(connection)
    if found == SCHEMA:
        return
    if found is None and must_exist:
        raise InputError(f"{shown}: there is no response store")
    with engine.begin() as connection:
        take_turns(connection)
        found = _schema_of(connection)  # another process may have been faster
        if found not in (None, *map(str, range(1, int(SCHEMA) + 1))):
            raise InputError(
                f"{shown}: a store of schema {found}, this Trompe reads up to {SCHEMA};"
                " a newer Trompe reads it"
            )
        _migrate(connection, found)


def _schema_of(connection: Connection) -> str | None:
    """Return the revision of a store's schema, or None where there is no store."""
    tables = sa.inspect(connection).get_table_names()
    if "alembic_version" in tables:
        return str(connection.exec_driver_sql("SELECT version_num FROM alembic_version").scalar())
    if "settings" not in tables:
        return None
    # Stores of the first schema have its number among the settings.
    query = "SELECT value FROM settings WHERE key = 'schema'"
    return str(connection.exec_driver_sql(query).scalar() or "1")


def _migrate(connection: Connection, found: str | None) -> None:
    # Imported only where something is to be done.
    from alembic import command
    from alembic.config import Config

    config = Config()
    config.set_main_option("script_location", "experiments.storage:migrations")
    config.attributes["connection"] = connection
    if found == "1":
        command.stamp(config, found)
    command.upgrade(config, SCHEMA)
