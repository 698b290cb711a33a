"""Running the web application: for a study, and for a while inside another program."""

import errno
import socket
import threading
import time
from collections.abc import Iterator
from contextlib import contextmanager

import uvicorn
from fastapi import FastAPI

from algorithms.errors import InputError

_START_S = 30.0


def serve(app: FastAPI, listener: socket.socket) -> None:
    """Serve until interrupted.

    Parameters
    ----------
    app
        From `create_app`.
    listener
        From `listen`; whoever opened it closes it.
    """
    _server(app).run(sockets=[listener])


@contextmanager
def running_server(app: FastAPI, host: str = "127.0.0.1", port: int = 0) -> Iterator[str]:
    """Serve from a thread while the block runs, and yield the base URL.

    Parameters
    ----------
    app
        From `create_app`.
    host, port
        Where to listen; port 0 takes a free one.

    Raises
    ------
    InputError
        If the port is in use.

    Examples
    --------
    >>> with running_server(create_app(study, stimuli, store)) as url:  # doctest: +SKIP
    ...     httpx.get(f"{url}/api/studies/{study.name}")
    """
    listener = listen(host, port)
    server = _server(app)
    thread = threading.Thread(target=server.run, kwargs={"sockets": [listener]}, daemon=True)
    with listener:
        thread.start()
        try:
            _wait_until_started(server, thread)
            yield base_url(listener)
        finally:
            server.should_exit = True
            thread.join()


def listen(host: str, port: int) -> socket.socket:
    """Return a socket that listens there.

    Raises
    ------
    InputError
        If the port is in use or may not be used, or the host is not this machine's.
    """
    try:
        family, kind, protocol, _, address = socket.getaddrinfo(
            host, port, type=socket.SOCK_STREAM, proto=socket.IPPROTO_TCP
        )[0]
    except socket.gaierror:
        raise InputError(f"host: {host!r} is not an address of this machine") from None
    # asyncio sends small replies at once (TCP_NODELAY) only where TCP is named outright.
    listener = socket.socket(family, kind, protocol)
    try:
        listener.setsockopt(socket.SOL_SOCKET, socket.SO_REUSEADDR, 1)
        listener.bind(address)
        listener.listen(256)
    except OSError as error:
        listener.close()
        if error.errno == errno.EADDRINUSE:
            raise InputError(f"port {port} is in use; choose another with --port") from None
        raise InputError(f"{host}:{port} cannot be listened on ({error.strerror})") from None
    return listener


def base_url(listener: socket.socket) -> str:
    """Return the URL under which this machine reaches a listening socket."""
    host, port = listener.getsockname()[:2]
    host = {"0.0.0.0": "127.0.0.1", "::": "::1"}.get(host, host)
    return f"http://[{host}]:{port}" if ":" in host else f"http://{host}:{port}"


def _server(app: FastAPI) -> uvicorn.Server:
    # The access log would fill the terminal with a line an answer.
    return uvicorn.Server(
        uvicorn.Config(
            app, log_level="warning", access_log=False, server_header=False, lifespan="off"
        )
    )


def _wait_until_started(server: uvicorn.Server, thread: threading.Thread) -> None:
    deadline = time.monotonic() + _START_S
    while not server.started:
        if not thread.is_alive() or time.monotonic() > deadline:
            raise RuntimeError("the server did not start")
        time.sleep(0.01)
