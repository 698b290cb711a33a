"""What `benchmarks.load` loads: a server in a process of its own, and participants who post.

Participants speak HTTP/1.1 with as little work of their own as can be, since they share the cores
with the server.
"""

import asyncio
import json
import os
import signal
import socket
import subprocess
import sys
from dataclasses import dataclass, field
from pathlib import Path
from typing import Final, cast

_COMMAND: Final = "from experiments.cli import app; app()"
_AGAIN_S: Final = 0.01
ANSWERS: Final = 8


@dataclass(frozen=True)
class Served:
    """A server, with whatever processes it started."""

    process: subprocess.Popen[bytes]
    port: int

    def kill(self) -> None:
        """End all its processes at once, as a power cut would."""
        os.killpg(self.process.pid, signal.SIGKILL)
        self.process.wait()


def free_port() -> int:
    """Return a port of this machine that nobody listens on."""
    with socket.create_server(("127.0.0.1", 0)) as listener:
        return int(listener.getsockname()[1])


def start(study: Path, stimuli: Path, data: str, workers: int, port: int) -> Served:
    """Start a server by the command that users type."""
    options: list[object] = ["--stimuli", stimuli, "--data", data, "--workers", workers]
    process = subprocess.Popen(
        [sys.executable, "-c", _COMMAND, "serve", *map(str, [study, *options, "--port", port])],
        stdout=subprocess.DEVNULL,
        start_new_session=True,
    )
    return Served(process, port)


class Connection(asyncio.Protocol):
    """One connection, with one request under way at a time."""

    def __init__(self) -> None:
        self._transport: asyncio.Transport | None = None
        self._received = b""
        self._reply: asyncio.Future[int] | None = None

    def connection_made(self, transport: asyncio.BaseTransport) -> None:
        """Keep the transport."""
        self._transport = cast(asyncio.Transport, transport)  # uvloop's is none by its class

    def connection_lost(self, exc: Exception | None) -> None:
        """Tell who waits."""
        self._transport = None
        if self._reply is not None and not self._reply.done():
            self._reply.set_exception(exc or ConnectionResetError())

    def data_received(self, data: bytes) -> None:
        """Tell the status once the whole reply is there."""
        self._received += data
        head, end, body = self._received.partition(b"\r\n\r\n")
        if not end or self._reply is None:
            return
        length = int(head.lower().partition(b"content-length:")[2].partition(b"\r\n")[0])
        if len(body) >= length:
            self._received = b""
            self._reply.set_result(int(head[9:12]))

    async def send(self, request: bytes) -> int:
        """Send a request and return the reply's status."""
        if self._transport is None:
            raise ConnectionResetError
        self._reply = asyncio.get_running_loop().create_future()
        self._transport.write(request)
        return await self._reply

    def close(self) -> None:
        """Close the connection."""
        if self._transport is not None:
            self._transport.close()


@dataclass
class Participant:
    """Someone who answers one trial after another.

    Attributes
    ----------
    session, token
        An open session.
    acknowledged
        The answers that the server has acknowledged, by trial.
    """

    session: str
    token: str
    acknowledged: dict[int, int] = field(default_factory=dict)
    _connection: Connection | None = None

    async def answer(self, port: int) -> None:
        """Post the next answer, again and again until it is acknowledged.

        Raises
        ------
        RuntimeError
            If the server refuses it.
        """
        index = len(self.acknowledged)
        given = (7 * index + len(self.session)) % ANSWERS + 1
        request = self._request(index, given, port)
        while True:
            try:
                status = await (await self._connected(port)).send(request)
            except OSError:
                self._connection = None
                await asyncio.sleep(_AGAIN_S)
                continue
            if status != 200:
                raise RuntimeError(f"the server answered {status}")
            self.acknowledged[index] = given
            return

    def leave(self) -> None:
        """Close the connection."""
        if self._connection is not None:
            self._connection.close()

    async def _connected(self, port: int) -> Connection:
        if self._connection is None:
            loop = asyncio.get_running_loop()
            _, self._connection = await loop.create_connection(Connection, "127.0.0.1", port)
        return self._connection

    def _request(self, index: int, answer: int, port: int) -> bytes:
        body = json.dumps(
            {
                "id": f"{self.session}.{index:04d}",
                "trial_index": index,
                "answer": answer,
                "reaction_time_s": 1.234,
                "onset_requested_s": 10.0166,
                "onset_measured_s": 10.0333,
                "frame_interval_s": 0.01667,
                "dropped_frames": 0,
                "input": "mouse",
            }
        ).encode()
        head = (
            f"POST /api/sessions/{self.session}/answers HTTP/1.1\r\nHost: 127.0.0.1:{port}\r\n"
            f"Authorization: Bearer {self.token}\r\nContent-Type: application/json\r\n"
            f"Content-Length: {len(body)}\r\n\r\n"
        )
        return head.encode() + body
