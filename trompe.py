"""The command line: each room brings its own commands, and `demo` runs the whole loop."""

import dataclasses
import json
import sys
import threading
from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import numpy as np
import typer
from rich.console import Console
from rich.table import Table

import algorithms.cli
import algorithms.edits.cli
import analysis.cli
import analysis.power_cli
import analysis.sweep_cli
import experiments.cli
import stimuli.cli
from algorithms.errors import UserError

if TYPE_CHECKING:
    from experiments.storage.store import Store
    from experiments.study import Study
    from stimuli.manifest import StimulusSet

app = typer.Typer(
    no_args_is_help=True,
    pretty_exceptions_enable=False,
    help="Does this edit fool the eye, and how wrong may an algorithm be before people notice?",
)
app.add_typer(stimuli.cli.app, name="stimuli")
app.add_typer(experiments.cli.app, name="study")
app.add_typer(algorithms.edits.cli.app, name="edit")
app.command("lights")(algorithms.cli.lights)
app.add_typer(analysis.sweep_cli.app, name="sweep")
app.command("analyse")(analysis.cli.analyse)
app.command("power")(analysis.power_cli.power)


@app.command()
def demo(
    folder: Annotated[Path, typer.Option(help="Where everything goes.")] = Path("demo"),
    participants: Annotated[int, typer.Option(min=1, help="Simulated participants.")] = 24,
    seed: Annotated[int, typer.Option(min=0, help="Fixes every random choice.")] = 2011,
    host: Annotated[str, typer.Option(help="The address to serve at.")] = "127.0.0.1",
    port: Annotated[int, typer.Option(min=0, max=65535, help="0 takes any free one.")] = 8000,
    engine: Annotated[
        str | None, typer.Option(help="cuda, llvm or scalar; without it the fastest that works.")
    ] = None,
    serve: Annotated[
        bool, typer.Option(help="Go on serving, so that you can take the study yourself.")
    ] = True,
) -> None:
    """Run the whole loop on this machine: render, serve, answer, report.

    Run again in the same folder, it goes on where it was and simulates nobody twice.
    """
    from experiments import web
    from experiments.storage.store import Store
    from experiments.study import load_study

    study = load_study("lights-synthetic")
    data = folder / "responses.sqlite"
    with web.listen(host, port):  # a port in use is said before the rendering, not after it
        _say("1. stimuli", "eight objects, one of them under another light, rendered by Mitsuba")
        stimulus_set = stimuli.cli.make_with_progress(
            "divergence", folder / "stimuli", quick=True, seed=seed, engine=engine
        )
    with Store.open(data) as store:
        application = web.create_app(study, stimulus_set, store)
        with web.running_server(application, host, port) as url:
            _say("2. answers", f"{participants} simulated participants take the study over HTTP")
            _simulate_missing(url, participants, study, stimulus_set, store, seed)
            _say("3. report", "hit rates, thresholds, salience, times")
            analysis.cli.analyse(str(data), folder / "report", simulated=True)
            if serve:
                for who, link in web.links(url, study, store).items():
                    _say(who, link)
                _say("serving", "take the study yourself; Ctrl-C ends. Then see your own answers:")
                _say("", f"{sys.argv[0]} analyse {data} --out {folder / 'my-report'}")
                threading.Event().wait()


def _simulate_missing(
    url: str,
    participants: int,
    study: "Study",
    stimulus_set: "StimulusSet",
    store: "Store",
    seed: int,
) -> None:
    """Simulate as many participants as the store lacks."""
    from experiments.simulated.observers import Observer
    from experiments.web.simulate import simulate_over_http

    observer = Observer(
        threshold={"front": 32.0, "back": 22.0, "front-back": 27.0},
        width=30.0,
        condition="placement",
        salience={label: 3.0 for label, letter in stimulus_set.objects.items() if letter == "e"},
    )
    _say("", observer.describe())
    done = [session for session in store.sessions(study=study.name) if session.simulated]
    missing = participants - sum(session.completed_at is not None for session in done)
    if missing > 0:
        generator = np.random.default_rng([seed, len(done)])
        simulate_over_http(url, missing, observer, study, stimulus_set, generator)


def _say(what: str, text: str) -> None:
    typer.echo(f"{what:12} {text}")


@app.command()
def doctor(
    as_json: Annotated[bool, typer.Option("--json", help="Machine-readable output.")] = False,
) -> None:
    """Tell what this machine can run, and how to get the rest."""
    from experiments.doctor import examine

    checks = examine()
    if as_json:
        typer.echo(json.dumps([dataclasses.asdict(check) for check in checks], indent=1))
        return
    table = Table(box=None)
    for heading in ("", "what", "found", "needed for", "to install"):
        table.add_column(heading, overflow="fold")
    for check in checks:
        mark = "[green]yes[/]" if check.works else "[yellow]no[/]"
        table.add_row(mark, check.name, check.detail, check.needed_for, check.remedy)
    Console().print(table)


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
