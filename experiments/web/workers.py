"""Several server processes behind one port, for a store that they share."""

import multiprocessing
import os
import signal
import socket
import sys
import threading
import time
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from multiprocessing.connection import wait
from multiprocessing.process import BaseProcess
from typing import Final

from fastapi import FastAPI

from algorithms.errors import InputError
from experiments.storage.store import Store
from experiments.study import Study
from experiments.web.app import create_site
from experiments.web.server import serve
from stimuli.manifest import StimulusSet

_LOOK_S: Final = 0.2
_INTERRUPTS: Final = (signal.SIGINT, signal.SIGTERM)
# Forked, a process has all modules and serves at once; other systems must import them anew.
_CONTEXT: Final = (
    multiprocessing.get_context("fork")
    if sys.platform == "linux"
    else multiprocessing.get_context("spawn")
)


@dataclass(frozen=True)
class Worker:
    """Makes the application anew in each process.

    Attributes
    ----------
    studies, pilot
        As in `create_site`.
    data
        The URL of the store.
    """

    studies: tuple[tuple[Study, StimulusSet], ...]
    data: str
    pilot: bool

    def __call__(self) -> FastAPI:
        """Open the store and return the application."""
        return create_site(self.studies, Store.open(self.data), pilot=self.pilot)


def check_workers(workers: int, store: Store) -> None:
    """Check that so many processes can serve a store.

    Raises
    ------
    InputError
        If it is a SQLite file and there are to be several: SQLite lets one process write at a time,
        so that several are no faster than one.
    """
    if workers > 1 and store.engine.dialect.name == "sqlite":
        raise InputError(
            f"workers: {workers} given, 1 accepted with a SQLite file; give --data a postgresql://"
            " URL for several"
        )


def serve_workers(worker: Worker, listener: socket.socket, workers: int) -> None:
    """Serve from several processes until interrupted; one that dies is replaced.

    Parameters
    ----------
    worker
        What each process runs. No store may be open here: processes must not share connections.
    listener
        From `listen`; the processes share it.
    workers
        How many, 2 or more.
    """
    with _until_interrupted() as interrupted:
        running = [_started(worker, listener) for _ in range(workers)]
        while not interrupted.is_set():
            ended = wait([each.sentinel for each in running], timeout=_LOOK_S)
            running = [
                _started(worker, listener) if each.sentinel in ended else each for each in running
            ]
            if ended:
                time.sleep(_LOOK_S)  # what fails again and again must not fill the machine
        for each in running:
            each.terminate()
        for each in running:
            each.join()


def _started(worker: Worker, listener: socket.socket) -> BaseProcess:
    process = _CONTEXT.Process(target=_serve, args=(worker, listener, os.getpid()))
    process.start()
    return process


def _serve(worker: Worker, listener: socket.socket, parent: int) -> None:
    for number in _INTERRUPTS:
        signal.signal(number, signal.SIG_DFL)  # not those of the process that was forked
    threading.Thread(target=_end_with, args=(parent,), daemon=True).start()
    serve(worker(), listener)


def _end_with(parent: int) -> None:
    # A parent that was killed ends nobody; its orphans would keep the port.
    while os.getppid() == parent:
        time.sleep(_LOOK_S)
    os.kill(os.getpid(), signal.SIGTERM)


@contextmanager
def _until_interrupted() -> Iterator[threading.Event]:
    interrupted = threading.Event()
    before = [signal.signal(number, lambda *_: interrupted.set()) for number in _INTERRUPTS]
    try:
        yield interrupted
    finally:
        for number, handler in zip(_INTERRUPTS, before, strict=True):
            signal.signal(number, handler)
