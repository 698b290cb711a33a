"""One file for each stimulus set; each offers `make(folder, ...)`."""

import importlib
from collections.abc import Mapping
from pathlib import Path
from typing import Final, Protocol

from algorithms.errors import InputError
from stimuli.making import Progress
from stimuli.manifest import StimulusSet

SUMMARIES: Final[Mapping[str, str]] = {
    "divergence": "experiment 1: eight objects, one of them under another light (sec. 2.3)",
}
"""What each set is, by its name, which is also the name of its file."""


class Make(Protocol):
    """What every set offers; see the sets for what the arguments mean to them."""

    def __call__(
        self,
        folder: Path,
        *,
        seed: int,
        quick: bool,
        replicates: int,
        engine: str | None,
        progress: Progress,
    ) -> StimulusSet:
        """Make the set in a folder, or what is missing of it."""
        ...


def maker(name: str) -> Make:
    """Return the function that makes a set.

    Raises
    ------
    InputError
        If there is no set of that name.
    """
    if name not in SUMMARIES:
        raise InputError(f"set: {name!r} given, {', '.join(SUMMARIES)} accepted")
    make: Make = importlib.import_module(f"stimuli.sets.{name}").make
    return make
