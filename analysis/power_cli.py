"""The command `trompe power`."""

import json
from dataclasses import asdict
from pathlib import Path
from typing import Annotated

import typer

from algorithms.errors import InputError
from experiments.cli import (
    Fatigue,
    Json,
    LapseRate,
    PositionBias,
    Qualities,
    Spread,
    Stimuli,
    StudyFile,
    Width,
)
from stimuli.cli import progress_bar


def power(
    study: StudyFile,
    stimuli: Stimuli,
    between: Annotated[
        str, typer.Option(help="Two values of the condition, or two items: front,back.")
    ],
    out: Annotated[Path, typer.Option(help="The folder of table and figure; made if missing.")],
    participants: Annotated[str, typer.Option(help="How many, each 2 or more.")] = "6,12,24",
    runs: Annotated[int, typer.Option(min=1, help="How often the study is simulated.")] = 100,
    wanted: Annotated[float, typer.Option(min=0, max=1, help="The power that is enough.")] = 0.8,
    alpha: Annotated[float, typer.Option(help="The significance.")] = 0.05,
    threshold: Annotated[
        str, typer.Option(help="25, or one for each value of the condition: front=20,back=30.")
    ] = "25",
    condition: Annotated[
        str | None, typer.Option(help="The factor that thresholds are for, and compared by.")
    ] = None,
    width: Width = 30.0,
    lapse_rate: LapseRate = 0.02,
    fatigue: Fatigue = 0.0,
    qualities: Qualities = None,
    spread: Spread = 0.0,
    position_bias: PositionBias = 0.0,
    seed: Annotated[int, typer.Option(min=0, help="Of every random choice.")] = 2011,
    as_json: Json = False,
) -> None:
    """Simulate a study many times, and tell how many participants it takes to find a difference."""
    import numpy as np

    from algorithms.files import make_folder, write_atomically
    from analysis.figures.power import power_figure
    from analysis.figures.style import figure_bytes
    from analysis.power import power_curve
    from analysis.study_power import study_run
    from experiments.simulated.observer_options import observer_of
    from experiments.study import check_stimuli, load_study
    from stimuli.manifest import load

    loaded, stimulus_set = load_study(study), load(stimuli)
    check_stimuli(loaded, stimulus_set)
    observer = observer_of(
        loaded,
        threshold=threshold,
        condition=condition if "=" in threshold else None,
        width=width,
        salience=None,
        qualities=qualities,
        spread=spread,
        position_bias=position_bias,
        lapse_rate=lapse_rate,
        fatigue=fatigue,
    )
    run, quantity, test = study_run(loaded, stimulus_set, observer, _two(between), condition)
    with progress_bar("simulated studies") as progress:
        curve = power_curve(
            run,
            _numbers(participants),
            runs,
            np.random.default_rng(seed),
            quantity=quantity,
            test=test,
            alpha=alpha,
            on_run=progress,
        )
    folder, table = make_folder(out), curve.to_frame()
    write_atomically(folder / "power.csv", table.to_csv(index=False).encode())
    for form in ("svg", "png"):
        write_atomically(folder / f"power.{form}", figure_bytes(power_figure(curve, wanted), form))
    if as_json:
        typer.echo(json.dumps({**asdict(curve), "needed": curve.needed(wanted)}))
        return
    typer.echo(table[["participants", "power", "power_low", "power_high"]].to_string(index=False))
    typer.echo(f"Simulated observers, not people: {curve.quantity}; {curve.test}.")
    needed = curve.needed(wanted)
    enough = "none of these is enough" if needed is None else f"{needed} participants are enough"
    typer.echo(f"For a power of {wanted:.0%}: {enough}. Wrote {folder / 'power.csv'}")


def _two(text: str) -> tuple[str, str]:
    parts = [part.strip() for part in text.split(",")]
    if len(parts) != 2:
        raise InputError(f"between: {text!r} given, two values with a comma accepted")
    return parts[0], parts[1]


def _numbers(text: str) -> list[int]:
    try:
        return [int(part) for part in text.split(",")]
    except ValueError:
        raise InputError(f"participants: {text!r} given, whole numbers accepted") from None
