"""The command `trompe analyse`."""

import json
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from algorithms.errors import InputError

if TYPE_CHECKING:
    from analysis.answers.exclusions import Who

# The report's constant, repeated so that the command line starts without matplotlib and scipy.
_DEFAULT_SEED = 1


def analyse(
    data: Annotated[
        str, typer.Argument(help="The response store (a SQLite file), or the folder of a bundle.")
    ],
    out: Annotated[Path, typer.Option(help="The folder of the report; made if missing.")],
    study: Annotated[
        str | None, typer.Option(help="The study's name, if the store holds several.")
    ] = None,
    seed: Annotated[int, typer.Option(min=0, help="Of every random draw.")] = _DEFAULT_SEED,
    simulated: Annotated[
        bool | None,
        typer.Option(
            "--simulated/--people",
            help="Whose answers; by default people's if one of them has finished.",
        ),
    ] = None,
    pilot: Annotated[bool, typer.Option("--pilot", help="Count pilot sessions too.")] = False,
    stimuli: Annotated[
        Path | None, typer.Option(help="The folder of the images; free viewing needs it.")
    ] = None,
    gaze: Annotated[
        Path | None, typer.Option(help="The folder with gaze, if it is not where it was recorded.")
    ] = None,
    check: Annotated[
        bool, typer.Option("--check", help="Only compare the report in --out with a new analysis.")
    ] = False,
    as_json: Annotated[bool, typer.Option("--json", help="Machine-readable output.")] = False,
) -> None:
    """Analyse a study: tables, figures and one report.html that opens without a network."""
    from analysis.report.page import RESULTS_NAME, Images, differences
    from analysis.report.page import analyse as write_analysis

    if check:
        if found := differences(data, out, Images(stimuli, gaze)):
            raise InputError(f"{out}: other results than before: {', '.join(found)}")
        typer.echo("the same numbers")
        return
    who: Who | None = None if simulated is None else "simulated" if simulated else "people"
    report = write_analysis(
        data, out, study, seed, who, include_pilot=pilot, stimuli=stimuli, gaze=gaze
    )
    results = json.loads((out / RESULTS_NAME).read_text(encoding="utf-8"))
    if as_json:
        typer.echo(json.dumps({"report": str(report), **results}))
        return
    for sentence in results["verdict"]:
        typer.echo(sentence)
    typer.echo(f"wrote {report}")
