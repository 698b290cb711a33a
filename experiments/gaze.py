"""Gaze of a trial: raw samples as Parquet beside the store, and the event that tells where."""

import json
import math
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any, Final

import numpy as np

from algorithms.errors import InputError
from algorithms.files import make_folder, sha256_of, write_atomically
from experiments.planning.presentations import Trial
from experiments.responses import Event, Session

if TYPE_CHECKING:
    import pandas as pd

GAZE: Final = "gaze"
"""The kind of the events that tell of a trial's gaze."""


@dataclass(frozen=True)
class Place:
    """Where an image was on the screen.

    Attributes
    ----------
    stimulus
        Its id.
    left_px, top_px, width_px, height_px
        In pixels of the window, from its upper left corner.
    scale
        Pixels of the window per pixel of the image.
    """

    stimulus: str
    left_px: float
    top_px: float
    width_px: float
    height_px: float
    scale: float = 1.0


def pixels_per_degree(width_px: float, width_cm: float, distance_cm: float) -> float:
    """Return how many pixels one degree of visual angle takes in the middle of a flat screen.

    Parameters
    ----------
    width_px, width_cm
        Of the screen, above 0.
    distance_cm
        From the eye to the screen, above 0. Further out a degree takes more: 7 % at 15 degrees.

    Examples
    --------
    >>> round(pixels_per_degree(1920, 52, 60), 1)
    38.7
    """
    if min(width_px, width_cm, distance_cm) <= 0:
        raise InputError("width_px, width_cm, distance_cm: numbers above 0 accepted")
    return 2 * distance_cm * math.tan(math.radians(0.5)) * width_px / width_cm


def write_gaze(
    folder: Path,
    session: Session,
    trial: Trial,
    samples: "pd.DataFrame",
    places: Sequence[Place],
    degree_px: float,
) -> dict[str, Any]:
    """Write the samples of a trial as `SESSION.gaze/TRIAL.parquet`.

    Parameters
    ----------
    folder
        Where the session's folder goes; made if missing.
    session, trial
        Whose gaze, and when.
    samples
        `time_s` from the onset of the stimulus, `x_window_px` and `y_window_px` from the window's
        upper left corner, `valid`.
    places
        Of each image, in the order shown.
    degree_px
        Pixels of the window per degree of visual angle.

    Returns
    -------
    What the trial's event says: `trial_index`, `file`, `sha256`, `samples`, `valid_share`, `places`
    and `pixels_per_degree` (of the first image). The file's columns are those of
    `analysis.gaze.samples`, then `stimulus` and the samples as given. `x_px` and `y_px` are pixels
    of the image; where several are shown, of the one that is looked at, and missing beside them.
    """
    if not places:
        raise InputError("places: none given, one for each image accepted")
    columns = {"participant": session.participant, "session": session.id}
    table = samples.assign(**columns, trial_index=trial.index, **_on_images(samples, places))
    table = table[[*columns, "trial_index", "time_s", "x_px", "y_px", "valid", "stimulus",
                   "x_window_px", "y_window_px"]]  # fmt: skip
    told: dict[str, Any] = {
        "trial_index": trial.index,
        "pixels_per_degree": degree_px / places[0].scale,
        "places": [asdict(place) for place in places],
    }
    path = make_folder(folder / f"{session.id}.gaze") / f"{trial.index:04d}.parquet"
    write_atomically(path, _parquet(table, told))
    shares = {
        "samples": len(table),
        "valid_share": float(table["valid"].mean()) if len(table) else 0.0,
    }
    return {**told, **shares, "file": path.as_posix(), "sha256": sha256_of(path)}


def load_gaze(
    events: Iterable[Event], folders: Sequence[Path] = (Path(),)
) -> tuple["pd.DataFrame", dict[tuple[str, int], float]]:
    """Load the samples of all trials that events tell of.

    Parameters
    ----------
    events
        Of a store; those of other kinds are passed over, of a repeated trial the last one counts.
    folders
        Where a file may be: under its path as it was written, or next to its session's folder.

    Returns
    -------
    One row a sample in the columns of `analysis.gaze.samples`, and by session and trial how many
    pixels of the image a degree of visual angle takes.

    Raises
    ------
    InputError
        If a file is missing or was altered, or there is none.
    """
    import pandas as pd

    last = {(e.session, int(e.detail["trial_index"])): e.detail for e in events if e.kind == GAZE}
    if not last:
        raise InputError("gaze: none was recorded with these answers")
    tables = [pd.read_parquet(_find(detail, folders)) for detail in last.values()]
    degrees = {key: float(detail["pixels_per_degree"]) for key, detail in last.items()}
    return pd.concat(tables, ignore_index=True), degrees


def _find(detail: Mapping[str, Any], folders: Sequence[Path]) -> Path:
    written = Path(detail["file"])
    short = Path(*written.parts[-2:])
    for path in (each / name for each in folders for name in (written, short)):
        if path.is_file():
            if sha256_of(path) != detail["sha256"]:
                raise InputError(f"{path}: altered since it was recorded (its SHA-256 differs)")
            return path
    raise InputError(f"gaze: {written} is missing; --gaze FOLDER tells where such files are")


def _on_images(samples: "pd.DataFrame", places: Sequence[Place]) -> dict[str, Any]:
    """Return which image each sample is on, and where on it."""
    x, y = (samples[name].to_numpy(float) for name in ("x_window_px", "y_window_px"))
    on = np.full(len(x), 0 if len(places) == 1 else -1)
    for number, place in enumerate(places if len(places) > 1 else ()):
        across, down = x - place.left_px, y - place.top_px
        inside = (across >= 0) & (across < place.width_px) & (down >= 0) & (down < place.height_px)
        on[inside] = number
    left, top, scale = np.array([(p.left_px, p.top_px, p.scale) for p in places])[on].T
    names = np.array([*(place.stimulus for place in places), None], dtype=object)[on]
    return {
        "stimulus": names,
        "x_px": np.where(on >= 0, (x - left) / scale, np.nan),
        "y_px": np.where(on >= 0, (y - top) / scale, np.nan),
    }


def _parquet(table: "pd.DataFrame", told: Mapping[str, Any]) -> bytes:
    """Return a table as Parquet, with what is told of the trial in the file's metadata."""
    import pyarrow as pa  # type: ignore[import-untyped]
    from pyarrow import parquet

    made = pa.Table.from_pandas(table, preserve_index=False)
    made = made.replace_schema_metadata({**made.schema.metadata, b"trompe": json.dumps(told)})
    stream = pa.BufferOutputStream()
    parquet.write_table(made, stream)
    content: bytes = stream.getvalue().to_pybytes()
    return content
