"""The commands of `trompe study`."""

import json
import math
from collections.abc import Callable, Iterator
from contextlib import ExitStack, contextmanager
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import numpy as np
import typer
from rich.console import Console
from rich.progress import Progress

from algorithms.errors import InputError
from experiments import store_cli
from experiments.planning.course import course_of
from experiments.planning.trials import Assignment
from experiments.study import Study, check_stimuli, load_study
from experiments.template import write_template
from stimuli.manifest import StimulusSet
from stimuli.manifest import load as load_stimuli

if TYPE_CHECKING:
    from experiments.lab.progress import Status
    from experiments.simulated.simulation import AnyObserver
    from experiments.simulated.viewers import Viewer

# Servers, databases and windows are imported by the commands that need them, so that the others
# start at once.

app = typer.Typer(no_args_is_help=True, help="Write, check, run and export studies.")
for _command in store_cli.COMMANDS:
    app.command()(_command)

StudyFile = Annotated[
    str, typer.Argument(metavar="STUDY", help="A TOML file or a ready-made name.")
]
Stimuli = Annotated[Path, typer.Option(help="The folder of the stimulus set.")]
Data = Annotated[
    str,
    typer.Option(
        help="The response store: a SQLite file, made if missing, or a postgresql:// URL."
    ),
]
Host = Annotated[str, typer.Option(help="The address to serve at.")]
Port = Annotated[int, typer.Option(min=0, max=65535, help="0 takes any free one.")]
Pilot = Annotated[bool, typer.Option("--pilot", help="Flag the answers as a pilot's.")]
Json = Annotated[bool, typer.Option("--json", help="Machine-readable output.")]
# Of simulated observers; `trompe power` has them as well.
Width = Annotated[float, typer.Option(help="From 5 % to 95 % of the function.")]
LapseRate = Annotated[float, typer.Option(help="0 to 0.5.")]
Fatigue = Annotated[float, typer.Option(help="By how much the lapse rate grows over 100 trials.")]
Qualities = Annotated[
    str | None, typer.Option(help="In comparisons, of each item in JOD: a=0,b=1.5.")
]
Spread = Annotated[float, typer.Option(help="Of participants' qualities, in JOD.")]
PositionBias = Annotated[float, typer.Option(help="Of the first place, in JOD.")]


@app.command()
def new(
    name: Annotated[str, typer.Argument(help="Lower-case letters, digits, hyphens.")],
    folder: Annotated[Path, typer.Option(help="Where the file goes.")] = Path(),
) -> None:
    """Write a commented study file to begin with."""
    typer.echo(f"wrote {write_template(name, folder)}")


@app.command()
def check(
    study: StudyFile,
    stimuli: Annotated[Path | None, typer.Option(help="A stimulus set to check it with.")] = None,
    as_json: Json = False,
) -> None:
    """Check a study file, and whether it can run with a stimulus set."""
    loaded = load_study(study)
    facts: dict[str, Any] = {
        "study": loaded.name,
        "version": loaded.version,
        "task": loaded.task,
        "chance": None if math.isnan(loaded.guess_rate) else loaded.guess_rate,
        "digest": loaded.digest,
    }
    if stimuli is not None:
        course = course_of(loaded, _verified(loaded, stimuli), Assignment(1))
        caught = 0 if loaded.catch is None else loaded.catch.trials
        main = "main_trials_at_most" if loaded.design.is_adaptive else "main_trials"
        facts["practice_trials"] = course.practice
        facts[main] = course.limit - course.practice - caught
        if loaded.catch is not None:
            facts["catch_trials"] = caught
    _print_facts(facts, as_json)


