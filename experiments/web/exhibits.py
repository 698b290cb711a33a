"""Stimuli as participants receive them: under names, and in bytes, that tell nothing of them."""

import hashlib
import hmac
import struct
from collections.abc import Callable, Iterator, Mapping
from functools import cached_property, lru_cache
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from algorithms.errors import InputError
from algorithms.images import read_labels
from experiments.web.errors import ApiError
from stimuli.manifest import Stimulus, StimulusSet

_PNG_SIGNATURE = b"\x89PNG\r\n\x1a\n"
# What a picture needs to be shown as it was meant; texts, times and Exif are left out.
_SHOWN_CHUNKS = {b"IHDR", b"PLTE", b"IDAT", b"IEND", b"tRNS", b"sRGB", b"gAMA", b"cHRM", b"iCCP"}

Runs = list[tuple[int, int]]


class Exhibits:
    """The images and region maps of a set under opaque ids, different for every session.

    An id is the HMAC-SHA256 of session and file under the server's secret: without the secret
    nobody can tell a stimulus from its id, nor compare notes with another participant.

    Parameters
    ----------
    stimuli
        The set, with its folder.
    secret
        The server's secret.

    Raises
    ------
    InputError
        If an image of the set is not a PNG.
    """

    def __init__(self, stimuli: StimulusSet, secret: str) -> None:
        self._stimuli = stimuli
        self._secret = secret.encode()
        self._images = {stimulus.file for stimulus in stimuli.stimuli}
        self._maps = {stimulus.regions for stimulus in stimuli.stimuli if stimulus.regions}
        self._sizes_px = {file: png_size_px(stimuli.path(file)) for file in sorted(self._images)}

    def image_id(self, session: str, stimulus: Stimulus) -> str:
        """Return the id under which a session sees a stimulus' image."""
        return self._opaque(session, stimulus.file)

    def regions_id(self, session: str, stimulus: Stimulus) -> str:
        """Return the id of a stimulus' region map; equal maps share one."""
        assert stimulus.regions is not None  # check_stimuli has seen to it
        return self._opaque(session, self._stimuli.files[stimulus.regions])

    def size_px(self, stimulus: Stimulus) -> tuple[int, int]:
        """Return width and height of a stimulus' image."""
        return self._sizes_px[stimulus.file]

    def image(self, stimulus: Stimulus) -> bytes:
        """Return a stimulus' image as it is sent.

        Raises
        ------
        ApiError
            If the file is no longer what the set's manifest says.
        """
        return self._content(stimulus.file)

    def find_image(self, session: str, opaque: str) -> bytes | None:
        """Return the image a session knows by an id, or None.

        Raises
        ------
        ApiError
            As for `image`.
        """
        file = self._files_of(session).get(opaque)
        return None if file is None else self._content(file)

    def find_regions(self, session: str, opaque: str) -> Path | None:
        """Return the file of the region map a session knows by an id, or None."""
        for file in self._maps:
            if _same(self._opaque(session, self._stimuli.files[file]), opaque):
                return self._stimuli.path(file)
        return None

    def _content(self, file: str) -> bytes:
        # Answers name the manifest: nothing but what it says may be shown under it.
        content = self._stimuli.path(file).read_bytes()
        if hashlib.sha256(content).hexdigest() != self._stimuli.files[file]:
            raise ApiError(503, "image: altered since the set was made; make it anew, and restart")
        return shown_png(content)

    @cached_property
    def _files_of(self) -> Callable[[str], Mapping[str, str]]:
        """The images' files by the ids under which a session knows them, kept for some sessions."""

        @lru_cache(maxsize=500)
        def files_of(session: str) -> Mapping[str, str]:
            return {self._opaque(session, file): file for file in self._images}

        return files_of

    def _opaque(self, session: str, key: str) -> str:
        message = f"{session}\n{key}".encode()
        return hmac.new(self._secret, message, hashlib.sha256).hexdigest()[:32]


@lru_cache(maxsize=16)
def region_runs(path: Path) -> dict[str, int | Runs]:
    """Return a label image as run lengths: `width_px`, `height_px` and `runs` (`label_runs`).

    A participant's browser cannot be trusted to read labels from pixels: some falsify what a
    canvas returns, for privacy.
    """
    labels = read_labels(path)
    height_px, width_px = labels.shape
    return {"width_px": width_px, "height_px": height_px, "runs": label_runs(labels)}


def label_runs(labels: NDArray[np.uint8]) -> Runs:
    """Return the runs of equal labels, row by row: pairs of label and length in pixels.

    Parameters
    ----------
    labels
        Label image `(height, width)`, 0 = background; at least one pixel.
    """
    flat = labels.ravel()
    starts = np.flatnonzero(np.r_[True, flat[1:] != flat[:-1]])
    lengths = np.diff(np.r_[starts, flat.size])
    return list(zip(flat[starts].tolist(), lengths.tolist(), strict=True))


def shown_png(content: bytes) -> bytes:
    """Return a PNG without the chunks that only describe it (texts, times, Exif)."""
    kept = [chunk for kind, chunk in _chunks(content) if kind in _SHOWN_CHUNKS]
    return _PNG_SIGNATURE + b"".join(kept)


def png_size_px(path: Path) -> tuple[int, int]:
    """Return width and height of a PNG.

    Raises
    ------
    InputError
        If the file is missing or no PNG.
    """
    try:
        with path.open("rb") as stream:
            head = stream.read(24)
    except OSError as error:
        raise InputError(f"{path}: cannot be read ({error.strerror})") from error
    if len(head) < 24 or not head.startswith(_PNG_SIGNATURE):
        raise InputError(f"{path}: the web runner shows PNG images only")
    width_px, height_px = struct.unpack(">II", head[16:24])
    return width_px, height_px


def _chunks(content: bytes) -> Iterator[tuple[bytes, bytes]]:
    position = len(_PNG_SIGNATURE)
    while position < len(content):
        (length,) = struct.unpack_from(">I", content, position)
        end = position + 12 + length  # length, kind, data, checksum
        yield content[position + 4 : position + 8], content[position:end]
        position = end


def _same(left: str, right: str) -> bool:
    return hmac.compare_digest(left.encode(), right.encode())
