"""A server in a process of its own, started by the command that users type."""

import json
import signal
import subprocess
import sys
import threading
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path

from tests.web.visitor import STUDY

ROOT = Path(__file__).parents[2]
START_S = 60
_COMMAND = "from experiments.cli import app; app()"


@dataclass(frozen=True)
class Served:
    """A server in a process of its own."""

    process: subprocess.Popen[str]
    url: str


@contextmanager
def served(stimuli: Path, data: Path | str, *options: str) -> Iterator[Served]:
    """Serve the ready-made study while the block runs; the server is killed, if it still runs."""
    given = [STUDY, "--stimuli", stimuli, "--data", data, "--port", "0", "--json", *options]
    process = subprocess.Popen(
        [sys.executable, "-c", _COMMAND, "serve", *map(str, given)],
        cwd=ROOT,
        stdout=subprocess.PIPE,
        text=True,
    )
    watchdog = threading.Timer(START_S, process.kill)
    watchdog.start()
    try:
        assert process.stdout is not None
        links = json.loads(process.stdout.readline())
        yield Served(process, links["participants"].removesuffix(f"/s/{STUDY}/"))
    finally:
        watchdog.cancel()
        process.send_signal(signal.SIGKILL)
        process.communicate()