@app.command()
def serve(
    studies: Annotated[
        list[str], typer.Argument(metavar="STUDY...", help="TOML files or ready-made names.")
    ],
    stimuli: Annotated[
        list[Path],
        typer.Option(help="The folder of the stimulus set; once for each study, in their order."),
    ],
    data: Data,
    host: Host = "127.0.0.1",
    port: Port = 8000,
    workers: Annotated[
        int, typer.Option(min=1, max=64, help="Processes; several need PostgreSQL.")
    ] = 1,
    public_url: Annotated[
        str | None, typer.Option(help="What participants' browsers call the server, for the links.")
    ] = None,
    pilot: Pilot = False,
    as_json: Json = False,
) -> None:
    """Serve one or more studies to browsers until interrupted, and print the links to them."""
    from experiments import web
    from experiments.storage.store import Store
    from experiments.web.workers import Worker, check_workers, serve_workers

    served = _with_stimuli(studies, stimuli)
    with web.listen(host, port) as listener:
        with Store.open(data) as store:
            check_workers(workers, store)
            application = web.create_site(served, store, pilot=pilot)
            url = (public_url or web.base_url(listener)).rstrip("/")
            for study, _ in served:
                # Each says whose it is where there are several.
                name = {"study": study.name} if len(served) > 1 else {}
                _print_facts({**name, **web.links(url, study, store)}, as_json)
            if workers == 1:
                web.serve(application, listener)
        if workers > 1:
            serve_workers(Worker(tuple(served), data, pilot), listener, workers)


@app.command()
def simulate(
    study: StudyFile,
    stimuli: Stimuli,
    url: Annotated[str | None, typer.Option(help="Of a server that serves the study.")] = None,
    data: Annotated[
        str | None, typer.Option(help="Without --url: serve into this store for the while.")
    ] = None,
    participants: Annotated[int, typer.Option(min=1)] = 24,
    threshold: Annotated[
        str, typer.Option(help="25, or one for each condition: front=20,back=30.")
    ] = "25",
    condition: Annotated[
        str | None, typer.Option(help="The factor that the thresholds are for.")
    ] = None,
    width: Width = 30.0,
    lapse_rate: LapseRate = 0.02,
    salience: Annotated[
        str | None, typer.Option(help="How much labels draw guesses, 5=3,2=2; the others have 1.")
    ] = None,
    qualities: Qualities = None,
    spread: Spread = 0.0,
    position_bias: PositionBias = 0.0,
    fatigue: Fatigue = 0.0,
    in_process: Annotated[
        bool, typer.Option("--in-process", help="Into the store without a server: faster.")
    ] = False,
    repeat: Annotated[
        int,
        typer.Option(min=1, help="Independent runs, each into a store and with a seed of its own."),
    ] = 1,
    attraction: Annotated[
        float, typer.Option(help="In free viewing, how much more the right objects are looked at.")
    ] = 1.0,
    folder: Annotated[Path, typer.Option(help="In free viewing, where gaze goes.")] = Path("lab"),
    seed: Annotated[int, typer.Option(min=0, help="Fixes every random choice.")] = 2011,
    concurrency: Annotated[int, typer.Option(min=1, help="How many at the same time.")] = 4,
    as_json: Json = False,
) -> None:
    """Let simulated observers take a study, through the real web interface or in process.

    Run n of --repeat goes to the store of that name with -n, and has the seed plus n - 1.
    """
    from experiments.simulated.observer_options import observer_of
    from experiments.simulated.viewers import Viewer

    loaded = load_study(study)
    stimulus_set = _verified(loaded, stimuli)
    if (in_process or repeat > 1) and (data is None or url is not None):
        raise InputError("data: needed, and no --url, for --in-process and --repeat")
    if loaded.task == "free-viewing":
        if data is None or url is not None:
            raise InputError("data: free-viewing is simulated into a store (--data)")
        if repeat > 1:
            raise InputError(f"repeat: {repeat} given, 1 accepted for free-viewing")
        viewed = _simulate_viewing(
            loaded, stimulus_set, Viewer(attraction), participants, data, folder, seed
        )
        _print_facts({"simulated_sessions": viewed, "seed": seed}, as_json)
        return
    observer = observer_of(
        loaded,
        threshold=threshold,
        condition=condition,
        width=width,
        salience=salience,
        qualities=qualities,
        spread=spread,
        position_bias=position_bias,
        lapse_rate=lapse_rate,
        fatigue=fatigue,
    )
    runs = _runs(data, repeat)
    sessions: list[str] = []
    with _progress(participants * repeat) as bar:
        for number, store in enumerate(runs):
            simulation = _Simulation(
                loaded,
                stimulus_set,
                observer,
                participants,
                np.random.default_rng(seed + number),
                concurrency,
                lambda _: bar.advance(bar.task_ids[0]),
            )
            if in_process and store is not None:
                sessions += simulation.in_process(store)
            else:
                sessions += simulation.over_http(url, store)
    facts: dict[str, Any] = {"simulated_sessions": len(sessions), "seed": seed}
    if repeat > 1:
        facts["stores"] = [str(store) for store in runs]
    _print_facts(facts, as_json)


