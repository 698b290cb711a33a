"""How many answers a second the server stores for good, how long a post waits, and what kills cost.

    python -m benchmarks.load [--parts saturation paced kills] [--stores sqlite postgresql]
                              [--seconds 30] [--kills 20] [--output FILE]

The server is the one that `trompe study serve` starts, on this machine's loopback; load and server
share its cores. `saturation`: 50 participants, each posting its next answer as soon as the last one
is acknowledged. `paced`: 300 participants, each answering every 2 s on average (1 to 3 s). `kills`:
the server is killed (SIGKILL) again and again under 50 participants and started anew; afterwards
every acknowledged answer must be in the store, once. PostgreSQL (a cluster of its own, with the
settings that its package gives it) is served by two processes, SQLite by one. The store must make
commits durable (SQLite: `synchronous=FULL`), or nothing is measured.
"""

import argparse
import asyncio
import time
from collections.abc import Callable, Coroutine, Iterator
from contextlib import ExitStack, contextmanager
from dataclasses import dataclass
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

import numpy as np
import uvloop

from benchmarks.load_participants import Participant, Served, free_port, start
from benchmarks.results import machine, write_result
from experiments.storage.database import open_database
from experiments.storage.store import NewSession, Store
from experiments.study import READY_MADE, Study, load_study
from stimuli.manifest import StimulusSet
from tests.drawn_set import draw_set
from tests.postgres import programs, running_cluster

SATURATING, PACED = 50, 300
PACE_S = (1.0, 3.0)
BETWEEN_KILLS_S = (0.5, 1.5)
WARM_UP_S = 2.0
START_S = 30.0
ON_THE_WAY_S = 0.05  # until what was acknowledged before a kill has arrived
# So often that nobody comes to the end of the study.
REPEATS = {"saturation": 100, "paced": 2, "kills": 12}
WORKERS = {"sqlite": 1, "postgresql": 2}
DURABLE: dict[str, dict[str, int | str]] = {
    "sqlite": {"PRAGMA synchronous": 2, "PRAGMA journal_mode": "wal"},
    "postgresql": {"SHOW synchronous_commit": "on", "SHOW fsync": "on"},
}
SEED = 2011

Row = dict[str, Any]


@dataclass(frozen=True)
class Bench:
    """A study and a store, and the server between them."""

    kind: str
    data: str
    file: Path
    study: Study
    stimuli: StimulusSet

    def begin(self, participants: int) -> list[Participant]:
        """Open sessions."""
        new = NewSession("web", "load", {}, {}, simulated=True)
        with Store.open(self.data) as store:
            store.register(self.study, self.stimuli)
            begun = [
                store.begin_session(self.study, self.stimuli, new) for _ in range(participants)
            ]
        return [Participant(session.id, token) for session, token in begun]

    def start(self, port: int) -> Served:
        """Start the server."""
        return start(self.file, self.stimuli.folder, self.data, WORKERS[self.kind], port)

    def require_durable(self) -> None:
        """Measure nothing that a power cut would undo."""
        engine = open_database(self.data, must_exist=False)
        with engine.connect() as connection:
            for query, wanted in DURABLE[self.kind].items():
                found = connection.exec_driver_sql(query).scalar_one()
                assert found == wanted, f"{query}: {found}"
        engine.dispose()

    def check(self, participants: list[Participant]) -> Row:
        """Return how many acknowledged answers are lost or altered, and how many stored twice."""
        with Store.open(self.data) as store:
            stored = {one.session: store.answers(one.session) for one in participants}
            rows = [(row.session, row.trial_index) for row in store.responses()]
        lost = sum(
            stored[one.session].get(index) != answer
            for one in participants
            for index, answer in one.acknowledged.items()
        )
        acknowledged = sum(len(one.acknowledged) for one in participants)
        return {
            "acknowledged": acknowledged,
            "lost_or_altered": lost,
            "stored_twice": len(rows) - len(set(rows)),
            "stored_but_not_acknowledged": len(rows) - acknowledged,
        }


@contextmanager
def bench(kind: str, part: str) -> Iterator[Bench]:
    """Yield a study with an empty store."""
    with ExitStack() as stack:
        folder = Path(stack.enter_context(TemporaryDirectory(prefix="trompe-load-")))
        data = str(folder / "responses.sqlite")
        if kind == "postgresql":
            found = programs()
            assert found is not None, "PostgreSQL is not installed (apt install postgresql)"
            data = stack.enter_context(running_cluster(found)).new_database()
        file, images = folder / "study.toml", folder / "set"
        text = (READY_MADE / "lights-synthetic.toml").read_text(encoding="utf-8")
        text = text.replace("[design]", f"[design]\nrepeats = {REPEATS[part]}")
        file.write_text(text, encoding="utf-8")
        images.mkdir()
        made = Bench(kind, data, file, load_study(file), draw_set(images))
        made.require_durable()
        yield made


