"""Several server processes with one PostgreSQL store."""

import os
import signal
import socket
import time
from pathlib import Path
from urllib.parse import urlsplit

import httpx
import pytest
from typer.testing import CliRunner

from experiments.cli import app
from experiments.storage.store import Store
from stimuli.manifest import StimulusSet
from tests.web.serving import served
from tests.web.visitor import STUDY, Visitor

SOON_S = 20


def children(process: int) -> set[int]:
    """Return the processes that a server has started."""
    path = Path(f"/proc/{process}/task/{process}/children")
    return {int(child) for child in path.read_text().split()}


def until(holds: object) -> None:
    deadline = time.monotonic() + SOON_S
    assert callable(holds)
    while not holds():
        assert time.monotonic() < deadline, "did not come to hold in time"
        time.sleep(0.05)


def test_two_processes_serve_one_store_and_end_with_the_one_that_started_them(
    drawn_set: StimulusSet, postgres_url: str
) -> None:
    with served(drawn_set.folder, postgres_url, "--workers", "2") as server:
        until(lambda: len(children(server.process.pid)) == 2)
        visitors = []
        for _ in range(8):
            # A client of its own opens a connection of its own, to either process.
            with httpx.Client(base_url=server.url, timeout=SOON_S) as client:
                visitor = Visitor(client).begin()
                assert visitor.answer(0, 5).status_code == 200
                assert visitor.answer(0, 5).status_code == 200
                assert visitor.answer(0, 6).status_code == 409
                visitors.append(visitor)
        assert sorted(visitor.number for visitor in visitors) == list(range(1, 9))
        workers = children(server.process.pid)
        victim = min(workers)
        os.kill(victim, signal.SIGKILL)  # is replaced
        until(lambda: len(children(server.process.pid) - {victim}) == 2)
        with httpx.Client(base_url=server.url, timeout=SOON_S) as client:
            assert Visitor(client).begin().answer(0, 5).status_code == 200
        workers = children(server.process.pid)
        server.process.kill()
        server.process.wait()
        until(lambda: not any(Path(f"/proc/{worker}").exists() for worker in workers))
        # The port is free again for the next start.
        with socket.create_server(("127.0.0.1", urlsplit(server.url).port or 0)):
            pass
    with Store.open(postgres_url, must_exist=True) as store:
        assert [row.answer for row in store.responses()] == [5] * 9


def test_a_sqlite_file_takes_one_process(drawn_set: StimulusSet, tmp_path: Path) -> None:
    data = str(tmp_path / "responses.sqlite")
    options = ["--stimuli", str(drawn_set.folder), "--data", data, "--port", "0", "--workers", "2"]
    with pytest.raises(ValueError, match="workers: 2 given, 1 accepted with a SQLite file"):
        CliRunner().invoke(app, ["serve", STUDY, *options], catch_exceptions=False)
