"""The command line: each room brings its own commands, and `demo` runs the whole loop."""

import sys
from collections.abc import Sequence
from pathlib import Path
from typing import Annotated

import typer

import analysis.cli
import experiments.cli
import stimuli.cli
from algorithms.errors import UserError

app = typer.Typer(
    no_args_is_help=True,
    pretty_exceptions_enable=False,
    help="Does this edit fool the eye, and how wrong may an algorithm be before people notice?",
)
app.add_typer(stimuli.cli.app, name="stimuli")
app.add_typer(experiments.cli.app, name="study")
app.command("analyse")(analysis.cli.analyse)
app.command("doctor")(experiments.cli.doctor)


@app.command()
def demo(
    folder: Annotated[Path, typer.Option(help="Where everything goes.")] = Path("demo"),
    participants: Annotated[int, typer.Option(min=1, help="Simulated participants.")] = 24,
    seed: Annotated[int, typer.Option(min=0, help="Fixes every random choice.")] = 2011,
    port: Annotated[int, typer.Option(min=0, max=65535, help="0 takes any free one.")] = 8000,
    engine: Annotated[
        str | None, typer.Option(help="llvm, cuda or scalar; the fastest one that works if not given.")
    ] = None,
    serve: Annotated[
        bool, typer.Option(help="Go on serving, so that you can take the study yourself.")
    ] = True,
) -> None:
    """Run the whole loop on this machine: render, serve, answer, report."""
    from analysis.demo import run_demo  # imports every library that there is

    run_demo(
        folder, participants=participants, seed=seed, port=port, engine=engine, keep_serving=serve
    )


def main(arguments: Sequence[str] | None = None) -> None:
    """Run the command line; an expected error is one line on stderr and exit status 2."""
    try:
        app(args=arguments)
    except UserError as error:
        print(f"trompe: {error}", file=sys.stderr)  # noqa: T201  # this is the command line
        sys.exit(2)
    except KeyboardInterrupt:
        sys.exit(130)


if __name__ == "__main__":
    main()
