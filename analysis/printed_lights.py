"""Light-source fitting as the thesis prints it beside the default one, on ground truth.

Only matt, opaque probes without texture count: what both are meant for.
"""

from collections.abc import Iterator, Sequence
from typing import Any, Final

import numpy as np
import pandas as pd
from numpy.typing import NDArray

from algorithms.errors import InputError
from algorithms.light import Light
from algorithms.lights import detect_lights
from algorithms.lights.printed import VARIANTS as PRINTED
from algorithms.lights.printed import printed_lights
from analysis.errors import light_error
from analysis.sweeps import read_probe, true_lights
from stimuli.manifest import StimulusSet

GROUPS: Final = ("single", "pair", "three-lights")
VARIANTS: Final = ("fitting", *PRINTED)
"""The default, and the variants of the printed method."""


def compare_with_printed(stimuli: StimulusSet) -> pd.DataFrame:
    """Detect lights by the default method and by the printed one in its variants.

    Parameters
    ----------
    stimuli
        A set that `stimuli.sets.lightprobes` made.

    Returns
    -------
    A row for each image, variant and assigned light: `id`, `probe`, `variant`, `lights` (true
    ones), `found`, `missed`, `strong_extra`, `true_elevation_deg`, `azimuth_error_deg`,
    `elevation_error_deg`, and `intensity_ratio`: estimated over true, in units in which the
    variant's median is 1, as albedo is unknown. An image in which nothing is found has one row.

    Raises
    ------
    InputError
        If no image is of such a group.
    """
    chosen = [each for each in stimuli.with_role("main") if each.factors["group"] in GROUPS]
    if not chosen:
        raise InputError(f"stimuli: a set with images of {', '.join(GROUPS)} is accepted")
    rows = [
        {"id": stimulus.id, "probe": stimulus.factors["probe"], **row}
        for stimulus in chosen
        for row in _rows(*read_probe(stimuli, stimulus), true_lights(stimulus))
    ]
    table = pd.DataFrame(rows)
    medians = table.groupby("variant")["intensity_ratio"].transform("median")
    table["intensity_ratio"] /= medians
    return table


def _rows(
    image: NDArray[np.float32], mask: NDArray[np.bool_], truth: Sequence[Light]
) -> Iterator[dict[str, Any]]:
    both = {"fitting": detect_lights(image, mask).lights, **printed_lights(image, mask)}
    for variant, found in both.items():
        error = light_error(found, truth)
        shared = {
            "variant": variant,
            "lights": len(truth),
            "found": len(found),
            "missed": error.missed,
            "strong_extra": error.strong_extra,
        }
        if not found:
            yield shared
        for place, (ours, theirs) in enumerate(zip(error.estimated, error.true, strict=True)):
            yield shared | {
                "true_elevation_deg": truth[theirs].elevation_deg,
                "azimuth_error_deg": error.azimuth_deg[place],
                "elevation_error_deg": error.elevation_deg[place],
                "intensity_ratio": found[ours].intensity / truth[theirs].intensity,
            }
