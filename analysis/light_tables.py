"""Tables 3.1 and 3.2 of the thesis, the published errors beside ours.

The published errors are of photographs and renders that we do not have: ours are of the stand-ins
in `stimuli.sets.lightprobes`, under the same lights. They say whether a method is of that quality,
not whether it gives the same numbers.
"""

from collections.abc import Iterator, Mapping
from typing import Any, Final

import pandas as pd

from algorithms.lights import detect_lights
from algorithms.lights.estimate import Method
from analysis.errors import LightError, light_error
from analysis.sweeps import METHODS, read_probe, true_lights
from stimuli.manifest import Stimulus, StimulusSet

Errors = tuple[tuple[float, float], ...]

TABLE_3_1: Final[Mapping[str, Mapping[Method, Errors]]] = {
    "apple1": {
        "fitting": ((1.28, 7.36), (5.78, 2.86)),
        "voting": ((20.71, 4.69), (2.75, 24.03)),
    },
    "apple2": {"fitting": ((5.83, 0.98),), "voting": ((4.54, 4.3),)},
    "apple3": {"fitting": ((7.63, 4.89), (2.57, 0.0)), "voting": ((12.5, 14.48), (0.0, 11.31))},
    "guitar": {
        "fitting": ((2.8, 15.96), (8.43, 14.72), (21.49, 17.03)),
        "voting": ((5.71, 14.66), (4.36, 4.19), (12.29, 3.16)),
    },
    "quilt": {
        "fitting": ((4.96, 18.41), (9.17, 20.73)),
        "voting": ((14.7, 16.79), (42.25, 14.74)),
    },
}
"""Azimuth and elevation errors of each light, in degrees: the rows E1 and E2 of Lopez-Moreno 2011,
table 3.1. The third light found in the quilt's photograph had no true one and is left out."""

TABLE_3_2: Final[Mapping[str, Errors]] = {
    "O1": ((2.33, 3.81), (10.41, 5.36), (4.9, 6.99)),
    "O2": ((10.41, 9.83), (3.5, 14.15), (1.64, 7.67)),
    "O3": ((25.8, 11.54), (17.7, 8.33), (0.0, 5.82)),
    "O4": ((3.5, 2.04), (15.05, 12.07), (7.43, 18.49)),
    "O5": ((23.57, 0.3), (8.13, 15.62), (14.83, 9.53)),
    "O6": (),
    "O7": ((1.17, 27.77), (20.92, 11.96), (16.6, 14.5)),
    "O8": ((26.17, 24.27), (31.0, 4.64), (26.14, 4.39)),
}
"""Likewise, table 3.2, of the light-source fitting; for O6 none is printed."""


def table_3_1(stimuli: StimulusSet) -> pd.DataFrame:
    """Return published and own errors of both methods under the rigs of table 3.1.

    Parameters
    ----------
    stimuli
        A set that `stimuli.sets.lightprobes` made; of a quick one some rows may be missing.

    Returns
    -------
    A row for each rig, light and method: `object`, `light` (from 1), `method`, `azimuth_deg` and
    `elevation_deg` (ours; NaN where the light is missed), `published_azimuth_deg`,
    `published_elevation_deg`, `strong_extra` (lights found that are not there).
    """
    rigs = [stimulus for stimulus in stimuli.with_role("main") if _group(stimulus) == "rig"]
    rows = [
        row
        for rig in rigs
        for name in [_rig_of(rig)]
        for method in METHODS
        for row in _rows(stimuli, rig, name, method, TABLE_3_1[name][method])
    ]
    return pd.DataFrame(rows)


def table_3_2(stimuli: StimulusSet) -> pd.DataFrame:
    """Return the same as `table_3_1` for three lights on the shapes and materials of table 3.2."""
    probes = [s for s in stimuli.with_role("main") if _group(s) == "three-lights"]
    rows = [
        row
        for probe in probes
        for method in METHODS
        for row in _rows(
            stimuli,
            probe,
            str(probe.factors["probe"]),
            method,
            TABLE_3_2[str(probe.factors["probe"])] if method == "fitting" else (),
        )
    ]
    return pd.DataFrame(rows)


def means(table: pd.DataFrame) -> pd.DataFrame:
    """Return the mean errors of a table by method, over the lights that both columns have."""
    numbers = ["azimuth_deg", "elevation_deg", "published_azimuth_deg", "published_elevation_deg"]
    return table.groupby("method", observed=True)[numbers].mean()


def _group(stimulus: Stimulus) -> str:
    return str(stimulus.factors["group"])


def _rig_of(stimulus: Stimulus) -> str:
    """Return the rig of table 3.1 by its lights, as one object stands for several."""
    from stimuli.scenes.probe_lights import TABLE_3_1 as RIGS
    from stimuli.scenes.probe_lights import light_of_chapter_3

    given = [(light.azimuth_deg, light.elevation_deg) for light in true_lights(stimulus)]
    for name, rig in RIGS.items():
        lights = [light_of_chapter_3(*angles) for angles in rig]
        if [(light.azimuth_deg, light.elevation_deg) for light in lights] == given:
            return name
    raise AssertionError(f"{stimulus.id} is no rig of table 3.1")


def _rows(
    stimuli: StimulusSet, stimulus: Stimulus, name: str, method: Method, published: Errors
) -> Iterator[dict[str, Any]]:
    truth = true_lights(stimulus)
    error: LightError = light_error(
        detect_lights(*read_probe(stimuli, stimulus), method).lights, truth
    )
    ours = dict(
        zip(error.true, zip(error.azimuth_deg, error.elevation_deg, strict=True), strict=True)
    )
    none = (float("nan"), float("nan"))
    for number in range(len(truth)):
        azimuth_deg, elevation_deg = ours.get(number, none)
        theirs = published[number] if number < len(published) else none
        yield {
            "object": name,
            "light": number + 1,
            "method": method,
            "azimuth_deg": azimuth_deg,
            "elevation_deg": elevation_deg,
            "published_azimuth_deg": theirs[0],
            "published_elevation_deg": theirs[1],
            "strong_extra": error.strong_extra,
        }