@app.command("run-lab")
def run_lab(
    study: StudyFile,
    stimuli: Stimuli,
    data: Data,
    participant: Annotated[
        str | None, typer.Option(help="Who; an unfinished session is taken up again.")
    ] = None,
    participant_number: Annotated[
        int | None, typer.Option(min=1, help="Fixes the order; without it the next one.")
    ] = None,
    age: Annotated[int | None, typer.Option(help="In years.")] = None,
    gender: Annotated[str | None, typer.Option(help="female, male, other or undisclosed.")] = None,
    artistic_background: Annotated[
        bool | None, typer.Option("--artistic-background/--no-artistic-background")
    ] = None,
    folder: Annotated[Path, typer.Option(help="Where PsychoPy's own files go.")] = Path("lab"),
    window: Annotated[
        tuple[int, int] | None, typer.Option(help="Width and height in px; else the full screen.")
    ] = None,
    screen: Annotated[int, typer.Option(min=0, help="Which screen.")] = 0,
    monitor: Annotated[str | None, typer.Option(help="Its name in PsychoPy.")] = None,
    photodiode: Annotated[
        str | None,
        typer.Option(help="A square that is white with a stimulus: its corner, such as top-left."),
    ] = None,
    photodiode_size: Annotated[int, typer.Option(min=1, help="Its side in px.")] = 40,
    triggers: Annotated[
        Path | None, typer.Option(help="A TOML file of trigger codes and their port.")
    ] = None,
    eye_tracker: Annotated[
        Path | None, typer.Option(help="A TOML file with ioHub's settings of an eye tracker.")
    ] = None,
    experimenter_screen: Annotated[
        int | None, typer.Option(min=0, help="Show there how far the participant is.")
    ] = None,
    pilot: Pilot = False,
) -> None:
    """Run a study with one participant in a PsychoPy window on this machine.

    Without --age, --gender and --artistic-background a form in the window asks who takes part.
    """
    from experiments.lab import runner
    from experiments.lab.eye_tracker import read_tracker
    from experiments.lab.photodiode import Photodiode
    from experiments.lab.triggers import load_triggers
    from experiments.lab.window import WindowSettings
    from experiments.storage.store import Store

    if experimenter_screen == screen and window is None:
        raise InputError(f"experimenter_screen: {screen} given, another one than --screen accepted")
    loaded = load_study(study)
    stimulus_set = _verified(loaded, stimuli)
    options = {"age": age, "gender": gender, "artistic_background": artistic_background}
    square = Photodiode(photodiode, photodiode_size) if photodiode else None
    said = {key: value for key, value in options.items() if value is not None}
    with Store.open(data) as store, _watching(experimenter_screen) as watch:
        session = runner.run_lab(
            loaded,
            stimulus_set,
            store,
            demographics=said or None,
            folder=folder,
            participant=participant,
            participant_number=participant_number,
            pilot=pilot,
            settings=WindowSettings(window is None, window, screen, monitor, square),
            triggers=load_triggers(triggers) if triggers else None,
            eye_tracker=read_tracker(eye_tracker) if eye_tracker else None,
            watch=watch,
        )
    if session is None:
        typer.echo("nobody agreed to take part, nothing stored")
    else:
        ended = (
            "left early; the same command goes on" if session.completed_at is None else "completed"
        )
        typer.echo(f"session {session.id}: {ended}")


@contextmanager
def _watching(screen: int | None) -> Iterator[Callable[["Status"], None]]:
    """Yield what prints how far a sitting in the lab is, and shows it on that screen, too."""
    from experiments.lab.experimenter import experimenter_window

    with ExitStack() as opened:
        show = None if screen is None else opened.enter_context(experimenter_window(screen))

        def watch(status: "Status") -> None:
            typer.echo(" | ".join(status.lines()))
            if show is not None:
                show(status)

        yield watch


