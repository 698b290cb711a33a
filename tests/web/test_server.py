"""The server as a process: ports, pages, and what survives being killed."""

import os
import signal
import socket
import threading
from concurrent.futures import ThreadPoolExecutor
from contextlib import closing
from dataclasses import dataclass, field
from pathlib import Path
from sqlite3 import connect

import httpx
import pytest

from algorithms.errors import InputError
from experiments.storage.store import Store
from experiments.study import Study
from experiments.web import create_app, listen, running_server
from stimuli.manifest import StimulusSet
from tests.web.serving import START_S, Served, served
from tests.web.visitor import STUDY, Visitor

PARTICIPANTS = 4


@dataclass
class Killer:
    """Kills a server once so many answers are acknowledged, while everybody goes on answering."""

    server: Served
    after: int
    acknowledged: dict[str, dict[int, int]] = field(default_factory=dict)
    enough: threading.Event = field(default_factory=threading.Event)

    def answer_until_killed(self, visitor: Visitor) -> None:
        mine = self.acknowledged[visitor.session] = {}
        for trial in visitor.get().json()["trials"]:
            index = int(trial["index"])
            answer = (visitor.number + index) % 8 + 1
            try:
                reply = visitor.answer(index, answer)
            except httpx.HTTPError:
                return
            assert reply.status_code == 200, reply.text
            mine[index] = answer
            if sum(map(len, self.acknowledged.values())) >= self.after:
                self.enough.set()
        raise AssertionError("all trials were answered before the server was killed")

    def kill(self) -> None:
        assert self.enough.wait(START_S)
        os.kill(self.server.process.pid, signal.SIGKILL)


def test_sigkill_loses_no_acknowledged_answer(drawn_set: StimulusSet, tmp_path: Path) -> None:
    data = tmp_path / "responses.sqlite"
    with served(drawn_set.folder, data) as server, httpx.Client(base_url=server.url) as client:
        visitors = [Visitor(client).begin() for _ in range(PARTICIPANTS)]
        killer = Killer(server, after=20 * PARTICIPANTS)
        with ThreadPoolExecutor(PARTICIPANTS + 1) as pool:
            killing = pool.submit(killer.kill)
            list(pool.map(killer.answer_until_killed, visitors))
            killing.result()
        assert server.process.wait() == -signal.SIGKILL
    with Store.open(data, must_exist=True) as store:
        for visitor in visitors:
            stored = store.answers(visitor.session)
            acknowledged = killer.acknowledged[visitor.session]
            assert acknowledged.items() <= stored.items()
            # One more may have been stored whose acknowledgement was lost on the way.
            assert len(stored) <= len(acknowledged) + 1
    with closing(connect(data)) as database:
        assert database.execute("PRAGMA integrity_check").fetchone() == ("ok",)
    finish_after_restart(drawn_set.folder, data, visitors)


def finish_after_restart(stimuli: Path, data: Path, visitors: list[Visitor]) -> None:
    """Everybody goes on where they were: each trial ends with one answer, none lost or doubled."""
    with served(stimuli, data) as server, httpx.Client(base_url=server.url) as client:
        for visitor in visitors:
            visitor.client = client
            told = visitor.get().json()
            indices = [int(trial["index"]) for trial in told["trials"]]
            for index in indices:
                if index not in told["answered"]:
                    assert visitor.answer(index).status_code == 200
            assert visitor.post("/complete", None).status_code == 200
    with Store.open(data, must_exist=True) as store:
        rows = [(row.session, row.trial_index) for row in store.responses()]
        assert sorted(rows) == sorted((v.session, i) for v in visitors for i in indices)


def test_a_port_in_use_is_named_with_the_way_out(
    study: Study, drawn_set: StimulusSet, store: Store
) -> None:
    with socket.create_server(("127.0.0.1", 0)) as taken:
        port = taken.getsockname()[1]
        with pytest.raises(InputError, match=f"port {port} is in use; choose another with --port"):
            listen("127.0.0.1", port)
        app = create_app(study, drawn_set, store)
        with pytest.raises(InputError, match="in use"), running_server(app, port=port):
            pass


@pytest.mark.parametrize("host", ["203.0.113.7", "no such host"])
def test_a_host_that_is_not_here_is_refused(host: str) -> None:
    with pytest.raises(InputError, match=host):
        listen(host, 0)


def test_small_replies_are_sent_at_once() -> None:
    # Without TCP_NODELAY every answer would wait 40 ms for the client's delayed acknowledgement;
    # asyncio sets it on sockets whose protocol is TCP by name.
    with listen("127.0.0.1", 0) as listener:
        assert listener.proto == socket.IPPROTO_TCP


def test_without_a_front_end_pages_say_how_to_build_it_and_the_interface_works(
    study: Study, drawn_set: StimulusSet, store: Store, tmp_path: Path
) -> None:
    app = create_app(study, drawn_set, store, bundle=tmp_path)
    with running_server(app) as url, httpx.Client(base_url=url) as client:
        for path in (f"/s/{STUDY}/", f"/researcher/{STUDY}/"):
            reply = client.get(path)
            assert reply.status_code == 503
            assert "pip install --editable ." in reply.json()["error"]["message"]
        assert Visitor(client).begin().answer(0).status_code == 200


def test_pages_and_assets_are_served_from_the_bundle(
    study: Study, drawn_set: StimulusSet, store: Store, tmp_path: Path
) -> None:
    (tmp_path / "assets").mkdir()
    for name in ("index.html", "researcher.html", "assets/main.js"):
        (tmp_path / name).write_text(name)
    app = create_app(study, drawn_set, store, bundle=tmp_path)
    with running_server(app) as url, httpx.Client(base_url=url, follow_redirects=True) as client:
        assert client.get("/").text == "index.html"
        assert client.get(f"/s/{STUDY}").text == "index.html"
        assert client.get(f"/researcher/{STUDY}/").text == "researcher.html"
        assert client.get("/assets/main.js").text == "assets/main.js"
