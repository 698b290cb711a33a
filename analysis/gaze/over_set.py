"""Raw gaze of a whole stimulus set: fixations, heat maps, looking times and their ratios."""

import re
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any, Final, Literal

import numpy as np
import pandas as pd
from numpy.typing import NDArray
from PIL import Image

from algorithms.errors import InputError
from algorithms.files import make_folder, write_atomically
from algorithms.images import read_labels
from analysis.estimates import to_json
from analysis.gaze.fixations import Fixations, fixations_by_dispersion, fixations_by_velocity
from analysis.gaze.heat_map import HeatMap, heat_map
from analysis.gaze.looking_times import DwellRatios, dwell_ratios, dwell_times
from analysis.gaze.samples import TRIAL
from stimuli.manifest import StimulusSet

if TYPE_CHECKING:
    from matplotlib.figure import Figure

Method = Literal["velocity", "dispersion"]
_DETECTORS: Final[Mapping[str, Callable[[pd.DataFrame, float], Fixations]]] = {
    "velocity": fixations_by_velocity,
    "dispersion": fixations_by_dispersion,
}


@dataclass(frozen=True)
class GazeAnalysis:
    """Where people looked on the images of a set.

    Attributes
    ----------
    stimuli
        The set.
    fixations
        Of all trials.
    dwell
        One row a trial and region, as from `analysis.dwell_times`, with `target` and the
        level.
    ratios
        Time on the target against the mean of the other regions, by level; None where no image
        has a target.
    heat_maps
        By stimulus; none for images that nobody fixated.
    level
        The factor that the ratios are over.
    simulated
        Whether programs looked.
    """

    stimuli: StimulusSet
    fixations: Fixations
    dwell: pd.DataFrame
    ratios: DwellRatios | None
    heat_maps: Mapping[str, HeatMap]
    level: str
    simulated: bool

    def picture(self, name: str) -> NDArray[Any]:
        """Return an image of the set as displayed, shape (height, width, 3), 0 to 255."""
        with Image.open(self.stimuli.path(self.stimuli[name].file)) as picture:
            return np.asarray(picture.convert("RGB"))

    def tables(self) -> dict[str, pd.DataFrame]:
        """Return the tables by name, each row saying whether programs looked."""
        tables = {"fixations": self.fixations.to_frame(), "dwell-times": self.dwell}
        if self.ratios is not None:
            tables["dwell-ratios"] = self.ratios.to_frame()
        return {name: table.assign(simulated=self.simulated) for name, table in tables.items()}

    def figures(self) -> "dict[str, Figure]":
        """Return the ratios by level, and the heat map over each image, by name."""
        import matplotlib as mpl  # takes seconds to load

        from analysis.figures.gaze import dwell_ratios_figure, heat_map_figure
        from analysis.figures.style import SETTINGS

        with mpl.rc_context(SETTINGS):
            figures = {
                f"heat-map-{name}": heat_map_figure(
                    self.picture(name), heat, simulated=self.simulated
                )
                for name, heat in self.heat_maps.items()
            }
            if self.ratios is not None:
                label = re.sub(r"_(deg|px|s)$", r" (\1)", self.level).replace("_", " ")
                figures["dwell-ratios"] = dwell_ratios_figure(
                    {"target": self.ratios}, self.level, label, simulated=self.simulated
                )
        return figures

    def write(self, folder: str | Path) -> Path:
        """Write tables (CSV), figures (SVG and PNG) and `results.json`, and return its path.

        Raises
        ------
        InputError
            If the folder is not writable.
        """
        from analysis.figures.style import figure_bytes  # matplotlib takes seconds to load

        tables, figures = (make_folder(Path(folder) / name) for name in ("tables", "figures"))
        for name, table in self.tables().items():
            text = table.to_csv(index=False, lineterminator="\n")
            write_atomically(tables / f"{name}.csv", text.encode())
        for name, figure in self.figures().items():
            for form in ("svg", "png"):
                write_atomically(figures / f"{name}.{form}", figure_bytes(figure, form))
        results = {
            "stimuli": self.stimuli.name,
            "stimuli_digest": self.stimuli.digest,
            "simulated": self.simulated,
            "fixations": {
                "method": self.fixations.method,
                "settings": self.fixations.settings,
                "pixels_per_degree": self.fixations.pixels_per_degree,
                "trials": self.fixations.trials,
                "version": self.fixations.version,
            },
            "ratios": self.ratios,
        }
        path = Path(folder) / "results.json"
        write_atomically(path, to_json(results).encode())
        return path


