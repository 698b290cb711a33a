"""What every benchmark says: on which machine, and the result as JSON."""

import json
import os
import platform
from pathlib import Path
from typing import Any

from algorithms.files import write_atomically


def machine() -> dict[str, Any]:
    """Return the processor's name, the cores, and how busy they are with other things."""
    information = Path("/proc/cpuinfo")
    lines = information.read_text(encoding="utf-8").splitlines() if information.exists() else []
    names = [line.split(":", 1)[1].strip() for line in lines if line.startswith("model name")]
    return {
        "processor": names[0] if names else platform.machine(),
        "cores": os.cpu_count(),
        "load": os.getloadavg()[0],
    }


def rounded(value: Any) -> Any:  # noqa: ANN401  # any JSON
    """Return JSON with four significant digits in its numbers."""
    if isinstance(value, dict):
        return {key: rounded(each) for key, each in value.items()}
    if isinstance(value, list | tuple):
        return [rounded(each) for each in value]
    return float(f"{value:.4g}") if isinstance(value, float) else value


def write_result(result: dict[str, Any], output: Path | None) -> None:
    """Write a benchmark's result as JSON, to a file or the terminal."""
    text = json.dumps(rounded(result), indent=1)
    if output:
        write_atomically(output, text.encode() + b"\n")
    else:
        print(text)
