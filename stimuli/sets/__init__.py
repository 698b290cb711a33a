"""One file for each stimulus set; each offers `make(folder, ...)`."""

import importlib
import importlib.util
import inspect
from collections.abc import Callable, Mapping
from pathlib import Path
from typing import Any, Final, Protocol

from algorithms.errors import InputError
from stimuli.making import Progress
from stimuli.manifest import StimulusSet

SUMMARIES: Final[Mapping[str, str]] = {
    "divergence": "experiment 1: eight objects, one of them under another light (sec. 2.3)",
    "texture": "experiment 2: the same with four checkerboards (sec. 2.4)",
    "photographs": "experiment 3: your photographs, an object lit from elsewhere (sec. 2.5)",
    "lightprobes": "objects under known lights, for light detection (ch. 3 and 9)",
    "still-life": "a table with things of many materials, lit from six directions (sec. 8.7)",
    "caustics": "glass objects with caustics of photons, a revolved outline and one image (ch. 7)",
    "translucency": "translucent objects with irradiance maps of front and back (ch. 9)",
    "fog": "an outdoor scene with exact distance, clear and in fog of three densities (ch. 6)",
    "fog-methods": "a rendered and a photographed scene in fog by six methods each (sec. 6.4)",
}
"""What each set is, by its name, which is also the name of its file (with _ for -)."""


class Make(Protocol):
    """What every set offers; see the sets for what the arguments mean, and for those of their own.

    A file of one's own that offers such a function is a set too.
    """

    def __call__(
        self, folder: Path, *, seed: int, quick: bool, engine: str | None, progress: Progress
    ) -> StimulusSet:
        """Make the set in a folder, or what is missing of it."""
        ...


def maker(name: str, options: Mapping[str, Any] | None = None) -> Make:
    """Return the function that makes a set.

    Parameters
    ----------
    name
        Of one of our sets, or the path of a Python file that offers `make` as they do.
    options
        Arguments that only some sets have; they are bound to the function.

    Raises
    ------
    InputError
        If there is no set of that name, or it has no such option.
    """
    make = _function(name)
    accepted = inspect.signature(make).parameters

    def with_options(folder: Path, **others: Any) -> StimulusSet:  # noqa: ANN401
        return make(folder, **others, **(options or {}))

    for option in options or {}:
        if option not in accepted:
            raise InputError(f"{option}: not an option of the set {name!r}")
    return with_options


def _function(name: str) -> Callable[..., StimulusSet]:
    if name.endswith(".py"):
        return _function_of_file(Path(name))
    if name not in SUMMARIES:
        raise InputError(
            f"set: {name!r} given, {', '.join(SUMMARIES)} or the path of a Python file accepted"
        )
    make: Callable[..., StimulusSet] = importlib.import_module(
        f"stimuli.sets.{name.replace('-', '_')}"
    ).make
    return make


def _function_of_file(path: Path) -> Callable[..., StimulusSet]:
    if not path.is_file():
        raise InputError(f"set: {path}: no such file")
    specification = importlib.util.spec_from_file_location(path.stem, path)
    assert specification is not None
    assert specification.loader is not None
    module = importlib.util.module_from_spec(specification)
    specification.loader.exec_module(module)
    make: Callable[..., StimulusSet] | None = getattr(module, "make", None)
    if make is None:
        raise InputError(f"set: {path}: has no function `make`")
    return make