def analyse_gaze(
    samples: pd.DataFrame,
    trials: pd.DataFrame,
    stimuli: StimulusSet,
    pixels_per_degree: float,
    level: str,
    *,
    method: Method = "velocity",
    simulated: bool = False,
) -> GazeAnalysis:
    """Analyse raw gaze on the images of a stimulus set.

    Parameters
    ----------
    samples
        One row a sample, in pixels of the image: `participant`, `session`, `trial_index`, `time_s`,
        `x_px`, `y_px`, `valid`. `analysis.image_coordinates` makes them of pixels of
        the screen.
    trials
        One row a trial: `participant`, `session`, `trial_index`, `stimulus` (the id of the image).
    stimuli
        The set, loaded from its folder; its images need regions.
    pixels_per_degree
        Of the image as shown, above 0 (`analysis.pixels_per_degree`).
    level
        The factor that the ratios are over, such as `divergence_deg`.
    method
        `velocity` (I-VT) or `dispersion` (I-DT), see `analysis.fixations`.
    simulated
        Whether programs looked: every table and figure says so.

    Raises
    ------
    InputError
        If a column, a stimulus, its regions or the level are missing, or samples are impossible.
    """
    if method not in _DETECTORS:
        raise InputError(f"method: {method!r} given, {' or '.join(_DETECTORS)} accepted")
    shown = _shown(trials, stimuli, level)
    regions = _regions(stimuli, shown)
    fixations = _DETECTORS[method](samples, pixels_per_degree)
    dwell = dwell_times(fixations, shown, regions)
    table = fixations.table.merge(shown[[*TRIAL, "stimulus"]], on=list(TRIAL))
    maps = {}
    for name, own in table.groupby("stimulus", sort=True):
        try:
            maps[str(name)] = heat_map(own, regions[str(name)].shape, pixels_per_degree)
        except InputError:  # nobody fixated the image itself
            continue
    return GazeAnalysis(
        stimuli=stimuli,
        fixations=fixations,
        dwell=dwell,
        ratios=dwell_ratios(dwell, (level,)) if shown["target"].notna().any() else None,
        heat_maps=maps,
        level=level,
        simulated=simulated,
    )


def _shown(trials: pd.DataFrame, stimuli: StimulusSet, level: str) -> pd.DataFrame:
    """Return the trials with the level and the target of what they showed."""
    missing = [name for name in (*TRIAL, "stimulus") if name not in trials]
    if missing:
        raise InputError(f"trials: the column {missing[0]} is missing")
    known = stimuli.to_frame().rename(columns={"answer": "label"})
    if level not in known:
        raise InputError(f"level: the set {stimuli.name} has no factor {level!r}")
    unknown = sorted(map(str, set(trials["stimulus"]) - set(known["stimulus"])))
    if unknown:
        raise InputError(f"trials: stimulus {unknown[0]!r} is not in the set {stimuli.name}")
    wanted = known[["stimulus", level, "label"]].rename(columns={"label": "target"})
    return trials[[*TRIAL, "stimulus"]].merge(wanted, on="stimulus", how="left")


def _regions(stimuli: StimulusSet, shown: pd.DataFrame) -> dict[str, NDArray[Any]]:
    images: dict[str, NDArray[Any]] = {}
    regions = {}
    for name in shown["stimulus"].unique():
        file = stimuli[name].regions
        if file is None:
            raise InputError(f"stimuli: {name} of the set {stimuli.name} has no regions")
        if file not in images:
            images[file] = read_labels(stimuli.path(file))
        regions[str(name)] = images[file]
    return regions