@dataclass(frozen=True)
class _Simulation:
    """Simulated observers who take a study."""

    study: Study
    stimuli: StimulusSet
    observer: "AnyObserver"
    participants: int
    generator: np.random.Generator
    concurrency: int
    on_completed: Callable[[str], None]

    def over_http(self, url: str | None, data: str | None) -> list[str]:
        """Take it through a server, or one that fills a store meanwhile; return the sessions."""
        from experiments.web.simulate import simulate_over_http

        with _server_for(url, data, self.study, self.stimuli) as address:
            return simulate_over_http(
                address,
                self.participants,
                self.observer,
                self.study,
                self.stimuli,
                self.generator,
                concurrency=self.concurrency,
                on_completed=self.on_completed,
            )

    def in_process(self, data: str) -> list[str]:
        """Take it without a server; return the sessions."""
        from experiments.simulated.simulation import simulate_in_process
        from experiments.storage.store import Store

        with Store.open(data) as store:
            sessions = simulate_in_process(
                self.study,
                self.stimuli,
                store,
                self.observer,
                self.participants,
                self.generator,
                self.on_completed,
            )
        return [session.id for session in sessions]


def _runs(data: str | None, repeat: int) -> list[str | None]:
    """Return the store of each run."""
    if repeat == 1 or data is None:
        return [data]
    if "://" in data:
        raise InputError("data: a SQLite file accepted with --repeat, one is made for each run")
    path, digits = Path(data), len(str(repeat))
    runs = [path.with_stem(f"{path.stem}-{run:0{digits}d}") for run in range(1, repeat + 1)]
    taken = next((run for run in runs if run.exists()), None)
    if taken is not None:
        raise InputError(f"data: {taken} is already there; the runs are to be independent")
    return [str(run) for run in runs]


def _with_stimuli(studies: list[str], folders: list[Path]) -> list[tuple[Study, StimulusSet]]:
    """Load studies, each with the set at its place, or with the only one."""
    if len(folders) not in (1, len(studies)):
        raise InputError(
            f"stimuli: given {len(folders)} times for {len(studies)} studies; once for each"
            " accepted, or once for all"
        )
    each = folders * len(studies) if len(folders) == 1 else folders
    loaded = [load_study(study) for study in studies]
    return [(study, _verified(study, folder)) for study, folder in zip(loaded, each, strict=True)]


def _simulate_viewing(
    study: Study,
    stimuli: StimulusSet,
    viewer: "Viewer",
    participants: int,
    data: str,
    folder: Path,
    seed: int,
) -> int:
    from experiments.simulated.viewers import simulate_viewing
    from experiments.storage.store import Store

    generator = np.random.default_rng(seed)
    with Store.open(data) as store:
        return len(simulate_viewing(study, stimuli, store, viewer, participants, generator, folder))


def _verified(study: Study, folder: Path) -> StimulusSet:
    """Load a stimulus set that fits a study and whose files are what they were made to be."""
    try:
        stimuli = load_stimuli(folder)
        check_stimuli(study, stimuli)
    except InputError as error:
        if not study.stimuli.made_by:
            raise
        made_by = study.stimuli.made_by
        raise InputError(f"{error}; the images of {study.name} are made by: {made_by}") from error
    stimuli.verify()
    return stimuli


def _print_facts(facts: dict[str, Any], as_json: bool) -> None:
    if as_json:
        typer.echo(json.dumps(facts))
        return
    width = max(len(name) for name in facts)
    for name, value in facts.items():
        typer.echo(f"{name.replace('_', ' '):{width}}  {value}")


@contextmanager
def _server_for(
    url: str | None, data: str | None, study: Study, stimuli: StimulusSet
) -> Iterator[str]:
    """Yield the given URL, or that of a server that fills the given store meanwhile."""
    if url is not None and data is None:
        yield url
    elif data is not None and url is None:
        from experiments import web
        from experiments.storage.store import Store

        with (
            Store.open(data) as store,
            web.running_server(web.create_app(study, stimuli, store)) as address,
        ):
            yield address
    else:
        raise InputError("url, data: one of --url and --data is needed, not both")


@contextmanager
def _progress(total: int) -> Iterator[Progress]:
    console = Console(stderr=True)
    with Progress(console=console, transient=True, disable=not console.is_terminal) as bar:
        bar.add_task("simulated participants", total=total)
        yield bar