async def take_part(
    participant: Participant, port: int, pause_s: Callable[[], float], until_s: float
) -> list[float]:
    """Answer until it is time to leave; return how long each post took, in seconds."""
    await asyncio.sleep(pause_s() / 2)  # not all at once
    waits = []
    while time.perf_counter() < until_s:
        posted = time.perf_counter()
        await participant.answer(port)
        waits.append(time.perf_counter() - posted)
        await asyncio.sleep(pause_s())
    participant.leave()
    return waits


async def steady(made: Bench, participants: int, paced: bool, seconds: float) -> Row:
    """Return the rate and the waits of participants under a server that is left alone."""
    begun, port = made.begin(participants), free_port()
    server = made.start(port)
    try:
        for _ in range(5):  # the first answers wait for the server to start
            await begun[0].answer(port)
        pause_s = pace(paced)
        await everybody(begun, port, pause_s, WARM_UP_S)
        before = sum(len(one.acknowledged) for one in begun)
        waits = await everybody(begun, port, pause_s, seconds)
    finally:
        server.kill()
    answers = sum(len(one.acknowledged) for one in begun) - before
    p50, p95, p99 = (1000 * float(np.percentile(waits, share)) for share in (50, 95, 99))
    return {
        "participants": participants,
        "seconds": seconds,
        "answers_per_s": answers / seconds,
        "post_ms": {"p50": p50, "p95": p95, "p99": p99, "max": 1000 * max(waits)},
        **made.check(begun),
    }


def pace(paced: bool) -> Callable[[], float]:
    """Return how long participants think: between bounds, or not at all."""
    generator = np.random.default_rng(SEED)
    return (lambda: float(generator.uniform(*PACE_S))) if paced else (lambda: 0.0)


async def everybody(
    begun: list[Participant], port: int, pause_s: Callable[[], float], seconds: float
) -> list[float]:
    """Let everybody take part for a while; return how long all their posts took, in seconds."""
    until_s = time.perf_counter() + seconds
    tasks = [take_part(one, port, pause_s, until_s) for one in begun]
    return [wait for waits in await asyncio.gather(*tasks) for wait in waits]


async def killed(made: Bench, kills: int) -> Row:
    """Kill the server under load and start it anew, again and again."""
    begun, port = made.begin(SATURATING), free_port()
    generator = np.random.default_rng(SEED)
    server = made.start(port)
    loads = [asyncio.create_task(answer_on(one, port)) for one in begun]
    up_s = []
    try:
        await next_acknowledged(begun)
        for _ in range(kills):
            await asyncio.sleep(generator.uniform(*BETWEEN_KILLS_S))
            server.kill()
            started = time.perf_counter()
            server = made.start(port)
            await asyncio.sleep(ON_THE_WAY_S)
            await next_acknowledged(begun)
            up_s.append(time.perf_counter() - started)
    finally:
        for load in loads:
            load.cancel()
        ended = await asyncio.gather(*loads, return_exceptions=True)
        server.kill()
    errors = [str(end) for end in ended if not isinstance(end, asyncio.CancelledError)]
    assert not errors, errors
    return {
        "kills": kills,
        "up_again_s": {"median": float(np.median(up_s)), "max": max(up_s)},
        **made.check(begun),
    }


async def answer_on(participant: Participant, port: int) -> None:
    """Answer without end."""
    while True:
        await participant.answer(port)


async def next_acknowledged(begun: list[Participant]) -> None:
    """Wait until the server acknowledges an answer."""
    before, started = sum(len(one.acknowledged) for one in begun), time.perf_counter()
    while sum(len(one.acknowledged) for one in begun) == before:
        assert time.perf_counter() < started + START_S, "the server did not start"
        await asyncio.sleep(0.005)


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parts = ("saturation", "paced", "kills")
    parser.add_argument("--parts", nargs="+", choices=parts, default=parts)
    parser.add_argument("--stores", nargs="+", choices=tuple(WORKERS), default=tuple(WORKERS))
    parser.add_argument("--seconds", type=float, default=30.0)
    parser.add_argument("--kills", type=int, default=20)
    parser.add_argument("--output", type=Path)
    arguments = parser.parse_args()
    work: dict[str, Callable[[Bench], Coroutine[Any, Any, Row]]] = {
        "saturation": lambda made: steady(made, SATURATING, False, arguments.seconds),
        "paced": lambda made: steady(made, PACED, True, arguments.seconds),
        "kills": lambda made: killed(made, arguments.kills),
    }
    result: Row = {"machine": machine(), "seed": SEED, "processes": WORKERS, "durable": DURABLE}
    for kind in arguments.stores:
        for part in arguments.parts:
            with bench(kind, part) as made:
                result.setdefault(kind, {})[part] = uvloop.run(work[part](made))
    write_result(result, arguments.output)


if __name__ == "__main__":
    main()
