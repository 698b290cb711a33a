"""The commands of `trompe study` for what a store holds."""

import json
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import asdict
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Literal

import typer

from algorithms.errors import InputError
from algorithms.files import write_atomically

if TYPE_CHECKING:
    from experiments.storage.store import Store

Stored = Annotated[
    str, typer.Argument(metavar="DATA", help="The response store, a SQLite file or a URL.")
]
OneStudy = Annotated[str | None, typer.Option("--study", help="If the store holds several.")]
NewFolder = Annotated[Path, typer.Argument(metavar="DIR", help="New or empty.")]
SessionId = Annotated[str, typer.Argument(metavar="SESSION", help="The id of the session.")]


def export(
    data: Stored,
    table: Annotated[
        Literal["responses", "sessions", "events"], typer.Option(help="Which of its tables.")
    ] = "responses",
    study: Annotated[str | None, typer.Option(help="Only the study of this name.")] = None,
    form: Annotated[
        Literal["csv", "json", "parquet", "psychopy", "psych-ds"],
        typer.Option(
            "--format",
            help="psychopy: one wide CSV of a study; psych-ds: a folder of a study to publish.",
        ),
    ] = "csv",
    output: Annotated[Path | None, typer.Option(help="A file instead of the terminal.")] = None,
) -> None:
    """Write the answers, sessions or events of a store as a table, or a study for others."""
    from experiments.exports.collection import load_collection
    from experiments.exports.export import csv_bytes, table_bytes
    from experiments.exports.psych_ds import wide_table, write_psych_ds
    from experiments.storage.store import Store

    if output is None and form in ("parquet", "psych-ds"):
        raise InputError(f"output: missing; --format {form} needs it")
    if output is not None and output.resolve() == Path(data).resolve():
        raise InputError(f"output: {output} is the store itself")
    if form == "psych-ds":
        assert output is not None
        typer.echo(f"wrote {write_psych_ds(load_collection(data, study), output)}")
        return
    if form == "psychopy":
        content = csv_bytes(*wide_table(load_collection(data, study)))
    else:
        with Store.open(data, must_exist=True) as store:
            content = table_bytes(store, table, study, form)
    if output is None:
        typer.echo(content.decode(), nl=False)
    else:
        write_atomically(output, content)


def bundle(data: Stored, folder: NewFolder, study: OneStudy = None) -> None:
    """Write a study with all its answers as a folder that `trompe analyse` takes anywhere."""
    from experiments.exports.collection import load_collection, write_bundle

    typer.echo(f"wrote {write_bundle(load_collection(data, study), folder)}")


def exclude(
    data: Stored,
    session: SessionId,
    reason: Annotated[str, typer.Option(help="Why; it is published with the results.")],
) -> None:
    """Leave a session out of the analysis; nothing of it is deleted."""
    from experiments.storage.participation import exclude_session
    from experiments.storage.store import Store

    with Store.open(data, must_exist=True) as store:
        exclude_session(store, session, reason)
    typer.echo(f"session {session}: excluded")


def withdraw(data: Stored, session: SessionId) -> None:
    """Erase the answers of a participant who withdraws; that there was a session stays."""
    from experiments.storage.participation import withdraw_session
    from experiments.storage.store import Store

    with Store.open(data, must_exist=True) as store:
        withdraw_session(store, session)
    typer.echo(f"session {session}: withdrawn, its answers are erased")


def pause(data: Stored, study: OneStudy = None) -> None:
    """Let nobody begin a study on the web; those who have begun go on."""
    from experiments.storage.admission import pause as pause_study

    with _study_of(data, study) as (store, name):
        pause_study(store, name)
    typer.echo(f"{name}: paused; those who have begun can finish")


def resume(data: Stored, study: OneStudy = None) -> None:
    """Let people begin a study again that was paused."""
    from experiments.storage.admission import resume as resume_study

    with _study_of(data, study) as (store, name):
        resume_study(store, name)
    typer.echo(f"{name}: open")


@contextmanager
def _study_of(data: str, study: str | None) -> "Iterator[tuple[Store, str]]":
    from experiments.exports.collection import newest_study
    from experiments.storage.store import Store

    with Store.open(data, must_exist=True) as store:
        yield store, newest_study(store, study)[0].name


def backup(
    data: Stored,
    output: Annotated[Path, typer.Argument(metavar="FILE", help="Must not be there yet.")],
) -> None:
    """Copy a SQLite store to a file while servers go on writing to it."""
    from experiments.storage.database import back_up

    back_up(data, output)
    typer.echo(f"wrote {output}")


def replay(
    data: Annotated[str, typer.Argument(metavar="DATA", help="A response store, or a bundle.")],
    session: Annotated[
        str | None, typer.Argument(metavar="SESSION", help="Its id; without it all sessions.")
    ] = None,
    study: OneStudy = None,
    as_json: Annotated[bool, typer.Option("--json", help="Machine-readable output.")] = False,
) -> None:
    """Decide every trial anew from the answers before it, and compare; exit 1 if one differs.

    Sessions of other versions of the study, and withdrawn ones, are passed over.
    """
    from experiments.exports.collection import load_collection
    from experiments.planning.replay import replay_session

    held = load_collection(data, study)
    version = (held.study.digest, held.stimuli.digest)
    replayed = [
        replay_session(held.study, held.stimuli, one, held.responses, held.events)
        for one in held.sessions
        if session in (None, one.id)
        and (one.study_digest, one.stimuli_digest) == version
        and one.withdrawn_at is None
    ]
    if not replayed:
        raise InputError(f"session: {session or 'none'} of this version of {held.study.name}")
    if as_json:
        typer.echo(json.dumps([asdict(each) for each in replayed]))
    else:
        for each in replayed:
            typer.echo(f"{each.session}  {each.trials} trials  {each.difference or 'the same'}")
    if any(each.difference is not None for each in replayed):
        raise typer.Exit(1)


COMMANDS = (export, bundle, exclude, withdraw, pause, resume, backup, replay)
