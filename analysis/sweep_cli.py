"""The command `trompe sweep`."""

from itertools import product
from pathlib import Path
from typing import Annotated

import typer

from stimuli.cli import progress_bar

app = typer.Typer(no_args_is_help=True, help="Sweep an algorithm's error over hard conditions.")


@app.callback()
def _subjects() -> None:
    """Keep the subject a word of its own, although there is one."""


@app.command()
def lights(
    folder: Annotated[Path, typer.Argument(metavar="SET", help="A set of light probes.")],
    out: Annotated[Path, typer.Option(help="The folder of tables and figure; made if missing.")],
    seed: Annotated[int, typer.Option(min=0, help="Of the noise.")] = 2010,
    as_json: Annotated[bool, typer.Option("--json", help="Machine-readable output.")] = False,
) -> None:
    """Sweep light detection over a set of `trompe stimuli make lightprobes`."""
    import numpy as np

    from algorithms.files import make_folder, write_atomically
    from analysis.figures.light_errors import light_error_figure
    from analysis.figures.printed_lights import printed_lights_figure
    from analysis.figures.style import figure_bytes
    from analysis.light_tables import means, table_3_1, table_3_2
    from analysis.printed_lights import compare_with_printed
    from analysis.sweeps import FACTORS, long_table, sweep_lights
    from stimuli.manifest import load

    stimuli, out = load(folder), make_folder(out)
    with progress_bar("sweep lights") as progress:
        rows = sweep_lights(stimuli, np.random.default_rng(seed), progress=progress)
    summary = long_table(rows, FACTORS)
    printed = compare_with_printed(stimuli)
    tables = {"table-3-1": table_3_1(stimuli), "table-3-2": table_3_2(stimuli)}
    every_table = {"errors": rows, "summary": summary, "printed": printed, **tables}
    for name, table in every_table.items():
        write_atomically(out / f"{name}.csv", table.to_csv(index=False).encode())
    figures = {
        "light-errors": light_error_figure(summary),
        "printed-lights": printed_lights_figure(printed),
    }
    for (name, figure), kind in product(figures.items(), ("svg", "png")):
        write_atomically(out / f"{name}.{kind}", figure_bytes(figure, kind))
    if as_json:
        typer.echo(summary.to_json(orient="records"))
        return
    for name, table in tables.items():
        typer.echo(f"{name}: means, ours beside the published ones")
        typer.echo(means(table).round(1).to_string())
    levels = summary["level"].map("{:.3g}".format)
    typer.echo(summary.round(1).assign(level=levels).to_string(index=False))
    typer.echo(f"wrote {out}")
