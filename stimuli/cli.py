"""The commands of `trompe stimuli`."""

import json
from collections.abc import Callable, Iterator, Mapping
from contextlib import contextmanager
from pathlib import Path
from typing import Annotated, Any

import typer
from rich.console import Console
from rich.progress import BarColumn, MofNCompleteColumn, Progress, TextColumn, TimeRemainingColumn

from stimuli.manifest import StimulusSet, load

# The renderer takes seconds to import: only the command that renders does it.

app = typer.Typer(no_args_is_help=True, help="Render, list and show stimulus sets.")

Json = Annotated[bool, typer.Option("--json", help="Machine-readable output.")]


@app.command()
def make(
    name: Annotated[
        str, typer.Argument(metavar="SET", help="Its name (see `list`), or a Python file.")
    ],
    folder: Annotated[Path, typer.Argument(metavar="DIR", help="New, empty or begun before.")],
    quick: Annotated[bool, typer.Option("--quick", help="Small images, fewer of them.")] = False,
    replicates: Annotated[
        int | None, typer.Option(help="Images a cell, with other targets, where the set has them.")
    ] = None,
    photographs: Annotated[
        Path | None, typer.Option(help="The folder of photographs that `photographs` combines.")
    ] = None,
    seed: Annotated[int, typer.Option(help="Fixes every random choice.")] = 2010,
    engine: Annotated[
        str | None, typer.Option(help="cuda, llvm or scalar; without it the fastest that works.")
    ] = None,
    as_json: Json = False,
) -> None:
    """Render a stimulus set; after an interruption the same command goes on with it."""
    given = {"replicates": replicates, "photographs": photographs}
    options = {name: value for name, value in given.items() if value is not None}
    made = make_with_progress(name, folder, options, quick=quick, seed=seed, engine=engine)
    _print_summary(made, as_json)


@app.command("list")
def list_sets(as_json: Json = False) -> None:
    """List the sets that can be made."""
    from stimuli.sets import SUMMARIES

    if as_json:
        typer.echo(json.dumps(dict(SUMMARIES)))
        return
    for name, summary in SUMMARIES.items():
        typer.echo(f"{name:12}  {summary}")


@app.command()
def show(
    folder: Annotated[Path, typer.Argument(metavar="DIR", help="The set's folder.")],
    output: Annotated[Path, typer.Option(help="A PNG or JPEG file.")] = Path("contact-sheet.png"),
    columns: Annotated[int, typer.Option(help="Images side by side.")] = 6,
    width: Annotated[int, typer.Option(help="Of an image on the sheet, in pixels.")] = 320,
    as_json: Json = False,
) -> None:
    """Check a set's files and draw a contact sheet of all its images."""
    from stimuli.contact_sheet import write_contact_sheet

    stimuli = load(folder)
    stimuli.verify()
    write_contact_sheet(output, stimuli, columns, width)
    _print_summary(stimuli, as_json)
    if not as_json:
        typer.echo(f"wrote {output}")


def make_with_progress(
    name: str,
    folder: Path,
    options: Mapping[str, Any] | None = None,
    *,
    quick: bool,
    seed: int,
    engine: str | None,
) -> StimulusSet:
    """Make a set as `stimuli.sets` does, with a progress bar where there is a terminal."""
    from stimuli.sets import maker

    with progress_bar(f"stimuli {name}") as progress:
        return maker(name, options)(
            folder, seed=seed, quick=quick, engine=engine, progress=progress
        )


@contextmanager
def progress_bar(label: str) -> Iterator[Callable[[int, int], None]]:
    """Show a progress bar where there is a terminal; it is told how many of how many are done."""
    console = Console(stderr=True)
    columns = (
        TextColumn("{task.description}"),
        BarColumn(),
        MofNCompleteColumn(),
        TimeRemainingColumn(),
    )
    with Progress(*columns, console=console, disable=not console.is_terminal) as bar:
        task = bar.add_task(label, total=None)
        yield lambda done, total: bar.update(task, completed=done, total=total)


def _print_summary(stimuli: StimulusSet, as_json: bool) -> None:
    facts = {
        "set": stimuli.name,
        "folder": str(stimuli.folder),
        "main": len(stimuli.with_role("main")),
        "practice": len(stimuli.with_role("practice")),
        "engine": stimuli.engine,
        "seed": stimuli.seed,
        "digest": stimuli.digest,
    }
    if as_json:
        typer.echo(json.dumps(facts))
        return
    for name, value in facts.items():
        typer.echo(f"{name:9} {value}")
