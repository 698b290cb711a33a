"""Several server processes behind one port, for a store that they share."""

import multiprocessing
import os
import signal
import socket
import threading
from dataclasses import dataclass

import uvicorn
from fastapi import FastAPI
from uvicorn.supervisors import Multiprocess

from algorithms.errors import InputError
from experiments.store import Store
from experiments.study import Study
from experiments.web.app import create_site
from experiments.web.server import settings
from stimuli.manifest import StimulusSet


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
        """Open the store and return the application; the process ends with its parent."""
        threading.Thread(target=_end_with_parent, daemon=True).start()
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
        What each process runs.
    listener
        From `listen`; the processes share it.
    workers
        How many, 2 or more.
    """
    configuration = uvicorn.Config(worker, factory=True, workers=workers, **settings())
    Multiprocess(configuration, sockets=[listener]).run()


def _end_with_parent() -> None:
    # A parent that was killed ends nobody; its orphans would keep the port.
    parent = multiprocessing.parent_process()
    if parent is not None:
        parent.join()
        os.kill(os.getpid(), signal.SIGTERM)
