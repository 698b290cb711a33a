"""Pictures of more than 8 bits that OpenImageIO decodes: Radiance HDR, 16-bit PNG, TIFF."""

from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from algorithms.errors import InputError
from algorithms.files import write_atomically

if TYPE_CHECKING:
    import OpenImageIO

# Loaded where it is used: few pictures need it.


def bits_per_channel(path: Path) -> int:
    """Return how many bits a channel of a picture has: 8, 16 or 32.

    Raises
    ------
    InputError
        If the file is not a readable picture.
    """
    with _opened(path) as file:
        return int(file.spec().format.size()) * 8


def size_px(path: Path) -> tuple[int, int]:
    """Return width and height of a picture, which is not decoded.

    Raises
    ------
    InputError
        If the file is not a readable picture.
    """
    with _opened(path) as file:
        return file.spec().width, file.spec().height


def read_deep(path: Path) -> NDArray[np.float32]:
    """Read a picture's values as they stand.

    Returns
    -------
    float32 `(height, width, channels)`; integers as 0..1, alpha not multiplied into the colours.

    Raises
    ------
    InputError
        If the file is not a readable picture.
    """
    import OpenImageIO

    with _opened(path) as file:
        values = file.read_image(OpenImageIO.FLOAT)
        if values is None:
            raise InputError(f"{path}: not a readable picture")
        return np.asarray(values, dtype=np.float32)


def write_radiance(path: Path, image: NDArray[np.float32]) -> None:
    """Write linear light, `(height, width, 3)`, as a Radiance HDR file.

    Its pixels share an exponent among their channels: to about 1 % of the largest. Less than 0 is
    not known to it and becomes 0.

    Raises
    ------
    InputError
        If the folder cannot be written to.
    """
    import OpenImageIO

    height, width, channels = image.shape
    specification = OpenImageIO.ImageSpec(width, height, channels, OpenImageIO.FLOAT)
    values = np.ascontiguousarray(np.maximum(image, 0), dtype=np.float32)
    with TemporaryDirectory() as folder:
        temporary = Path(folder, "image.hdr")
        file = OpenImageIO.ImageOutput.create(str(temporary))
        assert file is not None  # it is one of the formats that the library knows
        opened = file.open(str(temporary), specification)
        if not (opened and file.write_image(values) and file.close()):
            raise InputError(f"{path}: cannot be written ({file.geterror()})")
        write_atomically(path, temporary.read_bytes())


@contextmanager
def _opened(path: Path) -> "Iterator[OpenImageIO.ImageInput]":
    import OpenImageIO

    if not path.is_file():
        raise InputError(f"{path}: no such file")
    # Colours are wanted as they stand in the file, not multiplied by alpha.
    plain = OpenImageIO.ImageSpec()
    plain.attribute("oiio:UnassociatedAlpha", 1)
    file = OpenImageIO.ImageInput.open(str(path), plain)
    if file is None:
        OpenImageIO.geterror()  # an error that nobody fetched is printed when the program ends
        raise InputError(f"{path}: not a readable picture")
    try:
        yield file
    finally:
        file.geterror()
        file.close()
