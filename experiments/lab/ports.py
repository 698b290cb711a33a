"""Where trigger codes go: a serial or parallel port, or a file to try a set-up with."""

from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Literal, Protocol, Self, TextIO

from pydantic import Field, model_validator

from algorithms.errors import InputError, UnavailableError
from experiments.study_parts import Part, Text

_BAUD_RATE = 115_200
_LONGEST_WRITE_S = 1.0


class PortSettings(Part):
    """Which port, and how codes are sent to it.

    Attributes
    ----------
    kind
        `serial`, `parallel` or `file`.
    address
        `/dev/ttyUSB0` or `COM3`; `/dev/parport0` or `0x0378`; the name of a CSV file.
    baud_rate
        Of a serial port; None for 115200.
    reset
        Whether each code is followed by 0 with the next frame: what most boxes need, as they look
        for changes. A byte on a serial line is an event by itself.
    """

    kind: Literal["serial", "parallel", "file"]
    address: Text
    baud_rate: int | None = Field(default=None, ge=50, le=4_000_000)
    reset: bool = True

    @model_validator(mode="after")
    def _check_kind(self) -> Self:
        if self.baud_rate is not None and self.kind != "serial":
            raise ValueError(f"baud_rate: a {self.kind} port has no use for it")
        return self


class Port(Protocol):
    """What takes codes."""

    def send(self, code: int) -> None:
        """Send a code, 0 to 255."""


@contextmanager
def open_port(settings: PortSettings, time_s: Callable[[], float]) -> Iterator[Port]:
    """Open a port and close it afterwards.

    Parameters
    ----------
    settings
        Which.
    time_s
        The clock that a file's times are taken from.

    Raises
    ------
    UnavailableError
        If there is no such port, or it may not be used.
    InputError
        If the file cannot be written.
    """
    match settings.kind:
        case "serial":
            with _serial(settings) as port:
                yield port
        case "parallel":
            yield _parallel(settings)
        case "file":
            with _file(settings, time_s) as port:
                yield port


@contextmanager
def _serial(settings: PortSettings) -> Iterator[Port]:
    import serial

    rate = settings.baud_rate or _BAUD_RATE
    with _told_in_one_line(settings, serial.SerialException, ValueError):
        line = serial.Serial(settings.address, rate, write_timeout=_LONGEST_WRITE_S)
    with line, _told_in_one_line(settings, serial.SerialException):
        yield _SerialPort(line)


@contextmanager
def _told_in_one_line(settings: PortSettings, *errors: type[Exception]) -> Iterator[None]:
    try:
        yield
    except errors as error:
        raise UnavailableError(f"port.address: {settings.address}: {error}") from error


@dataclass(frozen=True)
class _SerialPort:
    line: Any

    def send(self, code: int) -> None:
        self.line.write(bytes([code]))


def _parallel(settings: PortSettings) -> Port:
    # Each platform's driver has errors of its own; all say that there is no such port.
    with _told_in_one_line(settings, Exception):
        from psychopy import parallel

        return _ParallelPort(parallel.ParallelPort(address=settings.address))


@dataclass(frozen=True)
class _ParallelPort:
    pins: Any

    def send(self, code: int) -> None:
        self.pins.setData(code)


@contextmanager
def _file(settings: PortSettings, time_s: Callable[[], float]) -> Iterator[Port]:
    path = Path(settings.address)
    try:
        file = path.open("a", encoding="ascii", buffering=1)
    except OSError as error:
        raise InputError(f"port.address: {path} cannot be written ({error.strerror})") from error
    with file:
        if file.tell() == 0:
            file.write("time_s,code\n")
        yield _FilePort(file, time_s)


@dataclass(frozen=True)
class _FilePort:
    file: TextIO
    time_s: Callable[[], float]

    def send(self, code: int) -> None:
        self.file.write(f"{self.time_s():.6f},{code}\n")
