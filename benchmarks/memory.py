"""The memory that a piece of work takes at its peak, as Linux counts it."""

import gc
from collections.abc import Callable
from pathlib import Path

_STATUS = Path("/proc/self/status")
_CLEAR = Path("/proc/self/clear_refs")
_RESET_PEAK = "5"


def peak_growth_bytes(work: Callable[[], object]) -> int:
    """Return by how much this process grows at most beyond what it holds, while it does something.

    What it holds already, such as the arguments, does not count; what libraries keep for the next
    time does, the first time.
    """
    gc.collect()
    _CLEAR.write_text(_RESET_PEAK, encoding="ascii")
    before = _bytes_of("VmRSS")
    work()
    return _bytes_of("VmHWM") - before


def _bytes_of(name: str) -> int:
    for line in _STATUS.read_text(encoding="ascii").splitlines():
        if line.startswith(f"{name}:"):
            return int(line.split()[1]) * 1024
    raise RuntimeError(f"{_STATUS} has no {name}")
