"""Runs sittings in the lab, one after the other, as a process of its own.

pyglet wants the main thread, and PsychoPy's warnings are not ours. Each page's name goes to the
standard output, so that a test knows when to act.
"""

import json
import sys
from contextlib import ExitStack
from pathlib import Path
from typing import Any

from algorithms.errors import UserError
from experiments.lab import opening
from experiments.lab.experimenter import experimenter_window
from experiments.lab.eye_tracker import read_tracker
from experiments.lab.photodiode import Photodiode
from experiments.lab.progress import Status
from experiments.lab.runner import run_lab
from experiments.lab.triggers import load_triggers
from experiments.lab.window import WindowSettings
from experiments.storage.store import Store
from experiments.study import load_study
from stimuli.manifest import load
from tests.lab.observed import observed_window


def main() -> None:
    failed = False
    for given in json.loads(sys.argv[1]):
        try:
            print(_run(given), flush=True)  # noqa: T201
        except UserError as error:
            failed = True
            print(error, file=sys.stderr)  # noqa: T201
    sys.exit(2 if failed else 0)


def _run(given: dict[str, Any]) -> str:
    settings = given["settings"]
    if "photodiode" in settings:
        settings["photodiode"] = Photodiode(**settings["photodiode"])
    if given["observed"] is not None:
        vars(opening)["LabWindow"] = observed_window(Path(given["observed"]))
    with Store.open(given["store"]) as store, ExitStack() as opened:
        screen = given["experimenter_screen"]
        show = None if screen is None else opened.enter_context(experimenter_window(screen))

        def watch(status: Status) -> None:
            if show is not None:
                show(status)
            print(status.page, flush=True)  # noqa: T201

        session = run_lab(
            load_study(given["study"]),
            load(given["stimuli"]),
            store,
            demographics=given["demographics"],
            folder=Path(given["folder"]),
            participant=given["participant"],
            participant_number=given["participant_number"],
            settings=WindowSettings(**settings),
            triggers=load_triggers(Path(given["triggers"])) if given["triggers"] else None,
            eye_tracker=read_tracker(Path(given["tracker"])) if given["tracker"] else None,
            watch=watch,
        )
    return "completed" if session and session.completed_at else "left"


if __name__ == "__main__":
    main()
